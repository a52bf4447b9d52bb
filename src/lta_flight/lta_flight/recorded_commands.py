# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read the commands of a recorded flight, to fly them through a vehicle file.

The simulation begins with the recorded pose and velocity, and holds each command until the next,
as the motors did; a commanded force or moment changes at control steps only. Where the recording
has no velocities, they are fitted to its first poses.
"""

from collections.abc import Mapping
from dataclasses import dataclass
import math
from pathlib import Path
from typing import Final, final

from lta_bag.bag_folder import find_bag
from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_data.bag.channels import iterate_channels
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_data.bag.table import DENSE
from lta_data.even_grid import check_time_span, median_period
from lta_data.flight import Channel
from lta_data.scene import COMMAND_CHANNEL, find_tracker_prefix, has_newton_commands, MASS_CHANNELS
from lta_model.effects import EFFECTS
from lta_model.measurement_chain import apply_chain, build_chains
from lta_model.state import POSITION, QUATERNION, RATES, RIGID, VELOCITY
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
Vector = tuple[float, float, float]

FIT_INTERVAL: Final = 0.5  # s; poses from which a missing velocity is fitted
SHORTEST_PART: Final = 1.0  # s
WRENCH_TOPIC: Final = 'wrench_command'
SUNK: Final = 0.02  # m below the height at which the vehicle stands
LARGEST_FORCE: Final = 10.0  # times the weight; a larger command is in another unit
EARLY: Final = 1e-6  # s; a command counts from its stamp, whose float is rounded
TWIST_FIELDS: Final = tuple(
    f'twist.twist.{kind}.{axis}' for kind in ('linear', 'angular') for axis in 'xyz'
)


@final
@dataclass(frozen=True, slots=True, eq=False)
class RecordedCommands:
    """
    Commands of a flight from a begin on, and its motion.

    Attributes
    ----------
    begin : float
        Stamp of the begin, on the clock of the recording. [s]
    duration : float
        Time from the begin to the last pose or command. [s]
    motion : array, shape (RIGID,)
        Position, quaternion, velocity and rates at the begin.
    times, duties : arrays, shapes (n,) and (n, rotors)
        Commands since the begin, held until the next. [s, 1]
    mass_places : array, shape (n, 3), or None
        Commanded place of the moving mass. [m]
    wrenches : array, shape (n, 6), or None
        Commanded force and moment, where the recording has these in place of duties, which are
        then zero; body frame. [N, N m]
    track_times, track : arrays, shapes (m,) and (m, 3)
        Recorded positions since the begin. [s, m]
    has_scene : bool
        Whether the recording states its scenario; else there is no lamp to judge a flight by.
    raised : float
        By how much the track is raised, so that it does not lie in the floor. [m]

    """

    begin: float
    duration: float
    motion: Array
    times: Array
    duties: Array
    mass_places: Array | None
    wrenches: Array | None
    track_times: Array
    track: Array
    has_scene: bool = False
    raised: float = 0.0

    def find_duties(self, elapsed: float) -> tuple[float, ...]:
        """Return the duties at a time since the begin [s]; 0 before the first command."""
        index = self._find_index(elapsed)
        row = self.duties[index] if index >= 0 else np.zeros(self.duties.shape[1])
        return tuple(row.tolist())

    def find_mass_place(self, elapsed: float) -> Vector | None:
        """Return the commanded place of the moving mass; None if there is none [m]."""
        index = self._find_index(elapsed)
        if self.mass_places is None or index < 0:
            return None
        x, y, z = self.mass_places[index].tolist()
        return x, y, z

    def find_wrench(self, elapsed: float) -> Array:
        """Return the commanded wrench at a time since the begin [s]; 0 before the first one."""
        index = self._find_index(elapsed)
        if self.wrenches is None or index < 0:
            return np.zeros(6)
        return np.asarray(self.wrenches[index])

    def _find_index(self, elapsed: float) -> int:
        return int(np.searchsorted(self.times, elapsed + EARLY, side='right')) - 1

    def distances_from(self, times: Array, positions: Array) -> Array:
        """Return the distances of positions, shape (k, 3), from the track at those times [m]."""
        recorded = np.column_stack(
            [np.interp(times, self.track_times, each) for each in self.track.T]
        )
        return np.asarray(np.linalg.norm(positions - recorded, axis=1))


def read_commands(
    bag: Path, vehicle: Vehicle, robot: str | None, begin: float, end: float | None
) -> RecordedCommands:
    """
    Read the commands of a recording for a vehicle.

    `begin`, `end`: part of the recording, since its first message; None for its end [s]. Raise
    `BadInput` if the recording has no tracked pose, no command for a rotor of the vehicle, or less
    than a second of both.
    """
    flight = open_flight(find_bag(bag), robot)
    pose_channels, prefix = _read_pose(flight, bag)
    if WRENCH_TOPIC in flight.topics and 'motors' not in flight.topics:
        times, wrenches = _read_wrenches(flight, vehicle)
        duties, places = np.zeros((len(times), len(vehicle.rotor_names))), None
    else:
        times, duties, places = _read_duties(flight, vehicle)
        wrenches = None
    poses = np.column_stack(
        [pose_channels[f'{prefix}position.{axis}'].values for axis in 'xyz']
        + [
            pose_channels[f'{prefix}orientation.{angle}'].values
            for angle in ('yaw', 'pitch', 'roll')
        ]
    )
    at = pose_channels[f'{prefix}position.x'].time
    valid = np.isfinite(poses).all(axis=1) & (at >= max(begin, times[0] - EARLY))
    if end is not None:
        valid &= at <= end
    at, poses = at[valid], poses[valid]
    last = min(at[-1], end if end is not None else times[-1]) if len(at) else 0.0
    if not len(at) or last - at[0] < SHORTEST_PART:
        raise BadInput(
            f"'{bag}' has less than {SHORTEST_PART:g} s with both a tracked pose and "
            f'commands in this '
            'part; choose another part with --begin and --end, or another recording.'
        )
    remedy = 'choose a part with --begin and --end'
    span, step = float(last - at[0]), median_period(at)
    check_time_span(f"of '{bag}'", span, step, len(at), remedy=remedy)
    # Stamps that jump again and again have a long median period, but the control steps do not
    control = load_topic_table().control_ns * 1e-9
    check_time_span(f"of '{bag}'", span, control, len(at), DENSE, remedy)
    reported = Rotation.from_euler('ZYX', poses[:, 3:])
    centres, turns = find_body_poses(vehicle, poses[:, :3], reported)
    raised = _find_raise(vehicle, centres[at <= last])
    centres = centres + np.array([0.0, 0.0, raised])
    # As the tracker reports it, in the simulation as well
    track = poses[:, :3] + np.array([0.0, 0.0, raised])
    motion = np.zeros(RIGID)
    motion[POSITION] = centres[0]
    motion[QUATERNION] = turns[0].as_quat()
    # A recorded twist is that of the reported frame, which the file may say is not the body's
    is_body = turns is reported
    twist = _read_twist(pose_channels, prefix, at[0]) if is_body else np.full(6, np.nan)
    motion[VELOCITY], motion[RATES] = find_velocity(twist, at, centres, turns)
    first = at[0]
    return RecordedCommands(
        flight.start * 1e-9 + float(first), float(last - first), motion, times - first, duties,
        places, wrenches, at - first, track, 'scenario_file' in flight.provenance, raised,
    )  # fmt: skip


def _read_pose(flight: RecordedFlight, bag: Path) -> tuple[dict[str, Channel], str]:
    """Return the channels of the tracker's topic and the prefix of its pose."""
    channels: dict[str, Channel] = {}
    for topic in flight.topics:
        if 'pose' in topic or 'odom' in topic:
            channels |= {each.name: each for each in iterate_channels(flight, topic)}
    try:
        prefix = find_tracker_prefix(channels)
    except BadInput as error:
        raise BadInput(f"'{bag}': {error}") from None
    return channels, prefix


def find_body_poses(vehicle: Vehicle, places: Array, turns: Rotation) -> tuple[Array, Rotation]:
    """Return hull centres, shape (n, 3) [m], and attitudes in the map, of tracked poses."""
    chain = build_chains(vehicle.collect_effects(), EFFECTS)['pose']
    if not chain:
        return places, turns
    # What the tracker reports is W body M: its frame, and that of the markers on the body
    still, *axes = (
        np.array(apply_chain(chain, (*place, 0.0, 0.0, 0.0, 1.0), 0.0))
        for place in (np.zeros(3), *np.eye(3))
    )
    frame = Rotation.from_matrix(np.column_stack([one[:3] - still[:3] for one in axes]))
    markers = frame.inv() * Rotation.from_quat(still[3:])
    body = frame.inv() * turns * markers.inv()
    return frame.inv().apply(places) - body.apply(frame.inv().apply(still[:3])), body


def _read_wrenches(flight: RecordedFlight, vehicle: Vehicle) -> tuple[Array, Array]:
    """Return times [s] and commanded wrenches, shape (n, 6) [N, N m]."""
    channels = {each.name: each for each in iterate_channels(flight, WRENCH_TOPIC)}
    named = [
        channels[f'{WRENCH_TOPIC}/wrench.{kind}.{axis}']
        for kind in ('force', 'torque')
        for axis in 'xyz'
    ]
    times, first = np.unique(named[0].time, return_index=True)
    wrenches = fill_with_last(np.column_stack([each.values for each in named])[first])
    most, weight = float(np.abs(wrenches).max(initial=0.0)), STANDARD_GRAVITY * vehicle.mass
    if most > LARGEST_FORCE * weight:
        raise BadInput(
            f"The commands in 'wrench_command' reach {most:.3g} N or N m, and "
            f'{vehicle.file.name} weighs {weight:.3g} N; import the log again with the right '
            'unit, or give the recorded vehicle with --vehicle.'
        )
    return times, wrenches


def fill_with_last(values: Array) -> Array:
    """Return columns in which an unknown number is the one before; 0 before the first."""
    finite = np.isfinite(values)
    last = np.maximum.accumulate(np.where(finite, np.arange(1, len(values) + 1)[:, None], 0), 0)
    padded = np.vstack([np.zeros((1, values.shape[1])), values])
    return np.asarray(np.take_along_axis(padded, last, 0))


def _read_duties(flight: RecordedFlight, vehicle: Vehicle) -> tuple[Array, Array, Array | None]:
    """Return times [s], duties by rotor and places of the moving mass [m]."""
    channels = (
        {each.name: each for each in iterate_channels(flight, 'motors')}
        if 'motors' in flight.topics
        else {}
    )
    names = [f'{COMMAND_CHANNEL}{name}' for name in vehicle.rotor_names]
    if missing := [name.removeprefix(COMMAND_CHANNEL) for name in names if name not in channels]:
        there = [
            name.removeprefix(COMMAND_CHANNEL)
            for name in channels
            if name.startswith(COMMAND_CHANNEL) and 'moving_mass' not in name
        ]
        raise BadInput(
            f'The recording has no commands for {", ".join(missing)} of {vehicle.file.name} in '
            f"'motors', but for {', '.join(sorted(there)) or 'no rotor'}; give the recorded "
            'vehicle with --vehicle, or name its rotors as the recording does.'
        )
    times, first = np.unique(channels[names[0]].time, return_index=True)
    # A command that a message lacks is the one before
    duties = fill_with_last(np.column_stack([channels[name].values for name in names])[first])
    if has_newton_commands(flight.provenance):
        duties = np.column_stack([
            [math.copysign(rotor.duty_for_thrust(abs(thrust)), thrust) for thrust in column]
            for rotor, column in zip(vehicle.rotors, duties.T, strict=True)
        ])  # fmt: skip
    if np.abs(duties).max(initial=0.0) > 1.0 + EARLY:
        raise BadInput(
            f"The commands in 'motors' reach {np.abs(duties).max():.3g}, but duties are from -1 "
            'to 1; import the log again with the right unit of its motors.'
        )
    places = None
    if vehicle.file.moving_mass and all(name in channels for name in MASS_CHANNELS):
        places = np.column_stack([channels[name].values for name in MASS_CHANNELS])[first]
    return times, duties, places


def _read_twist(channels: Mapping[str, Channel], prefix: str, time: float) -> Array:
    """Return recorded velocity and rates at a time, shape (6,); NaN where unknown."""
    topic = prefix.rpartition('/')[0]
    fields = [channels.get(f'{topic}/{field}') for field in TWIST_FIELDS]
    return np.array([
        math.nan if each is None else float(np.interp(time, each.time, each.values))
        for each in fields
    ])  # fmt: skip


def find_velocity(
    twist: Array, times: Array, track: Array, turns: Rotation
) -> tuple[Array, Array]:
    """Return velocity and rates at the first pose, body frame: recorded, or fitted to poses."""
    near = times <= times[0] + FIT_INTERVAL
    near[:2] = True  # a velocity needs two poses, however sparse they are
    since = times[near] - times[0]
    degree = min(2, len(since) - 1)
    velocity, rates = twist[:3], twist[3:]
    if not np.isfinite(velocity).all():
        slope = np.polynomial.polynomial.polyfit(since, track[near], degree)[1]
        velocity = turns[0].inv().apply(slope)
    if not np.isfinite(rates).all():
        turned = (turns[0].inv() * turns[near]).as_rotvec()
        rates = np.polynomial.polynomial.polyfit(since, turned, degree)[1]
    return velocity, rates


def _find_raise(vehicle: Vehicle, track: Array) -> float:
    """Return by how much a track lies below where the vehicle stands on the floor [m]."""
    sunk = vehicle.hull_height_on_floor - float(track[:, 2].min())
    return sunk if sunk > SUNK else 0.0
