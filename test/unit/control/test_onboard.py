"""Estimate and control in one step, and what keeps the motors off."""

import math

from lta_control import onboard
from lta_control.allocation import create_working_array
from lta_control.autopilot import Autopilot, build_drone_constants, ESTIMATE
from lta_control.cascade import Setpoint
from lta_control.estimator import EstimatorSettings
from lta_control.gains_file import load_gains
from lta_control.onboard import onboard_step, OnboardMemory, SensorInputs
from lta_control.per_rotor import NONE
from lta_control.sighting import DeadReckonedMotion
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
        memory = onboard_step(drone, memory, new, create_working_array())
    return memory


def guided(memory=OnboardMemory(), setpoint=UP):  # noqa: B008 - never changed
    return memory._replace(setpoint=setpoint, guided=True)


def test_the_motors_wait_for_estimate_and_setpoint():
    assert run(guided(), 9).duties == NONE  # the tenth step ends the rest
    assert run(OnboardMemory(), 30).duties == NONE
    flying = run(guided(), 12)
    assert all(0.0 < u <= 1.0 for u in flying.duties[:2])
    assert flying.duties[4:] == (0.0,) * 4


def test_standing_they_are_off_and_forget():
    flying = run(guided(), 20)
    assert flying.control != DRONE.fresh
    standing = run(guided(flying, Setpoint(0.3, 0.0, 0.0)), 1)
    assert standing.duties == NONE
    np.testing.assert_array_equal(standing.control.thrusts, NONE)
    assert standing.control.cascade[:3] == (0.0, 0.0, 0.0)


def test_they_stop_where_a_landing_no_longer_sinks():
    """Its range finder reads 5 cm too high; its nose is off, so motors would turn on the floor."""
    flying = run(guided(), 20)
    landing = guided(flying, Setpoint(0.3, 1.0, 0.0))
    high = STILL._replace(range=0.1)
    turning = run(landing, 550, high)
    assert any(turning.duties)
    landed = run(turning, 200, high)
    assert landed.measured.altitude > DRONE.body.standing_height + 0.03
    assert landed.duties == NONE
    assert any(run(guided(landed), 1, high).duties)


def test_they_stop_for_good_where_the_height_is_stuck():
    """In the air: range finder and barometer repeat, so nobody knows whether it sinks."""
    memory = run(guided(), 20)
    for _ in range(210):
        memory = onboard_step(DRONE, memory, STILL, create_working_array())
    assert memory.stopped
    assert not any(run(memory, 20).duties)


def test_a_landing_goes_on_by_the_barometer_where_the_range_finder_is_stuck():
    """For 12 s, where a landing without a descent would end after 6 s."""
    memory = guided(run(guided(), 20), Setpoint(0.3, 1.0, 0.0))
    memory = run(memory, 1, STILL._replace(range=2.0))
    for k in range(1200):
        heard = STILL._replace(range=2.0, pressure=101_000.0 - 24.0 + 0.016 * k)
        memory = onboard_step(DRONE, memory, heard, create_working_array())
        assert any(memory.duties)
    assert not memory.stopped
    assert memory.measured.altitude < 1.5  # of 2.4 m


def test_turned_over_they_stay_off():
    flying = run(guided(), 20)
    tilted = math.sin(0.51), 0.0, 0.0, math.cos(0.51)  # 1.02 rad
    over = flying._replace(estimate=flying.estimate._replace(attitude=tilted))
    stopped = run(over, 1)
    assert stopped.stopped
    assert stopped.duties == NONE
    upright = stopped._replace(estimate=flying.estimate)
    assert run(upright, 5).duties == NONE
    leaning = math.sin(0.49), 0.0, 0.0, math.cos(0.49)
    almost = flying._replace(estimate=flying.estimate._replace(attitude=leaning))
    assert not run(almost, 1).stopped


def test_the_estimator_sees_the_duties_of_the_step_before(monkeypatch):
    told, step = [], onboard.estimator_step

    def spy(settings, body, state, inputs, dt):
        told.append(inputs.duties)
        return step(settings, body, state, inputs, dt)

    monkeypatch.setattr(onboard, 'estimator_step', spy)
    memory, given = guided(), []
    for _ in range(40):
        memory = run(memory, 1)
        given.append(memory.duties)
    assert told == [NONE, *given[:-1]]
    assert any(map(any, given))


def test_the_autopilot_is_the_same_step_compiled():
    """Any readings, lost sensors among them: every number it remembers, to the bit."""
    generator, pilot, memory = np.random.default_rng(6), Autopilot(DRONE), OnboardMemory()
    np.testing.assert_array_equal(pilot.memory.duties, NONE)
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
        duties = pilot.step(*heard)
        memory = run(memory, 1, heard)
        assert repr(pilot.memory) == repr(memory)  # every bit, and NaN where there is one
        assert duties == memory.duties[:4]
        assert pilot.estimate == memory.estimate
        assert pilot.heading == memory.measured.heading
        place, told = memory.estimate.position, memory.measured
        assert pilot.dead_reckoning == DeadReckonedMotion(
            told.heading, *place, told.speed, told.sway
        )
        assert pilot.measurement == (memory.measured if memory.estimate.ready else None)
    assert memory.estimate.flight_time > 5.0
    assert not memory.stopped


@pytest.mark.parametrize('number', [1, 2, 6, 8])
def test_any_number_of_rotors_flies_the_same_code(number):
    """The first rotors of a ring of eight: compiled once for all, and equal to plain Python."""
    columns = tuple(
        (math.cos(k), math.sin(k), 1.0, 0.01 * k, 0.0, 0.1 * math.cos(k)) for k in range(number)
    )
    empty = 8 - number
    slots = DRONE.rotors._replace(
        number=number,
        allocation=columns + ((0.0,) * 6,) * empty,
        low=NONE,
        high=(0.15,) * number + (0.0,) * empty,
        a=(0.08,) * number + (0.0,) * empty,
        b=(0.07,) * number + (0.0,) * empty,
    )
    body = DRONE.body._replace(number=number, allocation=slots.allocation, a=slots.a, b=slots.b)
    drone = DRONE._replace(rotors=slots, body=body)
    pilot, memory = Autopilot(drone), guided()
    pilot.set_setpoint(UP)
    for _ in range(60):
        duties = pilot.step(*STILL)
        memory = run(memory, 1, drone=drone)
        assert repr(pilot.memory) == repr(memory)
    assert len(duties) == number
    assert any(duties)


NAN = (math.nan, 0.0, 0.0)


@pytest.mark.parametrize('lost', [STILL._replace(rates=NAN), STILL._replace(force=NAN)])
def test_a_sample_that_is_no_number_is_left_out(lost):
    flying = run(guided(), 20)
    assert run(flying, 1, lost).estimate == flying.estimate
    assert not run(flying, 1, lost).stopped


def test_a_setpoint_that_is_no_number_stops_the_motors_for_good():
    flying = run(guided(), 20)
    stopped = run(guided(flying, UP._replace(heading=math.nan)), 1)
    assert stopped.stopped
    assert stopped.duties == NONE
    assert run(guided(stopped), 3).duties == NONE


def test_an_estimate_that_is_no_number_stops_the_motors_for_good():
    flying = run(guided(), 20)
    lost = flying.estimate._replace(altitude=flying.estimate.altitude._replace(height=math.nan))
    assert run(flying._replace(estimate=lost), 1).stopped


def test_the_numbers_of_the_estimate_are_the_callers_own():
    pilot = Autopilot(DRONE)
    pilot.step(*STILL)
    numbers = pilot.copy_estimate()
    assert ESTIMATE.read(numbers) == pilot.estimate
    pilot.step(*STILL)
    assert ESTIMATE.read(numbers) != pilot.estimate


def test_instead_replaces_the_newest_duties_in_the_memory():
    pilot, memory = Autopilot(DRONE), run(OnboardMemory(), 1)
    pilot.step(*STILL)
    pilot.record_applied_duties((0.1, 0.2, 0.3, 0.4))
    assert pilot.duties == (0.1, 0.2, 0.3, 0.4)
    told = memory._replace(duties=(0.1, 0.2, 0.3, 0.4, *NONE[4:]))
    assert repr(pilot.memory) == repr(told)  # a NaN in it is not equal to itself


def test_a_fresh_memory_is_zero_and_unguided():
    fresh = OnboardMemory()
    assert fresh.measured == (0.0,) * 7
    assert (fresh.guided, fresh.setpoint, fresh.duties, fresh.stopped) == (
        False, (0.0, 0.0, 0.0), NONE, False,
    )  # fmt: skip


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
    assert run(guided(run(guided(), 20), odd), 1).stopped
    assert not run(run(guided(), 20)._replace(setpoint=odd, guided=False), 1).stopped
