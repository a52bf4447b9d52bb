# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Assemble the motion in pose topics and inertial sensors from their channels."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
import re
from typing import Final, final, NamedTuple

from lta_data.data_quality import limits, roles
from lta_data.even_grid import interpolate_on_grid, median_period, sort_samples, spread_evenly
from lta_data.flight import Channel
from lta_data.interpretation.kinematics import derive_vector
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
MEANT = 0.1  # length of a mean of quaternions that is still an attitude


@final
@dataclass(frozen=True, slots=True)
class VectorSeries:
    """A vector over time."""

    name: str  # topic and path without the axis: 'imu/angular_velocity'
    time: Array  # increasing, shape (n,) [s]
    values: Array  # shape (n, 3); (n, 4) for a quaternion

    def spread(self) -> 'VectorSeries':
        """Return the vector on an even grid where its messages came irregularly."""
        time, values = spread_evenly(self.time, self.values)
        if self.values.shape[1] == 4:
            size = np.linalg.norm(values, axis=1)
            good = size > MEANT
            time, values = time[good], values[good] / size[good, None]
        return VectorSeries(self.name, time, values)

    def interpolate(self, times: Array) -> Array:
        """Return the vector at other times, NaN outside and in gaps, shape (m, n)."""
        table, inside = interpolate_on_grid(self.time, self.values, times)
        return np.where(inside[:, None], table, np.nan)


@final
@dataclass(frozen=True, slots=True)
class PoseSeries:
    """The vehicle's motion in one topic; None for missing quantities."""

    topic: str
    tracked: bool
    position: VectorSeries | None
    attitude: VectorSeries | None
    velocity: VectorSeries | None
    turning: VectorSeries | None


@final
@dataclass(frozen=True, slots=True)
class InertialSeries:
    """The data of an inertial sensor."""

    topic: str
    rates: VectorSeries | None
    force: VectorSeries | None


def collect_vectors(
    channels: Mapping[str, Channel], rule: re.Pattern[str], parts: str
) -> dict[str, VectorSeries]:
    """Return complete vectors by topic, the first of each topic that matches the rule."""
    paths: dict[str, str] = {}
    for channel in channels.values():
        match = rule.match(channel.field)
        if match is not None:
            paths.setdefault(channel.topic, match[1])
    vectors: dict[str, VectorSeries] = {}
    for topic, path in paths.items():
        names = [f'{topic}/{path}.{part}' for part in parts]
        if all(name in channels for name in names):
            table = np.stack([channels[name].values for name in names], axis=1)
            time, values = sort_samples(channels[names[0]].time, table).select_complete()
            # Fewer samples do not allow two derivatives
            if len(time) > 3:
                vectors[topic] = VectorSeries(f'{topic}/{path}', time, values)
    return vectors


def collect_attitudes(channels: Mapping[str, Channel]) -> dict[str, VectorSeries]:
    """Return attitudes as quaternions by topic, from quaternions or Euler angles."""
    attitudes = {}
    for topic, vector in collect_vectors(channels, roles.QUATERNION_FIELD, 'xyzw').items():
        length = np.linalg.norm(vector.values, axis=1)
        # An unfilled quaternion is zero.
        good = length > 1e-6
        if good.sum() > 3:
            turns = vector.values[good] / length[good, None]
            attitudes[topic] = VectorSeries(
                vector.name, vector.time[good], remove_sign_jumps(turns)
            )
    named = {channel.topic: match[1] for channel in channels.values()
             if (match := roles.ANGLE.match(channel.field))}  # fmt: skip
    for topic, path in named.items():
        names = [f'{topic}/{path}.{part}' for part in ('yaw', 'pitch', 'roll')]
        if topic in attitudes or not all(name in channels for name in names):
            continue
        table = np.stack([channels[name].values for name in names], axis=1)
        time, angles = sort_samples(channels[names[0]].time, table).select_complete()
        if len(time) > 3:
            # Upper case: intrinsic yaw, pitch, roll
            turns = Rotation.from_euler('ZYX', angles).as_quat()
            attitudes[topic] = VectorSeries(f'{topic}/{path}', time, remove_sign_jumps(turns))
    return attitudes


def remove_sign_jumps(turns: Array) -> Array:
    """Return quaternions without sign jumps; q and -q are the same attitude."""
    # A negative dot product is the other sign of nearly the same attitude.
    flips = np.where((turns[1:] * turns[:-1]).sum(axis=1) < 0.0, -1.0, 1.0)
    return np.asarray(turns * np.concatenate(([1.0], np.cumprod(flips)))[:, None])


def collect_poses(channels: Mapping[str, Channel], evenly: bool = True) -> list[PoseSeries]:
    """Return the topics with the motion of the vehicle, trackers first; evenly for derivatives."""
    place = collect_vectors(channels, roles.POSITION_PATTERN, 'xyz')
    attitude = collect_attitudes(channels)
    speed = collect_vectors(channels, roles.SPEED, 'xyz')
    turning = collect_vectors(channels, roles.TURNING_FIELD, 'xyz')
    topics = dict.fromkeys((*place, *attitude, *speed, *turning))
    poses = []
    for topic in topics:
        tracked = bool(roles.TRACKED.match(topic))
        if tracked or topic == 'odom' or roles.is_instrument_topic(topic):
            parts = [table.get(topic) for table in (place, attitude, speed, turning)]
            if evenly:
                parts = [part and part.spread() for part in parts]
            poses.append(PoseSeries(topic, tracked, *parts))
    return sorted(poses, key=lambda pose: not pose.tracked)


def collect_inertials(channels: Mapping[str, Channel]) -> list[InertialSeries]:
    """Return the inertial sensors."""
    rates = collect_vectors(channels, roles.RATES_FIELD, 'xyz')
    force = collect_vectors(channels, roles.FORCE_FIELD, 'xyz')
    return [
        InertialSeries(
            topic, *(part and part.spread() for part in (rates.get(topic), force.get(topic)))
        )
        for topic in dict.fromkeys((*rates, *force))
    ]


# Smallest standard deviation of a derived vector that is motion, not noise of the tracker
MOVING_SPREADS: Final = {
    'rates': limits.TURN_MOTION, 'velocity': limits.SPEED_MOTION, 'force': limits.FORCE_MOTION,
}  # fmt: skip


@final
class MeasuredVector(NamedTuple):
    """A sensor's vector at the times of a pose; its values are NaN where it is unknown."""

    kind: str  # 'rates', 'velocity' or 'force'
    name: str
    values: Array  # shape (n, 3)


@final
class PoseMotion(NamedTuple):
    """A pose with an attitude, and the vectors that follow from it."""

    pose: PoseSeries
    seconds: Array  # shape (n,)
    turn: Rotation  # n, from body to world
    place: Array | None  # NaN where it is unknown, shape (n, 3) [m]
    vectors: Sequence[MeasuredVector]

    @property
    def attitude(self) -> VectorSeries:
        """Return the attitude."""
        assert self.pose.attitude is not None
        return self.pose.attitude

    @property
    def span(self) -> tuple[float, float]:
        """First and last time [s]."""
        return float(self.seconds[0]), float(self.seconds[-1])

    def list_vectors(self, kind: str) -> list[MeasuredVector]:
        """Return the vectors of a kind."""
        return [one for one in self.vectors if one.kind == kind]

    def derive(self, kind: str, turn: Rotation | None = None, place: Array | None = None) -> Array:
        """Return what this pose, or another reading of it, implies for a vector."""
        place = self.place if place is None else place
        return derive_vector(kind, self.turn if turn is None else turn, place, self.seconds)

    def name_reference(self, kind: str) -> str:
        """Return the name of what a vector is derived from."""
        place = self.pose.position
        return self.attitude.name if kind == 'rates' or place is None else place.name


def collect_motions(
    poses: Sequence[PoseSeries], sensors: Sequence[InertialSeries]
) -> list[PoseMotion]:
    """Return the poses with an attitude, beside the sensors that overlap with them long enough."""
    motions = []
    for pose in poses:
        attitude = pose.attitude
        if attitude is None or len(attitude.time) < limits.LEAST_SAMPLES:
            continue
        vectors = [
            MeasuredVector(kind, one.name, one.interpolate(attitude.time))
            for kind, one in _list_measured(pose, sensors)
            if len(one.time) >= limits.LEAST_SAMPLES
        ]
        period = median_period(attitude.time)
        lasting = [
            one for one in vectors
            if np.isfinite(one.values[:, 0]).sum() * period >= limits.PAIR_TIME
        ]  # fmt: skip
        place = None if pose.position is None else pose.position.interpolate(attitude.time)
        turn = Rotation.from_quat(attitude.values)
        motions.append(PoseMotion(pose, attitude.time, turn, place, lasting))
    return motions


def _list_measured(
    pose: PoseSeries, sensors: Sequence[InertialSeries]
) -> Iterator[tuple[str, VectorSeries]]:
    """Yield kind and vector of what a pose implies: of its topic, and of inertial sensors."""
    if pose.turning is not None:
        yield 'rates', pose.turning
    is_placed = pose.position is not None and pose.tracked
    if pose.velocity is not None and is_placed:
        yield 'velocity', pose.velocity
    for sensor in sensors:
        if sensor.rates is not None:
            yield 'rates', sensor.rates
        if sensor.force is not None and is_placed:
            yield 'force', sensor.force
