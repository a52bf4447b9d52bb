"""
Compare the motions in one pose topic sample by sample, whatever the scale of time and lengths.

The checks of pairs need seconds of overlap and motion of some size; a log whose times or lengths
are wrong by a factor of 1000 has neither. These figures have no scale: windows are counted in
samples, and a comparison yields a factor and a cosine.
"""

from dataclasses import replace
from typing import Final, final, NamedTuple

from lta_data.data_quality.motion import compute_body_rates, PoseSeries, VectorSeries
from lta_data.data_quality.smoothing import (
    hann_kernel,
    interpolate_on_grid,
    median_period,
    smooth_columns,
)
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
ALIKE: Final = 0.85  # cosine of two vectors of one motion
NEAR: Final = 0.3  # tolerance of a factor, as a logarithm
TILT: Final = 0.5  # cosine of lean and acceleration that tells up from down
WINDOW: Final = 15  # samples that are smoothed
DEGREES: Final = 180.0 / np.pi
TURN: Final = 2.0 * np.pi
LAGS: Final = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25)  # delays of a filter that a fit ignores [s]
OFFSETS: Final = 58  # whole turns of degrees in a turn of radians


@final
class VectorFit(NamedTuple):
    """A measured vector over a derived one."""

    factor: float  # ratio of their sizes
    cosine: float  # between both, over all samples; 1 for the same motion


UNKNOWN_FIT: Final = VectorFit(float('nan'), 0.0)


def compare_late_vectors(time: Array, derived: Array, measured: VectorSeries) -> VectorFit:
    """Compare a vector that a filter may delay with one from a pose, at the best delay."""
    moved = (replace(measured, time=measured.time - lag) for lag in LAGS)
    return max((compare_vectors(time, derived, one) for one in moved), key=lambda fit: fit.cosine)


def compare_vectors(time: Array, derived: Array, measured: VectorSeries) -> VectorFit:
    """Compare a measured vector with one that is derived from a pose at other times."""
    if len(time) < 3 * WINDOW or len(measured.time) < 3 * WINDOW:
        return UNKNOWN_FIT
    values, inside = interpolate_on_grid(measured.time, measured.values, time)
    inside &= np.isfinite(derived).all(axis=1)
    if inside.sum() < 3 * WINDOW:
        return UNKNOWN_FIT
    window = np.hanning(WINDOW + 2)[1:-1]
    left, right = (
        smooth_columns(_clip_outliers(side[inside]), window / window.sum())
        for side in (values, derived)
    )
    sizes = np.linalg.norm(left), np.linalg.norm(right)
    if not (sizes[0] > 0.0 and sizes[1] > 0.0):
        return UNKNOWN_FIT
    cosine = float((left * right).sum() / (sizes[0] * sizes[1]))
    return VectorFit(float(sizes[0] / sizes[1]), cosine)


def _clip_outliers(side: Array) -> Array:
    end = np.percentile(np.abs(side), 99.0, axis=0)
    return np.clip(side, -end, end)


def fit_rates(pose: PoseSeries, rates: VectorSeries, turn: Array | None = None) -> VectorFit:
    """Compare rates with the derivative of the attitude, or of another reading of it."""
    if pose.attitude is None:
        return UNKNOWN_FIT
    attitude = VectorSeries('', pose.attitude.time, pose.attitude.values if turn is None else turn)
    time, derived = compute_body_rates(attitude)
    return compare_late_vectors(time, derived, rates)


def fit_velocity(pose: PoseSeries, turn: Array | None = None) -> VectorFit:
    """Compare the body velocity with the derivative of the position."""
    if pose.attitude is None or pose.position is None or pose.velocity is None:
        return UNKNOWN_FIT
    time, speed = pose.position.differentiate()
    values = pose.attitude.values if turn is None else turn
    table, _ = interpolate_on_grid(pose.attitude.time, values, time)
    rotation = Rotation.from_quat(table)
    return compare_late_vectors(time, rotation.inv().apply(speed), pose.velocity)


def fit_speed(pose: PoseSeries) -> VectorFit:
    """Compare the sizes of velocity and of the derivative of the position, without an attitude."""
    if pose.position is None or pose.velocity is None:
        return UNKNOWN_FIT
    time, speed = pose.position.differentiate()
    lengths = np.linalg.norm(speed, axis=1, keepdims=True)
    speeds = np.linalg.norm(pose.velocity.values, axis=1, keepdims=True)
    return compare_late_vectors(time, lengths, VectorSeries('', pose.velocity.time, speeds))


def fit_tilt(pose: PoseSeries, turn: Array | None = None) -> VectorFit:
    """
    Compare the horizontal acceleration with the lean of the body's z axis.

    A rotorcraft accelerates by g times its lean; a negative cosine means that z points down.
    """
    if pose.attitude is None or pose.position is None or len(pose.position.time) < 5 * WINDOW:
        return UNKNOWN_FIT
    place = pose.position
    window = np.hanning(WINDOW + 2)[1:-1]
    calm = smooth_columns(place.values, window / window.sum())
    pull = np.gradient(np.gradient(calm, place.time, axis=0), place.time, axis=0)
    pull[:, 2] = 0.0
    values = pose.attitude.values if turn is None else turn
    lean = Rotation.from_quat(values).as_matrix()[:, :, 2]
    lean[:, 2] = 0.0
    series = VectorSeries('', pose.attitude.time, lean - lean.mean(axis=0))
    fit = compare_vectors(place.time, pull - pull.mean(axis=0), series)
    return VectorFit(1.0 / fit.factor if fit.factor else float('nan'), fit.cosine)


def fit_lever(pose: PoseSeries) -> VectorFit:
    """
    Compare the horizontal velocity with the rate of the lean of the body's z axis.

    A point above the axis about which a vehicle swings moves by its lever arm [m], the factor.
    """
    if pose.attitude is None or pose.position is None or len(pose.position.time) < 5 * WINDOW:
        return UNKNOWN_FIT
    time, speed = pose.position.differentiate()
    speed[:, 2] = 0.0
    rate = np.gradient(
        Rotation.from_quat(pose.attitude.values).as_matrix()[:, :, 2], pose.attitude.time, axis=0
    )
    rate[:, 2] = 0.0
    window = np.hanning(WINDOW + 2)[1:-1] / np.hanning(WINDOW + 2).sum()
    series = VectorSeries('', pose.attitude.time, smooth_columns(rate, window))
    fit = compare_vectors(time, smooth_columns(speed - speed.mean(axis=0), window), series)
    return VectorFit(1.0 / fit.factor if fit.factor else float('nan'), fit.cosine)


def is_near(factor: float, other: float) -> bool:
    """Return whether two factors are alike: positive, and within 35 % of each other."""
    return factor > 0.0 and abs(np.log(factor / other)) < NEAR


def covers_place(pose: PoseSeries) -> bool:
    """Return whether a pose has a whole position."""
    return pose.position is not None and bool(np.isfinite(pose.position.values).all())


def upright_share(turn: Array) -> float:
    """Return the share of the time with the body's z axis within 60 degrees of the map's."""
    return float(np.mean(_height_of_up(turn) > 0.5))


def is_inverted(turn: Array) -> bool:
    """Return whether the body's z axis points down nearly all the time."""
    return float(np.percentile(_height_of_up(turn), 90.0)) < -0.5


def _height_of_up(turn: Array) -> Array:
    """Return the vertical part of the body's z axis, from quaternions of shape (n, 4)."""
    return np.asarray(1.0 - 2.0 * (turn[:, 0] ** 2 + turn[:, 1] ** 2))


def tumbling_pace(attitude: VectorSeries) -> float:
    """
    Return the median angular rate of an attitude. [rad/s]

    It does not depend on the order of the components or the direction of a quaternion.
    """
    _, rates = compute_body_rates(attitude)
    return float(np.median(np.linalg.norm(rates, axis=1)))


def largest_angle(turn: Array) -> float:
    """Return the largest Euler angle. [rad]"""
    return float(np.max(np.abs(Rotation.from_quat(turn).as_euler('ZYX'))))


def measure_turn(attitude: VectorSeries) -> float:
    """Return the largest range of yaw, pitch or roll, smoothed over half a second. [rad]"""
    angles = np.unwrap(Rotation.from_quat(attitude.values).as_euler('ZYX'), axis=0)
    calm = smooth_columns(angles, hann_kernel(0.5, median_period(attitude.time)))
    return float(np.max(np.ptp(calm, axis=0)))


def magnify_angles(turn: Array) -> Array:
    """Return the attitudes whose Euler angles are 57.3 times as large."""
    angles = np.unwrap(Rotation.from_quat(turn).as_euler('ZYX'), axis=0)
    return np.asarray(Rotation.from_euler('ZYX', angles * DEGREES).as_quat())


def shrink_angles(turn: Array) -> Array:
    """
    Return yaw, pitch and roll that are 1/57.3 of continuous Euler angles, shape (n, 3).

    Angles in degrees that were read as radians turn over many times; of the two sets of angles
    of each attitude, the one next to the extrapolated last one is taken. Yaw lacks a constant.
    """
    base = Rotation.from_quat(turn).as_euler('ZYX')
    other = np.stack([base[:, 0] + np.pi, np.pi - base[:, 1], base[:, 2] + np.pi], axis=1)
    sets = np.stack([base, other], axis=1)
    angles = np.empty((len(base), 3))
    angles[0] = base[0]
    pace = np.zeros(3)
    for row in range(1, len(base)):
        expected = angles[row - 1] + pace
        moved = sets[row] - expected
        near = sets[row] - TURN * np.round(moved / TURN)
        best = near[int(np.argmin(np.abs(near - expected).sum(axis=1)))]
        pace = best - angles[row - 1]
        angles[row] = best
    return angles / DEGREES


def quaternions_of(angles: Array, yaw: float = 0.0) -> Array:
    """Return the quaternions of yaw, pitch and roll, with a constant added to yaw."""
    turned = angles + np.array([yaw, 0.0, 0.0])
    return np.asarray(Rotation.from_euler('ZYX', turned).as_quat())
