# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The rules of a flight in one step, and what keeps the motors off."""

import math

from lta_control.allocation import create_working_array, NO_ROTORS
from lta_control.autopilot import Autopilot, build_drone_constants, ESTIMATE_LAYOUT, MEMORY_LAYOUT
from lta_control.estimator import EstimatorSettings
from lta_control.flight_step import (
    control_motors,
    ControlInputs,
    DroneMemory,
    flight_step,
    FlightState,
    is_stopped,
    PilotMemory,
    SensorInputs,
)
from lta_control.laws import load_gains
from lta_control.laws.cascade import CASCADE_LAW, CascadeLawMemory
from lta_control.motion import ControlMotion, DeadReckonedMotion, FLOOR_SETPOINT, Setpoint
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

DRONE = build_drone_constants(
    load_vehicle('gtmab'), EstimatorSettings(rest_time=0.1), load_gains('gtmab'), 0.01
)
STILL = SensorInputs((0.0, 0.0, 0.0), (0.0, 0.0, 9.80665), 0.05, 101_000.0)
UP = Setpoint(0.6, 0.5, 0.2)


def run(memory, steps, heard=STILL, drone=DRONE):
    for k in range(steps):
        # No reading repeats to the bit
        new = heard._replace(range=heard.range + 1e-9 * (k % 2))
        memory = flight_step(CASCADE_LAW, drone, memory, new, create_working_array())
    return memory


def duties(memory):
    return memory.pilot.law.command.duties


def stopped(memory):
    return is_stopped(memory.pilot.watch.state)


def numbers(memory):
    """Return all numbers to the bit: a NaN among them is not equal to itself."""
    return MEMORY_LAYOUT.write(memory).tobytes()


def guided(memory=DroneMemory(), setpoint=UP):  # noqa: B008 - never changed
    return memory._replace(setpoint=setpoint, guided=True)


def test_the_motors_wait_for_estimate_and_setpoint():
    assert duties(run(guided(), 9)) == NO_ROTORS  # the tenth step ends the rest
    assert duties(run(DroneMemory(), 30)) == NO_ROTORS
    flying = run(guided(), 12)
    assert all(0.0 < u <= 1.0 for u in duties(flying)[:2])
    assert duties(flying)[4:] == (0.0,) * 4


def test_standing_they_are_off_and_forget():
    flying = run(guided(), 20)
    assert flying.pilot.law != CascadeLawMemory()
    standing = run(guided(flying, Setpoint(0.3, 0.0, 0.0)), 1)
    assert duties(standing) == NO_ROTORS
    np.testing.assert_array_equal(standing.pilot.law.thrusts, NO_ROTORS)
    assert standing.pilot.law.cascade[:3] == (0.0, 0.0, 0.0)


def test_they_stop_where_a_landing_no_longer_sinks():
    """Its range finder reads 5 cm too high; its nose is off, so motors would turn on the floor."""
    flying = run(guided(), 20)
    landing = guided(flying, Setpoint(0.3, 1.0, 0.0))
    high = STILL._replace(range=0.1)
    turning = run(landing, 550, high)
    assert any(duties(turning))
    landed = run(turning, 200, high)
    assert landed.measured.altitude > DRONE.rules.standing_height + 0.03
    assert duties(landed) == NO_ROTORS
    assert any(duties(run(guided(landed), 1, high)))


def test_they_stop_for_good_where_the_height_is_stuck():
    """In the air: range finder and barometer repeat, so nobody knows whether it sinks."""
    memory = run(guided(), 20)
    for _ in range(210):
        memory = flight_step(CASCADE_LAW, DRONE, memory, STILL, create_working_array())
    assert stopped(memory)
    assert not any(duties(run(memory, 20)))


def test_a_landing_goes_on_by_the_barometer_where_the_range_finder_is_stuck():
    """For 12 s, where a landing without a descent would end after 6 s."""
    memory = guided(run(guided(), 20), Setpoint(0.3, 1.0, 0.0))
    memory = run(memory, 1, STILL._replace(range=2.0))
    for k in range(1200):
        heard = STILL._replace(range=2.0, pressure=101_000.0 - 24.0 + 0.016 * k)
        memory = flight_step(CASCADE_LAW, DRONE, memory, heard, create_working_array())
        assert any(duties(memory))
    assert not stopped(memory)
    assert memory.measured.altitude < 1.5  # of 2.4 m


def test_turned_over_they_stay_off():
    flying = run(guided(), 20)
    over = flying._replace(estimate=flying.estimate._replace(attitude=TILTED))
    after = run(over, 1)
    assert stopped(after)
    assert duties(after) == NO_ROTORS
    upright = after._replace(estimate=flying.estimate)
    assert duties(run(upright, 5)) == NO_ROTORS
    leaning = math.sin(0.49), 0.0, 0.0, math.cos(0.49)
    almost = flying._replace(estimate=flying.estimate._replace(attitude=leaning))
    assert not stopped(run(almost, 1))


def test_the_autopilot_is_the_same_step_compiled():
    """Its memory equals that of the plain function bit by bit, also while sensors are lost."""
    generator, pilot, memory = np.random.default_rng(6), Autopilot(DRONE), DroneMemory()
    np.testing.assert_array_equal(duties(pilot.memory), NO_ROTORS)
    for k in range(600):
        if k % 20 == 7:
            setpoint = Setpoint(*generator.normal(0.5, 0.5, 3).tolist())
            pilot.set_setpoint(setpoint)
            memory = guided(memory, setpoint)
        shaken = 0.05 if k < 12 else 1.0  # it has to stand still before it flies
        rates = generator.normal(0.0, 0.3 * shaken, 3)
        force = generator.normal((0.0, 0.0, 9.8), 0.5 * shaken)
        distance = float(generator.normal(0.2, 0.05)) if k % 3 else (math.nan, math.inf)[k % 2]
        pressure = float(generator.normal(101_000.0, 2.0)) if k % 2 else math.nan
        heard = SensorInputs(tuple(rates.tolist()), tuple(force.tolist()), distance, pressure)
        found = pilot.step(*heard[:4])
        memory = run(memory, 1, heard)
        assert numbers(pilot.memory) == numbers(memory)
        assert found == duties(memory)[:4]
        assert pilot.estimate == memory.estimate
        assert pilot.heading == memory.measured.heading
        place, told = memory.estimate.position, memory.measured
        assert pilot.dead_reckoning == DeadReckonedMotion(
            told.heading, *place, told.speed, told.sway
        )
        assert pilot.measurement == (memory.measured if memory.estimate.ready else None)
    assert memory.estimate.flight_time > 5.0
    assert not stopped(memory)


@pytest.mark.parametrize('number', [1, 2, 6, 8])
def test_any_number_of_rotors_flies_the_same_code(number):
    """The first rotors of a ring of eight: compiled once for all, and equal to plain Python."""
    columns = tuple(
        (math.cos(k), math.sin(k), 1.0, 0.01 * k, 0.0, 0.1 * math.cos(k)) for k in range(number)
    )
    empty = 8 - number
    slots = DRONE.law.rotors._replace(
        number=number,
        allocation=columns + ((0.0,) * 6,) * empty,
        low=NO_ROTORS,
        high=(0.15,) * number + (0.0,) * empty,
        a=(0.08,) * number + (0.0,) * empty,
        b=(0.07,) * number + (0.0,) * empty,
    )
    body = DRONE.body._replace(number=number, allocation=slots.allocation, a=slots.a, b=slots.b)
    drone = DRONE._replace(law=DRONE.law._replace(rotors=slots), body=body)
    pilot, memory = Autopilot(drone), guided()
    pilot.set_setpoint(UP)
    for _ in range(60):
        found = pilot.step(*STILL[:4])
        memory = run(memory, 1, drone=drone)
        assert numbers(pilot.memory) == numbers(memory)
    assert len(found) == number
    assert any(found)


NAN = (math.nan, 0.0, 0.0)
TILTED = (math.sin(0.51), 0.0, 0.0, math.cos(0.51))  # 1.02 rad


def test_an_estimate_that_is_no_number_stops_the_motors_for_good():
    flying = run(guided(), 20)
    lost = flying.estimate._replace(altitude=flying.estimate.altitude._replace(height=math.nan))
    assert stopped(run(flying._replace(estimate=lost), 1))


def test_the_numbers_of_the_estimate_are_the_callers_own():
    pilot = Autopilot(DRONE)
    pilot.step(*STILL[:4])
    numbers = pilot.copy_estimate()
    assert ESTIMATE_LAYOUT.read(numbers) == pilot.estimate
    pilot.step(*STILL[:4])
    assert ESTIMATE_LAYOUT.read(numbers) != pilot.estimate


def test_instead_replaces_the_newest_duties_in_the_memory():
    pilot, memory = Autopilot(DRONE), run(DroneMemory(), 1)
    pilot.step(*STILL[:4])
    pilot.record_applied_duties((0.1, 0.2, 0.3, 0.4))
    assert pilot.duties == (0.1, 0.2, 0.3, 0.4)
    command = memory.pilot.law.command._replace(duties=(0.1, 0.2, 0.3, 0.4, *NO_ROTORS[4:]))
    law = memory.pilot.law._replace(command=command)
    told = memory._replace(pilot=memory.pilot._replace(law=law))
    assert numbers(pilot.memory) == numbers(told)


@pytest.mark.parametrize('place', range(3))
@pytest.mark.parametrize('field', ['rates', 'force'])
def test_a_sample_with_nan_or_infinity_does_not_change_the_estimate(field, place):
    flying = run(guided(), 20)
    for odd in (math.nan, math.inf):
        sample = tuple(odd if k == place else 0.1 for k in range(3))
        assert run(flying, 1, STILL._replace(**{field: sample})).estimate == flying.estimate


@pytest.mark.parametrize('place', range(3))
def test_an_infinite_setpoint_stops_the_motors_of_a_guided_vehicle(place):
    odd = Setpoint(*(math.inf if k == place else 0.5 for k in range(3)))
    assert stopped(run(guided(run(guided(), 20), odd), 1))
    assert not stopped(run(run(guided(), 20)._replace(setpoint=odd, guided=False), 1))


RULES = DRONE.rules._replace(hold_after=0.5, land_after=3.0)
# Level at 0.5 m, in a room where it stands at 0.42 m
HOVER = ControlInputs(
    ControlMotion((0.0, 0.0, 0.5)), True, False, True, UP._replace(heading=0.0), 0.0, True, False,
    0.01,
)  # fmt: skip


def control(memory=PilotMemory(), steps=1, **changes):  # noqa: B008 - never changed
    """Return the memory after steps of the controller node."""
    inputs = HOVER._replace(**changes)
    for k in range(steps):
        # No height repeats to the bit
        x, y, z = inputs.motion.position
        motion = inputs.motion._replace(position=(x, y, z + 1e-9 * (k % 2)))
        memory = control_motors(
            CASCADE_LAW,
            DRONE.law,
            RULES,
            memory,
            inputs._replace(motion=motion),
            create_working_array(),
        )
    return memory


def state(memory):
    return FlightState(memory.watch.state)


def lift(memory):
    return max(memory.law.command.duties[:2])


def test_armed_with_an_estimate_and_a_setpoint_above_the_floor_it_flies():
    flying = control()
    assert (state(flying), lift(flying) > 0.0) == (FlightState.FLYING, True)
    for missing in ('armed', 'ready', 'guided'):
        resting = control(flying, **{missing: False})
        assert resting.law == CASCADE_LAW.start
        assert state(resting) is FlightState.OFF


def test_armed_in_the_hands_it_waits_for_a_setpoint_above_the_floor():
    """Also where it is to land: a setpoint that is old, or one of two navigators."""
    for changes in ({'setpoint': FLOOR_SETPOINT}, {'age': 4.0}, {'must_land': True}):
        waiting = control(steps=3, **changes)
        assert (state(waiting), waiting.law) == (FlightState.WAITING, CASCADE_LAW.start)
        assert state(control(waiting)) is FlightState.FLYING
    # Disarming begins anew
    assert (
        state(control(control(control(), armed=False), setpoint=FLOOR_SETPOINT))
        is FlightState.WAITING
    )


@pytest.mark.parametrize(
    ('changes', 'wanted'),
    [
        ({'age': 0.4}, FlightState.FLYING),
        ({'age': 0.6}, FlightState.HOLDING),
        ({'age': 2.9}, FlightState.HOLDING),
        ({'age': 3.1}, FlightState.LANDING),
        ({'age': math.inf}, FlightState.LANDING),
        ({'must_land': True}, FlightState.LANDING),
    ],
)
def test_an_old_setpoint_is_held_and_then_it_lands(changes, wanted):
    after = control(control(), **changes)
    assert state(after) is wanted
    # It climbs to 0.6 m, or sinks from 0.5 m
    assert (lift(after) > 0.01) is (wanted is not FlightState.LANDING)
    # Ahead only by a setpoint that is not old
    assert (max(after.law.command.duties[2:]) > 0.01) is (wanted is FlightState.FLYING)


def test_a_landing_by_itself_ends_where_it_no_longer_sinks():
    landing = control(control(), steps=590, must_land=True)
    assert state(landing) is FlightState.LANDING
    landed = control(landing, steps=20, must_land=True)
    assert (state(landed), landed.law) == (FlightState.LANDED, CASCADE_LAW.start)
    standing = HOVER.motion._replace(position=(0.0, 0.0, RULES.standing_height))
    assert state(control(control(), motion=standing, must_land=True)) is FlightState.ON_GROUND


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'motion': ControlMotion((0.0, 0.0, 0.5), TILTED)}, FlightState.OVERTURNED),
        ({'motion': ControlMotion((0.0, 0.0, 0.5), (math.nan,) * 4)}, FlightState.NOT_FINITE),
        ({'motion': ControlMotion((math.inf, 0.0, 0.5))}, FlightState.NOT_FINITE),
        ({'motion': ControlMotion((0.0, 0.0, 0.5), rates=NAN)}, FlightState.NOT_FINITE),
        ({'setpoint': UP._replace(speed=math.nan)}, FlightState.NOT_FINITE),
        ({'ready': False, 'blind': True}, FlightState.BLIND),
    ],
)
def test_what_stops_the_motors_stops_them_for_good(changes, reason):
    stopped = control(control(), **changes)
    assert (state(stopped), stopped.law) == (reason, CASCADE_LAW.start)
    for later in (control(stopped), control(control(stopped, armed=False), armed=True)):
        assert (state(later), later.law) == (reason, CASCADE_LAW.start)
    # Carried by a person, who may turn it over
    assert state(control(armed=False, **changes)) is FlightState.OFF


def test_before_the_first_estimate_a_height_is_not_lost():
    waiting = control(ready=False, blind=True)
    assert state(waiting) is FlightState.OFF
    assert state(control(waiting)) is FlightState.FLYING


def test_a_person_stops_the_motors_for_good():
    flying = control()
    watch = flying.watch._replace(state=FlightState.EMERGENCY_STOP)
    assert state(control(flying._replace(watch=watch))) is FlightState.EMERGENCY_STOP
