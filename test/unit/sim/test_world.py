# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A world by itself: start, outcomes, wind, and who paces and steps it."""

import math

from lta_config.constants import STANDARD_GRAVITY
from lta_config.topics import load_topic_table
from lta_control.strategies import STRATEGIES
from lta_graph.health import Health
from lta_graph.ros import vehicle_messages as messages
from lta_model.effects import initial_memory
from lta_model.effects.air import stationary_memory
from lta_model.scenario import STAYING
from lta_model.state import RIGID
from lta_sim import drone
from lta_sim.drone import DroneSettings, Pacer, SimulatedDrone
from lta_sim.environment import draw_initial_memory
from lta_sim.readings import FlightOutcome
from lta_sim.simulated_vehicle import SimulatedVehicle
import numpy as np
import pytest

from . import flat_balloon as balloon
from .lamp_room import build, fly, G, HOVER, OFF


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


DUTIES = [0.3, 0.2, -0.1, 0.4]
WIND = [0.3, -0.2, 0.1]


@pytest.fixture
def craft():
    """Return a balloon in motion."""
    generator = np.random.default_rng(2)
    flown = SimulatedVehicle(balloon.model(balloon.EVERYTHING))
    flown.state[:], _, _ = balloon.anywhere(generator)
    flown.command[: len(DUTIES)] = DUTIES
    flown.surroundings[: len(WIND)] = WIND
    return flown


def test_a_commanded_wrench_accelerates_the_body_and_nothing_else(craft):
    """The inverse of the mass matrix times the wrench; without one, the same flight."""
    model = balloon.model(balloon.EVERYTHING)
    commanded = SimulatedVehicle(model, commanded=True)
    for name in ('state', 'command', 'surroundings'):
        getattr(commanded, name)[:] = getattr(craft, name)
    for flown in (commanded, craft):
        flown.evaluate_state()
    np.testing.assert_array_equal(commanded.rate, craft.rate)
    wrench = np.array([0.02, -0.01, 0.03, 0.001, -0.002, 0.004])
    commanded.commanded_wrench[:] = wrench
    commanded.evaluate_state()
    gained = commanded.rate - craft.rate
    expected = np.reshape(model.inverse, (6, 6)) @ wrench
    np.testing.assert_allclose(gained[7:13], expected, rtol=1e-9)
    assert not gained[:7].any()
    assert not gained[13:].any()


def test_a_commanded_flight_that_ends_on_the_ground_has_landed():
    pacer = Pacer(0.01)
    drone = SimulatedDrone(DroneSettings(commanded=True), load_topic_table(), Health())
    ground = drone.world.state[2]
    assert drone.report_flight(pacer)['outcome'] == 'flying'
    drone.world.state[2] = ground + 0.1  # m
    assert drone.report_flight(pacer)['outcome'] == 'flying'
    drone.finish()
    assert drone.report_flight(pacer)['outcome'] == 'flying'
    drone.world.state[2] = ground
    assert drone.report_flight(pacer)['sentence'] == 'on the ground'
    assert drone.report_flight(pacer)['outcome'] == 'landed'


def test_a_drone_that_never_rose_has_not_landed():
    drone = SimulatedDrone(DroneSettings(commanded=True), load_topic_table(), Health())
    drone.finish()
    assert drone.report_flight(Pacer(0.01))['outcome'] == 'flying'


@pytest.fixture
def wall(monkeypatch):
    """Return the wall time, which a test sets [s]."""
    now = [100.0]
    monkeypatch.setattr(drone.time, 'monotonic', lambda: now[0])
    return now


def test_delays_by_hand(wall):
    pace = drone.Pacer(0.01)
    assert pace.began == 0.0
    pace.begin()
    assert pace.began == 100.0
    assert pace.count_due(0) == 0
    wall[0] = 100.03
    assert pace.count_due(0) == 3
    assert pace.count_due(2) == 1
    wall[0] = 100.2
    assert pace.count_due(0) == drone.BURST_STEPS
    assert not pace.is_slow
    wall[0] = 101.0  # 100 steps are due, more than are caught up
    assert pace.count_due(0) == 1
    assert pace.lost == pytest.approx(0.99)
    assert pace.is_slow
    assert pace.count_due(1) == 0
    wall[0] = 101.02
    assert pace.count_due(1) == 2
    assert pace.lost == pytest.approx(0.99)
