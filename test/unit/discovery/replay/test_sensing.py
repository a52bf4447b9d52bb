# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a tracker is taken to say is the truth of another time, as trigonometry has it."""

from types import SimpleNamespace

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_exponential,
    quaternion_logarithm,
    rotate_vectors,
)
from lta_discovery.replay.sensing import (
    apply_sensor_effects,
    estimate_floor_pressure,
    ideal_readings,
    pose_time_shift,
    predict_pose,
    SensorPlaces,
    tracker_frame,
    transform_to_map,
)
from lta_model.sensors.pressure import air_pressure
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
SWING = 2.0 * np.pi * 0.6  # rad/s: a hull that swings below its envelope
ROLL, WAY = 0.2, 0.5  # rad, m
PLACES = SensorPlaces((0.1, 0.0, -0.2), (0.05, 0.02, -0.1), 101000.0)


def _swinging(time: Array) -> Array:
    """Return states that roll and sway to and fro, shape (n, 13)."""
    states = np.zeros((len(time), 13))
    states[:, 1] = WAY * np.sin(SWING * time)
    roll = np.outer(ROLL * np.sin(SWING * time), [1.0, 0.0, 0.0])
    states[:, 3:7] = quaternion_exponential(roll)
    velocity = np.outer(WAY * SWING * np.cos(SWING * time), [0.0, 1.0, 0.0])
    states[:, 7:10] = rotate_vectors(quaternion_conjugate(states[:, 3:7]), velocity)
    states[:, 10] = ROLL * SWING * np.cos(SWING * time)
    return states


def test_a_pose_a_tenth_of_a_second_old_swings_no_wider(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    late = gtmab[0].with_value('tracker_delay', 'delay', 0.1)
    time = GRID_PERIOD * np.arange(101)
    acting = late.build_replay_rows().acting
    position, quaternion = predict_pose(_swinging(time), time[:-1], acting)
    roll = quaternion_logarithm(quaternion)[:, 0]
    before = SWING * (time[:-1] - 0.1)
    inside = slice(2, -2)  # the slopes at the ends are of one side
    # What is left out is of third order in the angle of a delay, 0.38 rad: 1 %. First order
    # alone leaves 7 %, and swings 7 % too wide.
    for seen, wide in ((position[:, 1], WAY), (roll, ROLL)):
        assert np.abs(seen - wide * np.sin(before))[inside].max() < 0.012 * wide
        assert abs(seen[inside].max() / wide - 1.0) < 0.005


@pytest.mark.parametrize(
    ('effect', 'name', 'value'),
    [('tracker_delay', 'delay', 0.1), ('clock_offset', 'offset', -0.1)],
)
def test_a_tracker_delay_and_a_negative_clock_offset_shift_poses_alike(
    gtmab: tuple[NominalVehicle, list[FreeParameter]], effect: str, name: str, value: float
) -> None:
    time = GRID_PERIOD * np.arange(101)
    acting = gtmab[0].with_value(effect, name, value).build_replay_rows().acting
    np.testing.assert_allclose(pose_time_shift(acting, time[:-1]), -0.1, atol=1e-12)
    place = predict_pose(_swinging(time), time[:-1], acting)[0][2:-2, 1]
    before = WAY * np.sin(SWING * (time[2:-3] - 0.1))
    assert np.abs(place - before).max() < 0.012 * WAY


def test_the_shift_of_a_pose_adds_up_clock_and_delay(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    """The shift is 0.02 s + 5e-4 t - 0.1 s."""
    nominal = gtmab[0].with_value('clock_offset', 'offset', 0.02)
    nominal = nominal.with_value('clock_skew', 'skew', 5e-4)
    acting = nominal.with_value('tracker_delay', 'delay', 0.1).build_replay_rows().acting
    time = np.array([[0.0, 10.0], [100.0, 200.0]])
    np.testing.assert_allclose(pose_time_shift(acting, time), [[-0.08, -0.075], [-0.03, 0.02]])


def test_each_effect_changes_the_readings_of_its_sensor_alone(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    nominal = gtmab[0]
    for effect, name, value in (
        ('gyro_scale', 'z', 1.1), ('imu_bias', 'y', 0.2), ('range_offset', 'offset', 0.1),
        ('pressure_drift', 'rate', 0.5),
    ):  # fmt: skip
        nominal = nominal.with_value(effect, name, value)
    exact = np.tile(np.arange(1.0, 9.0), (2, 1))
    said = apply_sensor_effects(exact, np.array([0.0, 4.0]), nominal.build_replay_rows().acting)
    first = [1.0, 2.0, 3.3, 4.0, 5.2, 6.0, 7.1, 8.0]
    np.testing.assert_allclose(said, [first, [*first[:7], 10.0]])


def test_a_misaligned_tracker_is_turned_back_into_the_map(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    angles = (0.4, -0.2, 0.1)
    nominal = gtmab[0]
    for name, angle in zip(('yaw', 'pitch', 'roll'), angles, strict=True):
        nominal = nominal.with_value('tracker_misalignment', name, angle)
    acting, frame = nominal.build_replay_rows().acting, Rotation.from_euler('ZYX', angles).inv()
    matrix, turn = tracker_frame(acting)
    np.testing.assert_allclose(matrix, frame.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(turn, frame.as_quat(), atol=1e-12)
    truth = np.random.default_rng(4).normal(size=(5, 13))
    truth[:, 3:7] = Rotation.from_rotvec(truth[:, 3:6]).as_quat()
    seen = truth.copy()
    seen[:, :3] = frame.apply(truth[:, :3])
    seen[:, 3:7] = (frame * Rotation.from_quat(truth[:, 3:7])).as_quat()
    back = transform_to_map(seen, acting)
    same = np.sign(np.sum(back[:, 3:7] * truth[:, 3:7], axis=1))
    back[:, 3:7] *= same[:, None]
    np.testing.assert_allclose(back, truth, atol=1e-12)


def test_the_frame_of_a_tracker_is_evaluated_level_at_the_origin_at_time_0() -> None:
    """
    The effect of this test depends on place, attitude and time.

    It doubles places only where level at time 0, and keeps attitudes only at the origin then.
    """

    def bent(p: object, values: tuple[float, ...], time: float) -> tuple[float, ...]:
        *place, i, j, k, w = values
        tilted = 1.0 if (i, j, k, w, time) == (0.0, 0.0, 0.0, 1.0, 0.0) else 5.0
        turned = (i, j, k, w) if place == [0.0, 0.0, 0.0] and time == 0.0 else (w, k, j, i)
        return (*(2.0 * tilted * each for each in place), *turned)

    matrix, turn = tracker_frame({'pose': ((bent, ()),)})
    np.testing.assert_array_equal(matrix, 2.0 * np.eye(3))
    np.testing.assert_array_equal(turn, [0.0, 0.0, 0.0, 1.0])


def test_without_an_effect_the_frame_of_the_tracker_is_the_map(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    matrix, turn = tracker_frame(gtmab[0].build_replay_rows().acting)
    np.testing.assert_array_equal(matrix, np.eye(3))
    np.testing.assert_array_equal(turn, [0.0, 0.0, 0.0, 1.0])


def _pitched(angle: float) -> Array:
    """Return a state at rest at a height of 1.5 m, pitched by an angle."""
    state = np.zeros(13)
    state[2] = 1.5
    state[3:7] = 0.0, np.sin(0.5 * angle), 0.0, np.cos(0.5 * angle)
    return state


def test_sensors_at_rest_measure_the_vertical_the_distance_and_the_pressure() -> None:
    """
    At a pitch of 0.3 rad the vertical is (-sin 0.3, 0, cos 0.3) in the body frame.

    The range is measured along the body's vertical axis, from a height of
    1.5 - 0.05 sin 0.3 - 0.1 cos 0.3 m. The pressure is that at the IMU, 0.1 m ahead of the centre
    and 0.2 m below it: at 1.5 - 0.1 sin 0.3 - 0.2 cos 0.3 m.
    """
    rest, sine, cosine = _pitched(0.3), np.sin(0.3), np.cos(0.3)
    said = ideal_readings(rest, rest, rest, PLACES)
    np.testing.assert_allclose(said[:3], 0.0)
    np.testing.assert_allclose(said[3:6], STANDARD_GRAVITY * np.array([-sine, 0.0, cosine]))
    assert said[6] == pytest.approx((1.5 - 0.05 * sine - 0.1 * cosine) / cosine)
    imu = 1.5 - 0.1 * sine - 0.2 * cosine
    assert said[7] == pytest.approx(air_pressure(101000.0, imu), abs=1e-6)


def test_rates_and_force_are_means_of_the_period() -> None:
    """
    The roll rate rises from 0.1 to 0.3 rad/s in 40 ms, by 5 rad/s2.

    An IMU 0.2 m below the centre accelerates by 5 * 0.2 = 1 m/s2 along y and by the mean square of
    the rate, (0.1^2 + 0.1 * 0.3 + 0.3^2) / 3, times 0.2 m towards the axis. Surge speed gains
    0.02 m/s in 40 ms, which is 0.5 m/s2.
    """
    begin, middle, end = _pitched(0.0), _pitched(0.0), _pitched(0.0)
    begin[10], middle[10], end[10] = 0.1, 0.2, 0.3
    middle[7], end[7] = 0.01, 0.02
    said = ideal_readings(begin, middle, end, PLACES)
    np.testing.assert_allclose(said[:3], [0.2, 0.0, 0.0])
    inwards = 0.2 * (0.01 + 0.03 + 0.09) / 3.0
    np.testing.assert_allclose(said[3:6], [0.5, 1.0, STANDARD_GRAVITY + inwards], atol=1e-12)


def test_the_pressure_at_the_floor_is_the_median_of_known_readings() -> None:
    height = np.array([1.0, 2.0, 3.0, np.nan, 1.5])
    told_by = np.zeros((5, 8))
    told_by[:, 7] = [air_pressure(99000.0, h - 0.2) for h in height]
    told_by[1, 7], told_by[3, 7] = np.nan, 5.0
    told_by[4, 7] *= 2.0
    flight = SimpleNamespace(readings=told_by, position=np.outer(height, [0.0, 0.0, 1.0]))
    # Known are two readings that fit 99 kPa, and one that fits twice as much.
    assert estimate_floor_pressure(flight, PLACES) == pytest.approx(99000.0)
    flight.readings[:, 7] = np.nan
    assert estimate_floor_pressure(flight, PLACES) == 101325.0
