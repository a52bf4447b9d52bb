"""Assemble the motion in pose topics and inertial sensors from their channels."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
import re
from typing import Any, Final, final, NamedTuple

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits, roles
from lta_data.even_grid import interpolate_on_grid, median_period, sort_samples, spread_evenly
from lta_data.interpretation.kinematics import derive_vector
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter, uniform_filter1d
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


# Smallest standard deviation of a derived vector that is motion, not noise of the tracker
MOVING: Final = {
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
        """The attitude."""
        assert self.pose.attitude is not None
        return self.pose.attitude

    @property
    def span(self) -> tuple[float, float]:
        """First and last time. [s]"""
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


LONGEST: Final = 1.5  # of a jump [s]
AROUND: Final = 15  # changes; width of the median filter that gives the usual one
HALF: Final = 0.6745  # median of the absolute value of white noise, in standard deviations
CLEAR: Final = 12.0  # standard deviations off the usual change
LEAST: Final = 0.02  # m, or quaternion component
REACH: Final = 0.5  # that a vehicle may accelerate within a gap [m/s2]
RETURNS: Final = 0.5  # of the jump, at most, that the pose behind it is off
BODIES: Final = 4  # that a tracker may report in turn
QUIET: Final = 0.2  # quantile of the changes that no jump has, however many there are
NOISE: Final = 1.0  # that quantile of the length of white noise, in standard deviations
BURST: Final = 2.0  # times its usual speed a vehicle changes its speed from pose to pose, at most


def find_steps(time: Array, poses: Array, least: float) -> tuple[Any, Array]:
    """
    Return which changes from pose to pose no inertia allows, and by how much they are off.

    A vehicle keeps its speed from one pose to the next, but for noise and for what a collision
    takes away. Where a tracker reports several bodies in turn, each keeps its own.

    `time`: increasing, shape (n,) [s]. `poses`: positions, shape (n, 3) [m], or quaternions,
    shape (n, 4). `least`: size of a step [m or rad].
    """
    count = len(time) - 1
    slopes, usual = [], []
    for apart in range(1, BODIES + 1):
        change, step = _measure_changes(poses, apart), (time[apart:] - time[:-apart])[:, None]
        # Not the median of quotients, since messages that come together have no time between them
        way = median_filter(change, size=(AROUND, 1), mode='nearest')
        slope = way / uniform_filter1d(step, AROUND, axis=0, mode='nearest')
        usual.append(np.quantile(np.linalg.norm(change - way, axis=1), QUIET))
        slopes.append(np.pad(slope, ((0, count - len(slope)), (0, 0)), mode='edge'))
    paces = np.array([np.linalg.norm(slope, axis=1) for slope in slopes])
    # Where bodies alternate, the speed from one pose to the next of the same body is the true one
    slope = np.array(slopes)[paces.argmin(axis=0), np.arange(count)]
    step = np.diff(time)
    off = np.linalg.norm(_measure_changes(poses, 1) - slope * step[:, None], axis=1)
    fast = float(np.quantile(paces.min(axis=0), 0.75))
    allowed = np.maximum(
        CLEAR * min(usual) / NOISE, BURST * fast * np.maximum(step, np.median(step))
    )
    return off > np.maximum(allowed + REACH * step**2, least), off


def _measure_changes(poses: Array, apart: int) -> Array:
    """Return ways [m], or turns [rad], between poses so many rows apart, shape (n - apart, 3)."""
    if poses.shape[1] == 3:
        return np.asarray(poses[apart:] - poses[:-apart])
    turn = Rotation.from_quat(poses)
    return (turn[:-apart].inv() * turn[apart:]).as_rotvec()


def find_tracker_jumps(time: Array, poses: Array) -> Any:  # noqa: ANN401 - an array of bool
    """
    Return a mask of the poses between a jump and the jump back.

    `time`: rising, shape (n,) [s]. `poses`, shape (n, k): positions [m], or quaternions without
    sign changes. A jump that does not return is not marked, as nothing tells which side is right.
    """
    out = np.zeros(len(poses), dtype=np.bool_)
    rows = np.flatnonzero(np.isfinite(poses).all(axis=1))
    if len(rows) < 2 * AROUND:
        return out
    at, whole = time[rows], poses[rows]
    change, step = np.diff(whole, axis=0), np.diff(at)[:, None]
    slope = median_filter(change / step, size=(AROUND, 1), mode='nearest')
    off = np.abs(change - slope * step)
    usual = np.median(off, axis=0) / HALF
    far = off / np.maximum(CLEAR * usual, LEAST + REACH * step**2)
    jumps = np.flatnonzero((far > 1.0).any(axis=1))
    done = -1
    for index, begin in enumerate(jumps.tolist()):
        later = jumps[index + 1 :]
        later = later[at[later + 1] - at[begin] <= LONGEST]
        if begin < done or not len(later):
            continue
        size = far[begin].max() * np.maximum(CLEAR * usual, LEAST)
        # By the speeds on both sides, which a curve needs
        speed = 0.5 * (slope[begin] + slope[later])
        expected = whole[begin] + speed * (at[later + 1] - at[begin])[:, None]
        back = later[(np.abs(whole[later + 1] - expected) < RETURNS * size).all(axis=1)]
        if len(back):
            done = int(back[0])
            out[rows[begin + 1 : done + 1]] = True
    return out
