# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Pose, commands and sensors are picked from the channels of a recording, in known units."""

from typing import Final

from lta_config.errors import BadInput
from lta_data.flight import Channel
from lta_data.scene import find_tracker_prefix
from lta_discovery.flights.measured_flight import FlightStreams, Stream
from lta_discovery.flights.streams import build_streams, convert_to_duties
from lta_discovery.model.nominal import NominalVehicle
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
RATE: Final = 30.0  # Hz


def channel(name: str, time: Array, values: Array) -> Channel:
    return Channel(name, '', time, values)


def recorded(wrench: dict[str, float], motors: dict[str, float]) -> dict[str, Channel]:
    """Return the channels of a resting pose and constant commands."""
    time = np.arange(0.0, 2.0, 1.0 / RATE)
    zero = np.zeros_like(time)
    pose = [f'pose/pose.position.{axis}' for axis in 'xyz']
    turn = [f'pose/pose.orientation.{angle}' for angle in ('yaw', 'pitch', 'roll')]
    told = {name: channel(name, time, zero.copy()) for name in (*pose, *turn)}
    for name, value in {**wrench, **motors}.items():
        told[name] = channel(name, time, zero + value)
    return told


def test_motor_commands_take_precedence_over_a_wrench() -> None:
    """Otherwise the model of a drone that records both would be pushed twice."""
    wrench = {'wrench_command/wrench.force.x': 0.1}
    both = build_streams(recorded(wrench, {'motors/effort.one': 0.5}), ('one',))
    assert both.wrench is None
    assert both.commands.values[0].tolist() == [0.5]


def test_axes_missing_from_a_commanded_wrench_are_zero() -> None:
    """An axis that nobody commands has no channel, or one of NaN."""
    wrench = {'wrench_command/wrench.force.x': 0.1, 'wrench_command/wrench.torque.z': np.nan}
    told = build_streams(recorded(wrench, {}), ('one',)).wrench
    assert told is not None
    assert told.values[0].tolist() == [0.1, 0.0, 0.0, 0.0, 0.0, 0.0]


MAPPING: Final = 'topics: [{topic: motors, actuators: {left: {effort: {column: a, unit: N}}}}]'


@pytest.mark.parametrize(
    ('vehicle', 'provenance', 'told', 'duty'),
    [
        ('rgblimp', {}, 0.03, 0.5),  # a rotor has 0.060 N at full duty
        ('rgblimp', {}, 0.3, 0.3),  # too much for newtons, so a duty
        ('gtmab', {'mapping_file': MAPPING}, 0.0915 / 4 + 0.0677 / 2, 0.5),  # a u^2 + b u
        ('gtmab', {}, 0.05, 0.05),
        ('gtmab', {'mapping_file': 'topics: [5, {topic: motors, actuators: 7}]'}, 0.05, 0.05),
        ('gtmab', {'mapping_file': 'topics: ['}, 0.05, 0.05),
    ],
)
def test_newtons_become_duties(
    vehicle: str, provenance: dict[str, str], told: float, duty: float
) -> None:
    """
    The import mapping says whether commands are newtons.

    Without it they are if full thrust is below 0.1 N and no command exceeds it by more than 10 %.
    """
    nominal = NominalVehicle.from_vehicle(load_vehicle(vehicle))
    time = np.zeros(1)
    streams = FlightStreams(Stream(time, np.zeros((1, 7))), Stream(time, np.full((1, 2), told)))
    found = convert_to_duties(streams, nominal, provenance).commands.values
    assert found == pytest.approx(np.full((1, 2), duty), rel=1e-3)


def duties(vehicle: str, values: list[list[float]], wrench: Stream | None = None) -> Array:
    """Return the duties that are made of commands whose unit the recording does not say."""
    told = FlightStreams(
        Stream(np.zeros(1), np.zeros((1, 7))),
        Stream(np.arange(float(len(values))), np.array(values)),
        wrench=wrench,
    )
    return convert_to_duties(
        told, NominalVehicle.from_vehicle(load_vehicle(vehicle)), {}
    ).commands.values


def test_commands_of_faint_rotors_are_newtons_unless_one_exceeds_full_thrust() -> None:
    """
    The limit is 10 % above the full thrust of 0.060 N.

    So 0.065 is a force, for a duty of 1.083, and 0.067 can only be a duty.
    """
    found = duties('rgblimp', [[0.065, -0.03], [np.nan, 0.0], [0.0, 0.006]])
    np.testing.assert_allclose(found, [[0.065 / 0.06, -0.5], [np.nan, 0.0], [0.0, 0.1]])
    beyond = [[0.01, -0.067], [0.02, 0.0]]
    np.testing.assert_array_equal(duties('rgblimp', beyond), beyond)


def test_commands_beside_a_wrench_and_zero_commands_are_not_converted() -> None:
    push = Stream(np.zeros(1), np.ones((1, 6)))
    assert duties('rgblimp', [[0.03, 0.03]], push).tolist() == [[0.03, 0.03]]
    assert duties('rgblimp', [[0.0, 0.0]]).tolist() == [[0.0, 0.0]]


def pose(topic: str) -> dict[str, Channel]:
    """Return the two channels by which a topic is recognised as a pose."""
    names = [f'{topic}/pose.position.x', f'{topic}/pose.orientation.yaw']
    return {name: channel(name, np.zeros(1), np.zeros(1)) for name in names}


def test_the_preferred_tracker_is_taken_and_never_an_unmeasured_pose() -> None:
    others = {**pose('odom'), **pose('my_tracker'), **pose('estimate'), **pose('setpoint')}
    assert find_tracker_prefix(others) == 'my_tracker/pose.'
    both = {**others, **pose('vrpn/pose'), **pose('ground_truth/pose')}
    assert find_tracker_prefix(both) == 'ground_truth/pose/pose.'
    no_yaw = {'pose/pose.position.x': others['odom/pose.position.x']}
    assert find_tracker_prefix({**no_yaw, **pose('mocap/pose')}) == 'mocap/pose/pose.'
    with pytest.raises(BadInput, match='no measured pose'):
        find_tracker_prefix({**pose('odom'), **no_yaw})


def test_attitude_is_yaw_then_pitch_then_roll_and_nan_in_incomplete_poses() -> None:
    told = recorded({}, {'motors/effort.one': 0.5})
    angles = {'yaw': 1.2, 'pitch': -0.4, 'roll': 0.3}
    for name, value in angles.items():
        told[f'pose/pose.orientation.{name}'].values[:] = value
    told['pose/pose.position.y'].values[3] = np.nan
    found = build_streams(told, ('one',))
    turn = Rotation.from_euler('z', 1.2) * Rotation.from_euler('y', -0.4)
    turn *= Rotation.from_euler('x', 0.3)
    np.testing.assert_allclose(found.pose.values[0, 3:], turn.as_quat(), atol=1e-12)
    assert np.isnan(found.pose.values[3, [1, 3, 4, 5, 6]]).all()
    assert np.isfinite(np.delete(found.pose.values, 3, axis=0)).all()
    assert found.floor == -np.inf
    assert found.others == {}
    assert found.mass is None


def test_readings_are_sorted_by_time_and_the_first_of_an_instant_is_taken() -> None:
    told = recorded({}, {'motors/effort.one': 0.5})
    time, values = np.array([0.0, 2.0, 1.0, 1.0]), np.array([1.0, 2.0, 3.0, 4.0])
    for axis in 'xyz':
        name = f'imu/angular_velocity.{axis}'
        told[name] = channel(name, time, values)
    rates = build_streams(told, ('one',)).others['rates']
    assert rates.time.tolist() == [0.0, 1.0, 2.0]
    assert rates.values.tolist() == [[1.0] * 3, [3.0] * 3, [2.0] * 3]


def test_channels_of_unequal_length_in_one_topic_are_refused() -> None:
    told = recorded({}, {'motors/effort.one': 0.5})
    told['pose/pose.position.z'] = channel('pose/pose.position.z', np.zeros(3), np.zeros(3))
    with pytest.raises(BadInput, match="topic 'pose' have different numbers"):
        build_streams(told, ('one',))


def test_a_sensor_that_lacks_an_axis_is_left_out() -> None:
    told = recorded({}, {'motors/effort.one': 0.5})
    for name in ('imu/angular_velocity.x', 'imu/angular_velocity.y', 'range/range'):
        told[name] = channel(name, np.zeros(1), np.ones(1))
    assert set(build_streams(told, ('one',)).others) == {'range'}


def test_the_place_of_a_moving_mass_needs_all_its_axes() -> None:
    told = recorded({}, {'motors/effort.one': 0.5})
    names = [f'motors/position.moving_mass_{axis}' for axis in 'xyz']
    for k, name in enumerate(names):
        told[name] = channel(name, np.arange(3.0), np.array([0.1, 0.2, 0.3]) + k)
    told[names[1]].values[1] = np.nan
    found = build_streams(told, ('one',)).mass
    assert found is not None
    assert found.time.tolist() == [0.0, 2.0]
    np.testing.assert_allclose(found.values, [[0.1, 1.1, 2.1], [0.3, 1.3, 2.3]])
    told[names[1]].values[:] = np.nan
    assert build_streams(told, ('one',)).mass is None
    del told[names[2]]
    assert build_streams(told, ('one',)).mass is None


def test_rotor_commands_are_zero_if_a_wrench_is_commanded() -> None:
    told = build_streams(recorded({'wrench_command/wrench.force.x': 0.1}, {}), ('one', 'two'))
    assert told.commands.values.tolist() == [[0.0, 0.0]]
    assert told.commands.time.tolist() == [0.0]
    with pytest.raises(BadInput, match='no commands for two'):
        build_streams(recorded({}, {'motors/effort.one': 0.5}), ('one', 'two'))
