"""Fit the yaw rotation and the shift that map one flight's world frame to another's."""

from dataclasses import dataclass
import math
from typing import Final, final

from lta_data.compare.sampling import Array, wrap_angle
import numpy as np

ROUNDS: Final = 50  # iterations, at most
TUKEY: Final = 4.685  # scaled residuals of zero weight; 95 % efficiency for normal noise
LEAST: Final = 0.05  # m of horizontal spread needed to estimate the rotation
TELLING: Final = 3.0  # least ratio of that spread to the misfit


@final
@dataclass(frozen=True, slots=True)
class FrameTransform:
    """Transformation of positions of B into A's frame: rotation about z, then a shift."""

    yaw: float  # [rad]
    # Shift after the rotation [m]
    x: float
    y: float
    z: float
    # RMS distance of the paths without and with the transformation [m]
    before: float
    after: float
    # Whether the rotation comes from the headings because the path is too short
    by_heading: bool = False

    def transform_positions(self, xyz: Array) -> Array:
        """Return positions of B, shape (n, 3), in A's frame. [m]"""
        x, y = self.rotate_vectors(xyz[:, 0], xyz[:, 1])
        return np.stack([x + self.x, y + self.y, xyz[:, 2] + self.z], axis=1)

    def rotate_vectors(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Return horizontal vectors of B, x and y of shape (n,), in A's frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return c * x - s * y, s * x + c * y


def fit_frame_transform(
    a: Array, b: Array, heading_a: Array | None = None, heading_b: Array | None = None
) -> FrameTransform | None:
    """
    Fit the transformation of B's path to A's; None for fewer than three common positions.

    Least squares of the horizontal distance over rotation and shift (Umeyama 1991, "Least-squares
    estimation of transformation parameters between two point patterns", for a rotation about z).
    Tukey weights keep a stretch in which the flights diverge from biasing the rest. The height
    offset is estimated in the same way.

    `a`, `b`, shape (n, 3): positions at the same times [m]. `heading_a`, `heading_b`, shape (n,):
    yaw at the same times, used if the path is too short [rad].
    """
    finite = np.isfinite(a).all(axis=1) & np.isfinite(b).all(axis=1)
    # Two points always fit a rotation and a shift, so they test nothing
    if finite.sum() < 3:
        return None
    a, b = a[finite], b[finite]
    # The vertical shift is independent of yaw, so it needs no joint fit
    height = robust_center(a[:, 2] - b[:, 2])
    weight = np.ones(len(a))
    yaw, shift = fit_yaw_and_shift(a, b, weight)
    for _ in range(ROUNDS):
        apart = horizontal_distances(a, b, yaw, shift)
        # 1.4826: standard deviation from the median absolute deviation of normal noise.
        scale = 1.4826 * float(np.median(apart))
        if scale <= 1e-12:
            break
        # Tukey's biweight.
        weight = np.maximum(0.0, 1.0 - (apart / (TUKEY * scale)) ** 2) ** 2
        last, (yaw, shift) = yaw, fit_yaw_and_shift(a, b, weight)
        if abs(wrap_angle(np.array(yaw - last))) < 1e-12:
            break
    # RMS distance from the mean position
    way = math.sqrt(float(np.sum(np.var(a[:, :2], axis=0))))
    misfit = 1.4826 * float(np.median(horizontal_distances(a, b, yaw, shift)))
    # A hover has no shape from which a rotation could be estimated.
    by_heading = way < max(LEAST, TELLING * misfit)
    if by_heading:
        yaw = mean_heading_difference(heading_a, heading_b)
        shift = fit_shift(a, b, yaw, np.ones(len(a)))
    transform = FrameTransform(yaw, float(shift[0]), float(shift[1]), height, 0.0, 0.0)
    return FrameTransform(
        yaw, float(shift[0]), float(shift[1]), height,
        rms_distance(a, b), rms_distance(a, transform.transform_positions(b)), by_heading,
    )  # fmt: skip


def robust_center(values: Array) -> float:
    """Return the centre of values with outliers: Tukey's M-estimate, started from the median."""
    middle = float(np.median(values))
    for _ in range(ROUNDS):
        scale = 1.4826 * float(np.median(np.abs(values - middle)))
        if scale <= 1e-12:
            break
        weight = np.maximum(0.0, 1.0 - ((values - middle) / (TUKEY * scale)) ** 2) ** 2
        last, middle = middle, float(np.average(values, weights=weight))
        if abs(middle - last) < 1e-9 * scale:
            break
    return middle


def rms_distance(a: Array, b: Array) -> float:
    """Return the RMS distance of two paths of shape (n, 3)."""
    return math.sqrt(float(np.mean(np.sum((a - b) ** 2, axis=1))))


def fit_yaw_and_shift(a: Array, b: Array, weight: Array) -> tuple[float, Array]:
    """Fit yaw [rad] and shift [m] in the plane by weighted least squares."""
    of_a, of_b = (np.average(part[:, :2], axis=0, weights=weight) for part in (a, b))
    ca, cb = a[:, :2] - of_a, b[:, :2] - of_b
    along = float(np.sum(weight * np.sum(ca * cb, axis=1)))
    across = float(np.sum(weight * (cb[:, 0] * ca[:, 1] - cb[:, 1] * ca[:, 0])))
    # Closed-form rotation in the plane: sum of cross products over sum of dot products
    yaw = math.atan2(across, along)
    return yaw, fit_shift(a, b, yaw, weight)


def fit_shift(a: Array, b: Array, yaw: float, weight: Array) -> Array:
    """Return the shift [m] that remains after a rotation by `yaw` [rad], shape (2,)."""
    of_a, of_b = (np.average(part[:, :2], axis=0, weights=weight) for part in (a, b))
    c, s = math.cos(yaw), math.sin(yaw)
    return np.asarray(of_a - np.array([c * of_b[0] - s * of_b[1], s * of_b[0] + c * of_b[1]]))


def horizontal_distances(a: Array, b: Array, yaw: float, shift: Array) -> Array:
    """Return the horizontal distance at each instant, shape (n,). [m]"""
    c, s = math.cos(yaw), math.sin(yaw)
    x = c * b[:, 0] - s * b[:, 1] + shift[0]
    y = s * b[:, 0] + c * b[:, 1] + shift[1]
    return np.asarray(np.hypot(a[:, 0] - x, a[:, 1] - y))


def mean_heading_difference(a: Array | None, b: Array | None) -> float:
    """Return the circular mean of the difference of headings; zero without headings. [rad]"""
    if a is None or b is None:
        return 0.0
    turn = a - b
    turn = turn[np.isfinite(turn)]
    if not len(turn):
        return 0.0
    return math.atan2(float(np.mean(np.sin(turn))), float(np.mean(np.cos(turn))))
