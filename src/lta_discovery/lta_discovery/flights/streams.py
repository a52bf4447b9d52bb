# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Extract the streams of a flight from the channels of a recording."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from lta_config.errors import BadInput
from lta_data.flight import Channel
from lta_data.scene import COMMAND_CHANNEL, find_tracker_prefix, has_newton_commands, MASS_CHANNELS
from lta_discovery.flights.measured_flight import FlightStreams, Stream
from lta_discovery.model.nominal import NominalVehicle
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

SMALL_THRUST: Final = 0.1  # N; small rotors have less at full duty
WRENCH_STREAMS: Final = tuple(
    f'wrench_command/wrench.{kind}.{axis}' for kind in ('force', 'torque') for axis in 'xyz'
)
SENSOR_STREAMS: Final[dict[str, tuple[str, ...]]] = {
    'rates': tuple(f'imu/angular_velocity.{axis}' for axis in 'xyz'),
    'force': tuple(f'imu/linear_acceleration.{axis}' for axis in 'xyz'),
    'range': ('range/range',),
    'pressure': ('pressure/fluid_pressure',),
    'voltage': ('battery/voltage',),
}


def _join_channels(channels: Sequence[Channel]) -> Stream:
    """Join the channels of one topic, sorted by time, without duplicate times."""
    time = channels[0].time
    if any(len(channel.time) != len(time) for channel in channels):
        raise BadInput(
            f"The fields of the topic '{channels[0].topic}' have different numbers of readings; "
            'record the topic again.'
        )
    # Duplicate stamps would break the interpolation: keep the first of each
    _, first = np.unique(time, return_index=True)
    return Stream(time[first], np.column_stack([channel.values for channel in channels])[first])


def _read_wrench(channels: Mapping[str, Channel]) -> Stream | None:
    """Return the commanded wrench; axes without a command or a value are 0."""
    parts = [channels[name] for name in WRENCH_STREAMS if name in channels]
    if not parts:
        return None
    joined = _join_channels(parts)
    table = np.zeros((len(joined.time), len(WRENCH_STREAMS)))
    for column, channel in zip(joined.values.T, parts, strict=True):
        # Axes without a channel are not commanded and stay 0
        table[:, WRENCH_STREAMS.index(channel.name)] = np.nan_to_num(column)
    return Stream(joined.time, table)


def _read_moving_mass(channels: Mapping[str, Channel]) -> Stream | None:
    """Return the commanded place of the moving mass, None if it is not recorded."""
    if not all(name in channels for name in MASS_CHANNELS):
        return None
    joined = _join_channels([channels[name] for name in MASS_CHANNELS])
    valid = np.isfinite(joined.values).all(axis=1)
    return Stream(joined.time[valid], joined.values[valid]) if valid.any() else None


def convert_to_duties(
    streams: FlightStreams, nominal: NominalVehicle, provenance: Mapping[str, str]
) -> FlightStreams:
    """
    Convert commanded thrusts to duties, by inverting the thrust curve; duties stay as they are.

    `provenance`: of the recording. If it does not state the unit, commands that never exceed the
    full thrust of small rotors in newtons are taken for newtons: as duties they would be too
    small.
    """
    if streams.wrench is not None or not np.any(streams.commands.values):
        return streams  # no rotor commands
    count = streams.commands.values.shape[1]
    a, b = (
        np.array([nominal.parameter_value('thrust_curve', f'{c}_{i + 1}') for i in range(count)])
        for c in 'ab'
    )
    has_newtons = has_newton_commands(provenance)
    if has_newtons is None:
        most = np.nanmax(np.abs(streams.commands.values), axis=0, initial=0.0)
        # a + b is the thrust at full duty; 10 % margin for an inaccurate curve
        has_newtons = bool(np.all(a + b < SMALL_THRUST) and np.all(most <= 1.1 * (a + b)))
    if not has_newtons:
        return streams
    size = np.abs(streams.commands.values)
    # Invert thrust = a * duty**2 + b * duty; a = 0 is a linear curve.
    curved = np.where(a == 0.0, 1.0, a)
    root = (np.sqrt(b * b + 4.0 * curved * size) - b) / (2.0 * curved)
    duty = np.sign(streams.commands.values) * np.where(a == 0.0, size / b, root)
    return replace(streams, commands=Stream(streams.commands.time, duty))


def has_commands(channels: Mapping[str, Channel]) -> bool:
    """Return whether a recording has commands of any rotor, or a commanded wrench."""
    return any(name in WRENCH_STREAMS or name.startswith(COMMAND_CHANNEL) for name in channels)


def build_streams(
    channels: Mapping[str, Channel], rotors: Sequence[str], floor: float = -np.inf
) -> FlightStreams:
    """
    Build the streams of a flight from the channels of its recording.

    `rotors`: names of the actuators in the order of the vehicle file. `floor`: height of the hull
    centre below which the vehicle may touch the floor [m]. Without any command, all duties are 0.
    Raise `BadInput` if there is no tracked pose, or the commands are of other rotors.
    """
    start = find_tracker_prefix(channels)
    parts = [f'{start}position.{axis}' for axis in 'xyz']
    turns = [f'{start}orientation.{angle}' for angle in ('yaw', 'pitch', 'roll')]
    joined = _join_channels([channels[name] for name in (*parts, *turns)])
    valid = np.asarray(np.isfinite(joined.values).all(axis=1))
    quaternion = np.full((len(joined.time), 4), np.nan)
    # Channels hold Euler angles (intrinsic z-y-x); the model needs quaternions x y z w.
    quaternion[valid] = Rotation.from_euler('ZYX', joined.values[valid, 3:]).as_quat()
    missing = [name for name in rotors if f'{COMMAND_CHANNEL}{name}' not in channels]
    wrench = _read_wrench(channels) if missing else None
    if missing and wrench is None and has_commands(channels):
        there = [
            name.removeprefix(COMMAND_CHANNEL)
            for name in channels
            if name.startswith(COMMAND_CHANNEL)
        ]
        raise BadInput(
            f"The recording has no commands for {', '.join(missing)} in 'motors', and no "
            f"'wrench_command'; it has commands for {', '.join(sorted(there)) or 'no rotor'}. "
            'Give the recorded vehicle with --vehicle; its file must use the rotor names of the '
            'recording.'
        )
    # Without rotor commands the wrench drives the model, and the duties stay 0.
    if missing:
        commands = Stream(joined.time[:1], np.zeros((1, len(rotors))))
    else:
        commands = _join_channels([channels[f'{COMMAND_CHANNEL}{name}'] for name in rotors])
    others = {
        sensor: _join_channels([channels[name] for name in names])
        for sensor, names in SENSOR_STREAMS.items()
        if all(name in channels for name in names)
    }
    pose = Stream(joined.time, np.column_stack([joined.values[:, :3], quaternion]))
    return FlightStreams(pose, commands, others, floor, wrench, _read_moving_mass(channels))
