"""
Two ways of knowing one motion: what a sensor says beside what a pose makes of it.

Each pair is on one even grid with both sides smoothed by one kernel, so that noise and the
derivative weigh alike; where they part, a unit, a sign, an axis or a clock is wrong.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_data.bag.channels import Channel
from lta_data.even_grid import even_grid
from lta_data.trust import roles
from lta_data.trust.limits import Limits
from lta_data.trust.motion import Inertial, inertials, Pose, poses, turned, Vector
from lta_data.trust.recording import Recording
from lta_data.trust.smooth import in_order, kernel, narrowed, on_grid, period, smoothed
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
AIR: float = 1.2 * STANDARD_GRAVITY  # pressure lost a metre of height [Pa/m]
FINEST = 0.01


@final
@dataclass(frozen=True, slots=True)
class Pair:
    """
    One motion known twice.

    Attributes
    ----------
    what : str
        'rates', 'velocity', 'force', 'range' or 'pressure'.
    told, made : str
        Names of what a sensor says and of what the other side is made of.
    unit : str
        Of both sides.
    least : float
        Smallest standard deviation of `right` that is a motion at all.
    grid : ndarray, shape (n,)
        [s]
    left, right : ndarray, shape (n, k)
        What is said, and what it should be; an axis a column.
    known : ndarray of bool, shape (n,)
        Where both are.
    axes : tuple of str
        What the columns are called.

    """

    what: str
    told: str
    made: str
    unit: str
    least: float
    grid: Array
    left: Array
    right: Array
    known: NDArray[np.bool_]
    axes: tuple[str, ...] = ('x', 'y', 'z')

    @property
    def step(self) -> float:
        """Of the grid. [s]"""
        return float(self.grid[1] - self.grid[0])

    @property
    def span(self) -> tuple[float, float]:
        """Where both are known. [s]"""
        times = self.grid[self.known]
        return float(times[0]), float(times[-1])

    def name(self, axis: int) -> str:
        """Return the channel of a column of the left side."""
        return f'{self.told}.{self.axes[axis]}' if len(self.axes) > 1 else self.told


def pairs(recording: Recording, limits: Limits) -> list[Pair]:
    """Return every motion of a recording that is known twice."""
    known, sensors = poses(recording.channels), inertials(recording.channels)
    found: list[Pair | None] = []
    for pose in known:
        found += _of_pose(pose, limits)
        for sensor in sensors:
            found += _of_inertial(pose, sensor, limits)
        if pose.tracked or not any(other.tracked for other in known):
            found += [_height(pose, channel, limits) for channel in recording.channels.values()]
    return [pair for pair in found if pair is not None]


def _of_pose(pose: Pose, limits: Limits) -> Iterator[Pair | None]:
    """Compare a pose with the speeds in the same message."""
    if pose.attitude is None:
        return
    if pose.turning is not None:
        yield made_rates(pose.turning, pose.attitude, limits)
    if pose.position is not None and pose.velocity is not None and pose.tracked:
        yield made_velocity(pose.position, pose.attitude, pose.velocity, limits)


def made_rates(told: Vector, attitude: Vector, limits: Limits) -> Pair | None:
    """Compare rates with the derivative of an attitude."""
    times, rates = turned(attitude)
    return _pair('rates', told, attitude.name, times, rates, limits)


def made_velocity(place: Vector, attitude: Vector, told: Vector, limits: Limits) -> Pair | None:
    """Compare a velocity with the derivative of position, in the body frame."""
    times, speeds = _derived(place)
    turn = _attitude_at(attitude, times)
    return _pair('velocity', told, place.name, times, turn.inv().apply(speeds), limits)


def _of_inertial(pose: Pose, sensor: Inertial, limits: Limits) -> Iterator[Pair | None]:
    """Compare a pose with an inertial sensor."""
    if pose.attitude is None:
        return
    if sensor.rates is not None:
        yield made_rates(sensor.rates, pose.attitude, limits)
    if sensor.force is not None and pose.position is not None and pose.tracked:
        yield _force(pose.position, pose.attitude, sensor.force, limits)


def _force(place: Vector, attitude: Vector, told: Vector, limits: Limits) -> Pair | None:
    """Compare specific force with acceleration and gravity."""
    step = max(period(place.time), FINEST)
    grid = even_grid(place.time[0], place.time[-1], step, len(place.time))
    if len(grid) * step < limits.pair_time:
        return None
    table, _ = on_grid(place.time, place.values, grid)
    smooth = smoothed(table, kernel(limits.kernel, step))
    pull = np.gradient(np.gradient(smooth, step, axis=0), step, axis=0)
    pull[:, 2] += STANDARD_GRAVITY
    force = _attitude_at(attitude, grid).inv().apply(pull)
    return _pair('force', told, place.name, grid, force, limits)


def _height(pose: Pose, channel: Channel, limits: Limits) -> Pair | None:
    """Compare a downward range or an air pressure with the height of a pose."""
    is_range = channel.field == 'range'
    if pose.position is None or not (is_range or roles.PRESSURE.match(channel.field)):
        return None
    time, values = in_order(channel.time, channel.values[:, None])
    if len(time) < limits.least_samples:
        return None
    height = values if is_range else -values / AIR
    told = Vector(channel.name, time, height)
    what = 'range' if is_range else 'pressure'
    place = pose.position
    return _pair(what, told, place.name, place.time, place.values[:, 2:], limits)


def _derived(vector: Vector) -> tuple[Array, Array]:
    """Return the derivative between samples and its times."""
    step = np.diff(vector.time)
    return vector.time[:-1] + step / 2, np.diff(vector.values, axis=0) / step[:, None]


def _attitude_at(attitude: Vector, times: Array) -> Rotation:
    """Return attitudes at other times, between the samples linear in the quaternion."""
    table, _ = on_grid(attitude.time, attitude.values, times)
    return Rotation.from_quat(table)


LEAST = {
    'rates': ('rad/s', 'turn_motion'),
    'velocity': ('m/s', 'speed_motion'),
    'force': ('m/s2', 'force_motion'),
    'range': ('m', 'height_motion'),
    'pressure': ('m', 'height_motion'),
}


def _pair(
    what: str, told: Vector, made: str, time: Array, derived: Array, limits: Limits
) -> Pair | None:
    """Put two sides on one grid; None where they do not overlap for long enough."""
    if len(time) < limits.least_samples or len(told.time) < limits.least_samples:
        return None
    step = max(period(time), period(told.time), FINEST)
    begin, end = max(time[0], told.time[0]), min(time[-1], told.time[-1])
    if not end - begin >= limits.pair_time:
        return None
    grid = even_grid(begin, end, step, len(time) + len(told.time))
    if not len(grid):
        return None
    weights = kernel(limits.kernel, step)
    left, there = on_grid(told.time, told.values, grid)
    right, also = on_grid(time, derived, grid)
    known = narrowed(there & also, weights)
    if known.sum() * step < limits.pair_time:
        return None
    unit, least = LEAST[what]
    axes = ('x', 'y', 'z') if told.values.shape[1] == 3 else ('',)
    return Pair(
        what, told.name, made, unit, getattr(limits, least), grid,
        smoothed(left, weights), smoothed(right, weights), known, axes,
    )  # fmt: skip
