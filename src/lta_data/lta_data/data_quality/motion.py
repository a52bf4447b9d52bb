"""Assemble the motion in pose topics and inertial sensors from their channels."""

from collections.abc import Mapping
from dataclasses import dataclass
import re
from typing import final

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import roles
from lta_data.data_quality.smoothing import sort_samples, spread_evenly
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

    def differentiate(self) -> tuple[Array, Array]:
        """Return the times of the derivative between samples, and the derivative."""
        step = np.diff(self.time)
        # Between samples: a one-sided difference at the samples would be half a period late
        return self.time[:-1] + step / 2, np.diff(self.values, axis=0) / step[:, None]


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
    channels: Mapping[str, SignalChannel], rule: re.Pattern[str], parts: str
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
            time, values = sort_samples(channels[names[0]].time, table)
            # Fewer samples do not allow two derivatives
            if len(time) > 3:
                vectors[topic] = VectorSeries(f'{topic}/{path}', time, values)
    return vectors


def collect_attitudes(channels: Mapping[str, SignalChannel]) -> dict[str, VectorSeries]:
    """Return attitudes as quaternions by topic, from quaternions or Euler angles."""
    attitudes = {}
    for topic, vector in collect_vectors(channels, roles.QUATERNION, 'xyzw').items():
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
        time, angles = sort_samples(channels[names[0]].time, table)
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


def collect_poses(channels: Mapping[str, SignalChannel], evenly: bool = True) -> list[PoseSeries]:
    """Return the topics with the motion of the vehicle, trackers first; evenly for derivatives."""
    place = collect_vectors(channels, roles.POSITION, 'xyz')
    attitude = collect_attitudes(channels)
    speed = collect_vectors(channels, roles.SPEED, 'xyz')
    turning = collect_vectors(channels, roles.TURNING, 'xyz')
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


def collect_inertials(channels: Mapping[str, SignalChannel]) -> list[InertialSeries]:
    """Return the inertial sensors."""
    rates = collect_vectors(channels, roles.RATES, 'xyz')
    force = collect_vectors(channels, roles.FORCE, 'xyz')
    return [
        InertialSeries(
            topic, *(part and part.spread() for part in (rates.get(topic), force.get(topic)))
        )
        for topic in dict.fromkeys((*rates, *force))
    ]


def compute_body_rates(attitude: VectorSeries) -> tuple[Array, Array]:
    """Return body rates between attitudes [rad/s] and their times, in the middle. [s]"""
    turn = Rotation.from_quat(attitude.values)
    step = np.diff(attitude.time)
    # The rotation from one attitude to the next, in the body frame of the first
    rates = (turn[:-1].inv() * turn[1:]).as_rotvec() / step[:, None]
    return attitude.time[:-1] + step / 2, rates
