# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Wind and walls in the world: told, felt and in motion from the beginning."""

import math

from lta_config.constants import STANDARD_GRAVITY
from lta_graph.ros import vehicle_messages as messages
from lta_model.effects import initial_memory
from lta_model.effects.air import stationary_memory
from lta_model.state import RIGID
from lta_sim.environment import draw_initial_memory
import numpy as np
import pytest

from .lamp_room import build, fly, HOVER

FIELD = {'wind': '8 m/s', 'towards': '90 deg', 'roughness': '0.3 m'}
ROUGH = {'intensity': '0.3 m/s', 'length': '2 m'}
PUSHING = (0.25, 0.25, 0.0, 0.0)


def test_the_topic_tells_the_wind_over_rough_ground_at_the_hull():
    """U_ref (F(z + h) - F(z - h)) / (2 h ln(10 / z0)), F(z) = z (ln(z / z0) - 1) + z0 above z0."""
    world = build(scene={'air/profile': FIELD})
    fly(world, 600, PUSHING)
    z, half, rough = float(world.state[2]), 0.2995, 0.3
    assert z > 0.6

    def area(height):
        return height * (math.log(height / rough) - 1.0) + rough if height > rough else 0.0

    mean = (area(z + half) - area(z - half)) / (2.0 * half * math.log(10.0 / rough))
    assert world.wind == pytest.approx((0.0, 8.0 * mean, 0.0), rel=1e-12, abs=1e-12)
    message = messages.build_wind_message(messages.Time(), world.wind)
    assert message.vector.y == world.wind[1]


def test_all_winds_add_up():
    gust = {'wind': {'value': [0, 0, 0.3], 'unit': 'm/s'}, 'begin': '0 s', 'length': '0.02 s'}
    gust['hold'] = '100 s'
    shear = {
        'origin': {'value': [0, 0, 0], 'unit': 'm'},
        'x': {'value': [0, 0.1, 0], 'unit': '1/s'},
        'y': {'value': [0.1, 0, 0], 'unit': '1/s'},
        'z': {'value': [0, 0], 'unit': '1/s'},
    }
    steady = {'value': [0.2, 0.0, 0.0], 'unit': 'm/s'}
    world = build(scene={'air/gust': gust, 'air/gradient': shear, 'air/wind': steady})
    fly(world, 5, HOVER)
    x, y = world.state[:2].tolist()
    assert world.wind == pytest.approx((0.2 + 0.1 * y, 0.1 * x, 0.3), rel=1e-9)


def test_the_start_is_stationary_and_stays_so():
    """Covariance of the filters: A S + S A' + B B' = 0, A = b (-1 0; 1 -1), B = (sqrt b, 0)."""
    generator = np.random.default_rng(1)
    drawn = np.array([stationary_memory(tuple(z)) for z in generator.normal(size=(40000, 5))])
    s = np.cov(drawn[:, 1:3].T)
    a, noise = np.array([[-1.0, 0.0], [1.0, -1.0]]), np.diag([1.0, 0.0])
    np.testing.assert_allclose(a @ s + s @ a.T + noise, 0.0, atol=0.03)
    assert np.var(drawn[:, 0]) == pytest.approx(1.0, rel=0.03)
    assert np.cov(drawn.T)[0, 1:] == pytest.approx(0.0, abs=0.02)


def test_without_turbulence_nothing_is_drawn():
    generator = np.random.default_rng(1)
    assert draw_initial_memory({}, generator) == list(initial_memory())
    assert generator.random() == np.random.default_rng(1).random()


def test_turbulence_in_the_world_is_there_at_once_and_by_the_seed():
    one, two, other = (build(seed=seed, scene={'air/turbulence': ROUGH}) for seed in (1, 1, 2))
    assert one.wind == two.wind != other.wind
    assert math.hypot(*one.wind) > 0.01
    fly(one, 100, HOVER)
    fly(two, 100, HOVER)
    assert one.wind == two.wind


def test_solid_walls_hold_the_drone_and_open_ones_do_not():
    wind = {'value': [-1.2, 0.0, 0.0], 'unit': 'm/s'}
    solid, open_ = (
        build(scene={'air/wind': wind, 'room/walls': walls}) for walls in ('solid', 'open')
    )
    fly(solid, 1500, PUSHING)
    fly(open_, 1500, PUSHING)
    assert open_.state[0] < -5.0
    # 0.13 N of drag on 100 N/m.
    assert -4.52 < solid.state[0] < -4.45
    assert solid.state[2] < 3.0 - 0.2


def test_a_hand_holds_the_drone_until_it_lets_go():
    """In 0.6 m/s of wind it stays, its sensors at rest; then friction alone does not hold it."""
    wind = {'value': [-0.6, 0.0, 0.0], 'unit': 'm/s'}
    world = build(scene={'air/wind': wind, 'start/held': '2 s'})
    begun, heights = world.state[:RIGID].copy(), [0.0]
    while world.is_held:
        readings = world.sense()
        assert readings.force == pytest.approx((0.0, 0.0, STANDARD_GRAVITY), abs=0.3)
        # A height that repeats to the bit would count as that of a stuck tracker
        assert world.state[2] != heights[-1]
        heights.append(world.state[2])
        world.advance((0.0,) * 4)
    np.testing.assert_allclose(world.state[:RIGID], begun, atol=1e-7)
    assert world.elapsed == pytest.approx(2.0)
    fly(world, 200, (0.0,) * 4)
    assert world.state[0] < begun[0] - 0.05
