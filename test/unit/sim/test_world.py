# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The world: at rest on the floor, obedient, on its way, and honest about ends."""

import math

from lta_control.strategies import STRATEGIES
from lta_model.scenario import STAYING
from lta_sim.readings import FlightOutcome
import numpy as np
import pytest

from .lamp_room import build, fly, G, GTMAB, OFF


def test_it_stands_still_before_take_off():
    world = build(seed=3)
    fly(world, 400)
    x, y, z = world.state[:3]
    assert (x, y) == pytest.approx((-3.5, 0.0), abs=1e-9)
    assert z == pytest.approx(0.42 - 0.002 * G / 20.0, abs=1e-9)
    np.testing.assert_allclose(world.state[7:13], 0.0, atol=1e-9)
    assert world.outcome is FlightOutcome.FLYING
    assert world.elapsed == pytest.approx(4.0)
    assert world.goal_distance == pytest.approx(7.0)


def test_the_start_is_drawn_within_the_spread():
    scene = {'start/heading': '30 deg', 'start/heading_spread': '10 deg'}
    headings = []
    for seed in range(40):
        z, w = build(seed, scene).state[5:7]
        headings.append(math.degrees(2 * math.atan2(z, w)))
    assert 20.0 < min(headings) < 22.0
    assert 38.0 < max(headings) < 40.0


def arrive(x, y, z=0.5, steps=0):
    """Return the outcome of a drone that is put somewhere, one control period on."""
    world = build(scene={'goal/time_limit': '60 s'})
    world.state[:3] = x, y, z
    world._enter_step(steps)
    world.advance(OFF)
    return world.outcome


def test_outcomes():
    assert arrive(2.49, 0.0) is FlightOutcome.FLYING
    assert arrive(2.5001, 0.0) is FlightOutcome.REACHED
    assert arrive(3.5, -1.01) is FlightOutcome.FLYING
    assert arrive(3.5, 0.99, 1.99) is FlightOutcome.REACHED  # the lamp is at 1 m
    assert arrive(3.5, 0.99, 2.01) is FlightOutcome.FLYING
    assert arrive(4.99, 3.99) is FlightOutcome.FLYING
    for lost in ((5.01, 3.0), (-5.01, 0.0), (0.0, 4.01), (0.0, -4.01), (0.0, 0.0, 3.01)):
        assert arrive(*lost) is FlightOutcome.ESCAPED
    assert arrive(0.0, 0.0, steps=5998) is FlightOutcome.FLYING
    assert arrive(0.0, 0.0, steps=5999) is FlightOutcome.TIMEOUT
    assert arrive(3.0, 0.0, steps=5999) is FlightOutcome.REACHED  # at the last moment


def test_a_lamp_is_reached_by_who_stays_there_for_3_s():
    """Homing comes, leaves for one period, and comes back; BAG is there at once."""
    homing, bag = build(strategy='homing'), build(strategy='bag')
    ends = []
    for step in range(1, 500):
        homing.state[:3] = (0.0 if step == 100 else 3.0), 0.0, 0.5
        homing.advance(OFF)
        ends += [step] if homing.outcome is FlightOutcome.REACHED else []
    assert ends[0] == 401  # 3 s after it came, in step 101
    bag.state[:3] = 3.0, 0.0, 0.5
    bag.advance(OFF)
    assert bag.outcome is FlightOutcome.REACHED


def test_those_strategies_stay_that_notice_their_arrival():
    assert {each.name for each in STRATEGIES.values() if each.arrives} == set(STAYING)


def test_an_outcome_stays():
    world = build()
    world.state[:3] = 3.0, 0.0, 0.5
    world.advance(OFF)
    world.state[:3] = 0.0, 0.0, 0.5
    world.advance(OFF)
    assert world.outcome is FlightOutcome.REACHED


def test_rotors_that_do_not_reverse_never_push_backwards():
    world, still = build(), build()
    fly(world, 100, (-1.0,) * 4)
    fly(still, 100, OFF)
    np.testing.assert_array_equal(world.state, still.state)
    np.testing.assert_array_equal(world.duties, OFF)


def test_a_reversible_rotor_does():
    reversing = {f'rotors/{name}/reversible': True for name in GTMAB['rotors']}
    world = build(vehicle=reversing, scene={'start/heading_spread': '0 deg'})
    fly(world, 100, (0.3, 0.3, -1.0, -1.0))
    assert world.duties.tolist() == [0.3, 0.3, -1.0, -1.0]
    assert world.state[7] < -0.1


def test_duties_beyond_full_are_full():
    world, full = build(), build()
    fly(world, 50, (7.0, 7.0, 2.0, 2.0))
    fly(full, 50, (1.0,) * 4)
    np.testing.assert_array_equal(world.state, full.state)


@pytest.mark.parametrize(
    'duties', [(math.nan, 0, 0, 0), (0, 0, math.inf, 0), (0.1, 0.1, 0.1), (0.1,) * 5, ()]
)
def test_duties_that_mean_nothing_are_refused(duties):
    world = build()
    before = world.state.copy()
    with pytest.raises(
        ValueError, match=r'^The motor duties are .*; there must be 4 finite numbers, one for each'
    ):
        world.advance(duties)
    np.testing.assert_array_equal(world.state, before)
    assert world.steps == 0


def test_it_takes_off_and_flies_where_its_nose_points():
    world = build(scene={'start/heading': '0 deg', 'start/heading_spread': '0 deg'})
    fly(world, 400, (0.3, 0.3, 0.3, 0.3))
    assert world.state[2] > 0.6
    assert world.state[0] > -3.5 + 0.2
    assert abs(world.state[1]) < 1e-6


def test_the_wrenches_are_those_of_the_effects():
    world = build()
    given = world.effect_wrenches()
    assert set(given) >= {'weight_and_buoyancy', 'quadratic_drag', 'rotor_thrust', 'floor_contact'}
    # At rest the floor carries the two grams.
    assert given['floor_contact'][2] == pytest.approx(0.002 * G, rel=1e-6)
    assert given['weight_and_buoyancy'][2] == pytest.approx(-0.002 * G, rel=1e-6)
