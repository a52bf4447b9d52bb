# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The estimator: what it learns at rest, what it leaves out, and that it cannot see the truth."""

import math

from lta_config.files import find_file, load_yaml
from lta_control.allocation import NO_ROTORS, pad_to_slots
from lta_control.bias_calibration import is_tilted, is_turning, SensorBiases
from lta_control.estimator import (
    estimator_step,
    EstimatorInputs,
    EstimatorModel,
    EstimatorSettings,
    has_height,
    MotionEstimate,
    STUCK,
)
from lta_control.flight_report import describe_calibration
from lta_control.motion_filters import HullDragModel
from lta_control.vehicle_parameters import build_estimator_model
from lta_graph.health import HealthLevel
from lta_model.sensors.imu import error_bounds, ImuSettings
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
import yaml

G = 9.80665
DT = 0.01
SETTINGS = EstimatorSettings()
BODY = EstimatorModel(
    hull=HullDragModel((0.5, 0.5), (0.0, 0.0), (0.1, 0.1)),
    standing_height=0.42,
    imu_position=(0.0, 0.0, 0.0),
    range_position=(0.0, 0.0, -0.37),
    number=2,
    allocation=(
        (0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
        (1.0, 0.2, 0.0, 0.0, 0.0, 0.0),
        *((0.0,) * 6,) * 6,
    ),
    a=pad_to_slots((0.05, 0.09)),
    b=pad_to_slots((0.04, 0.07)),
    lag_up=0.05,
    lag_down=0.1,
)
OFF = NO_ROTORS
STILL = EstimatorInputs((0.01, -0.02, 0.03), (0.1, -0.2, G + 0.3), math.nan, math.nan, OFF)


def run(state, inputs, steps, settings=SETTINGS, body=BODY):
    for _ in range(steps):
        state = estimator_step(settings, body, state, inputs, DT)
    return state


def rested(height=0.05, pressure=101_000.0):
    inputs = STILL._replace(range=height, pressure=pressure)
    return run(MotionEstimate(), inputs, 200)


def test_it_rests_for_two_seconds():
    inputs = STILL._replace(range=0.05, pressure=101_000.0)
    state = run(MotionEstimate(), inputs, 199)
    assert not state.ready
    assert state.flight_time == 0.0
    assert run(state, inputs, 1).ready


def test_it_waits_for_a_pressure():
    state = run(MotionEstimate(), STILL._replace(range=0.05), 300)
    assert not state.ready
    assert run(state, STILL._replace(pressure=101_000.0), 1).ready


def test_it_learns_the_biases_exactly():
    """Means of readings that differ, gravity taken off; pressure counts where there was one."""
    generator = np.random.default_rng(3)
    rates = generator.normal(0.0, 0.02, (200, 3))
    force = generator.normal(0.0, 0.1, (200, 3)) + np.array((0.0, 0.0, G))
    state, heard = MotionEstimate(), []
    for k in range(200):
        pressure = 100_000.0 + k if k % 2 else math.nan
        heard += [pressure] if k % 2 else []
        inputs = EstimatorInputs(tuple(rates[k]), tuple(force[k]), 0.06, pressure, OFF)
        state = estimator_step(SETTINGS, BODY, state, inputs, DT)
    np.testing.assert_allclose(state.biases.rates, rates.mean(axis=0), atol=1e-15)
    np.testing.assert_allclose(state.biases.force, force.mean(axis=0) - (0, 0, G), atol=1e-13)
    # It stands at 0.42 m whatever its range finder says; the prior of 1 m weighs 1e-4 / 200.
    assert state.altitude.height == pytest.approx(0.42, abs=1e-6)
    floor = np.mean(heard) + 1.2041 * G * 0.42
    assert state.biases.pressure == pytest.approx(floor, rel=1e-14)


CARRIED = STILL._replace(rates=(0.2, 0.0, 0.5), force=(1.5, 0.0, 9.7), pressure=101_000.0)


def test_who_is_carried_learns_once_it_stands():
    """Turned and tilted in the hand first; that became its biases for good."""
    state = run(MotionEstimate(), CARRIED, 300)
    assert describe_calibration(state, BODY).message.startswith(
        'calibrating the IMU biases: keep the drone still'
    )
    still = STILL._replace(range=0.05, pressure=101_000.0)
    assert not run(state, still, 199).ready
    state = run(state, still, 200)
    assert state.biases == rested().biases
    assert describe_calibration(state, BODY).message == 'biases are known'
    assert run(state, still, 1000).rates == pytest.approx((0.0, 0.0, 0.0), abs=1e-15)


def test_a_jolt_begins_the_rest_anew():
    still = STILL._replace(pressure=101_000.0)
    state = run(MotionEstimate(), still, 150)
    for jolt in ({'rates': (0.01, 0.2, 0.03)}, {'force': (0.1, -0.2, G + 1.5)}):
        knocked = run(run(state, still._replace(**jolt), 1), still, 1)
        assert knocked.rest.samples == 1
        assert run(knocked, still, 199).ready


def test_a_tilt_is_waited_with_and_told():
    tilt = STILL._replace(pressure=101_000.0, force=(1.2, -0.2, G))
    state = run(MotionEstimate(), tilt, 999)
    assert not state.ready
    state = run(state, tilt, 1)
    assert state.ready
    assert describe_calibration(state, BODY).level is HealthLevel.WARN
    assert 'uncertain' in describe_calibration(state, BODY).message


TURNED = STILL._replace(pressure=101_000.0, rates=(0.01, -0.02, 0.1))


def test_an_even_turn_is_never_a_bias():
    """5.7 deg/s for 10 s were taken, and the drone turned in its own eyes ever after."""
    state = run(MotionEstimate(), TURNED, 1000)
    assert not state.ready
    fact = describe_calibration(state, BODY)
    assert fact.level is HealthLevel.ERROR
    sentence = 'the drone turns at 5.7 deg/s, more than the largest possible bias of 3 deg/s;'
    assert sentence in fact.message
    assert not run(state, TURNED, 5000).ready
    still = STILL._replace(range=0.05, pressure=101_000.0)
    state = run(state, still, 200)
    assert state.biases == rested().biases
    assert describe_calibration(state, BODY).message == 'biases are known'


def test_a_bias_that_the_vehicle_file_tells_is_learned_at_once():
    """A bad gyroscope that is known to be one; 8 deg/s less than it says are a turn."""
    bad = BODY._replace(rate_bias=(0.0, 0.0, 0.14), force_bias=(1.0, 0.0, 0.0))
    state = MotionEstimate()
    for _ in range(200):
        read = STILL._replace(pressure=101_000.0, rates=(0.0, 0.0, 0.13), force=(1.1, 0.0, G))
        state = estimator_step(SETTINGS, bad, state, read, DT)
    assert state.ready
    assert state.biases.rates == pytest.approx((0.0, 0.0, 0.13), abs=1e-15)
    assert describe_calibration(state, bad).message == 'biases are known'
    assert is_turning(SensorBiases(), bad.rate_bias)


def test_the_biases_of_a_vehicle_are_those_of_its_effects(tmp_path):
    content = load_yaml(find_file('vehicle', 'gtmab'))
    bias = {'z': {'value': 8.0, 'unit': 'deg/s', 'source': 'test'}}
    content.setdefault('effects', {})['gyro_bias'] = bias
    path = tmp_path / 'bad.yaml'
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
    body = build_estimator_model(load_vehicle(str(path)))
    assert body.rate_bias == pytest.approx((0.0, 0.0, math.radians(8.0)))
    assert build_estimator_model(load_vehicle('gtmab')).rate_bias == (0.0, 0.0, 0.0)


def test_a_sensor_may_be_off_by_what_its_data_sheet_says():
    most = [2.0 * offset for offset in error_bounds(ImuSettings()).offset]
    biases = SensorBiases(tuple(most[3:]), tuple(most[:3]))
    assert not is_turning(biases, (0.0, 0.0, 0.0))
    assert not is_tilted(biases, (0.0, 0.0, 0.0))


@pytest.mark.parametrize('reading', [math.inf, -math.inf, math.nan])
def test_a_range_without_a_return_is_left_out(reading):
    state = rested()
    with_it = run(state, STILL._replace(range=reading), 10)
    assert with_it == run(state, STILL, 10)
    early = run(MotionEstimate(), STILL._replace(range=reading), 10)
    assert early == run(MotionEstimate(), STILL, 10)


def test_a_tilted_range_is_the_height():
    """Rolled by 0.3 about the centre: the slant is longer, and the sensor hangs less deep."""
    roll = 0.3
    tilted = rested()._replace(attitude=(math.sin(roll / 2), 0.0, 0.0, math.cos(roll / 2)))
    height = 1.0
    slant = (height - 0.37 * math.cos(roll)) / math.cos(roll)
    force = (0.1, -0.2 + G * math.sin(roll), 0.3 + G * math.cos(roll))
    state = run(tilted, STILL._replace(force=force, range=slant), 2000)
    assert state.altitude.height == pytest.approx(height, abs=1e-6)
    assert state.airspeed == pytest.approx((0.0,) * 4, abs=1e-6)  # gravity is not acceleration


def test_lying_on_its_side_the_range_is_left_out():
    side = rested()._replace(attitude=(math.sin(0.55), 0.0, 0.0, math.cos(0.55)))  # 63 degrees
    assert run(side, STILL._replace(range=0.9), 1) == run(side, STILL, 1)


def test_motors_reach_a_commanded_duty_with_their_lag():
    state = run(rested(), STILL._replace(duties=pad_to_slots((0.5, 1.0))), 5)
    assert state.duties[:2] == pytest.approx((0.5 * (1 - math.exp(-1)), 1 - math.exp(-1)))
    state = run(state, STILL._replace(duties=OFF), 10)
    assert state.duties[0] == pytest.approx(0.5 * (1 - math.exp(-1)) * math.exp(-1))


def test_a_reversing_motor_speeds_up_with_the_lag_up():
    state = run(rested(), STILL._replace(duties=pad_to_slots((-0.5,))), 5)
    assert state.duties[0] == pytest.approx(-0.5 * (1 - math.exp(-1)))


def test_without_lag_motors_follow_at_once():
    swift = BODY._replace(lag_up=0.0, lag_down=0.0)
    state = run(rested(), STILL._replace(duties=pad_to_slots((0.3, 0.1, 0.0, 1.0))), 1, body=swift)
    assert state.duties == pad_to_slots((0.3, 0.1, 0.0, 1.0))


def test_the_drag_model_is_driven_by_the_rotors():
    """u = 0.5: T = 0.09 * 0.25 + 0.07 * 0.5; column (1, 0.2): surge sqrt(T / 0.1)."""
    state = run(rested(), STILL._replace(duties=pad_to_slots((0.9, 0.5))), 8000)
    thrust = 0.0575
    assert state.airspeed.model_surge == pytest.approx(math.sqrt(thrust / 0.1), rel=1e-4)
    assert state.airspeed.surge == pytest.approx(math.sqrt(thrust / 0.1), rel=1e-4)
    assert state.airspeed.sway == pytest.approx(math.sqrt(0.2 * thrust / 0.1), rel=1e-4)


FLYING = STILL._replace(duties=pad_to_slots((0.2, 0.2)))
STEPS = round(STUCK / DT)


def fly(state, steps, *, distance=None, pressure=None, sink=0.002, duties=FLYING.duties):
    """Return the estimate of a drone that sinks by `sink` a step; given readings are stuck."""
    for _ in range(steps):
        down = sink * state.flight_time / DT
        inputs = FLYING._replace(
            range=0.5 - down if distance is None else distance,
            pressure=101_000.0 + 1.225 * G * down if pressure is None else pressure,
            duties=duties,
        )
        state = estimator_step(SETTINGS, BODY, state, inputs, DT)
    return state


def test_a_range_finder_that_repeats_is_left_to_the_barometer():
    start = fly(rested(), 1, distance=0.5)
    before = fly(start, STEPS - 1, distance=0.5)
    held = before.altitude.height
    assert held == pytest.approx(0.87, abs=0.05)
    after = fly(before, 2 * STEPS, distance=0.5)
    assert after.altitude.height < held - 0.5  # it sank by 0.8 m meanwhile
    assert has_height(after)
    # Its next reading is a new one
    again = fly(after, 1, distance=0.1)
    assert again.sensors.range.age == 0.0
    assert again.altitude.height == pytest.approx(0.47, abs=0.02)
    assert abs(after.altitude.height - 0.47) > 0.2


@pytest.mark.parametrize('lost', [math.nan, math.inf, 0.5])
def test_without_both_sensors_the_height_is_unknown(lost):
    gone = {'distance': lost, 'pressure': math.nan if math.isnan(lost) else 101_000.0}
    state = fly(rested(), STEPS - 1, **gone)
    assert has_height(state)
    state = fly(state, 3, **gone)
    assert not has_height(state)
    assert has_height(fly(state, 1, distance=0.4, pressure=math.nan))


def test_at_rest_a_sensor_may_be_quiet():
    still = {'distance': 0.05, 'pressure': 101_000.0}
    state = fly(rested(), 2 * STEPS, **still, duties=OFF)
    assert has_height(state)
    assert state.altitude.height == pytest.approx(0.42, abs=0.01)


@pytest.mark.parametrize('place', [(0.0, 0.0, -0.36), (0.1, -0.2, -0.3)])
def test_turning_about_the_hull_centre_is_no_speed(place):
    """The IMU swings around a centre that stays where it is; exact rates and specific force."""
    body = BODY._replace(imu_position=place)
    state = run(MotionEstimate(), EstimatorInputs((0.0,) * 3, (0.0, 0.0, G), 0.05, 1e5, OFF), 200)
    settings = EstimatorSettings(gravity_gain=0.0, accelerometer_trust=60.0)
    dt, turn = 0.001, Rotation.identity()
    fastest = 0.0
    for k in range(3000):
        t = (k + 1) * dt
        w = np.array([0.3 * math.sin(3 * t), 0.2 * math.sin(4 * t), 0.4 * math.sin(2 * t)])
        change = np.array([0.9 * math.cos(3 * t), 0.8 * math.cos(4 * t), 0.8 * math.cos(2 * t)])
        turn = turn * Rotation.from_rotvec(w * dt)
        felt = np.cross(change, place) + np.cross(w, np.cross(w, place))
        felt = felt + turn.inv().apply((0.0, 0.0, G))
        inputs = EstimatorInputs(tuple(w), tuple(felt), math.nan, math.nan, OFF)
        state = estimator_step(settings, body, state, inputs, dt)
        fastest = max(fastest, abs(state.airspeed.surge), abs(state.airspeed.sway))
    assert fastest < 2e-3
    assert abs(state.altitude.climb) < 2e-3


def test_a_motor_that_changes_its_direction_at_the_same_speed_slows_down_first():
    """The command is no faster than the motor, so that the lag for slowing down counts: 0.1 s."""
    before = rested()._replace(duties=pad_to_slots((-0.5, 0.5)))
    state = run(before, STILL._replace(duties=pad_to_slots((0.5, -0.5))), 1)
    down = 1.0 - math.exp(-DT / 0.1)
    assert state.duties[:2] == pytest.approx((-0.5 + down, 0.5 - down))
