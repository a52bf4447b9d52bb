# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate velocity and rates from poses by fitting a parabola around each pose.

A pose is output once the later poses of its window have arrived; the delay does not matter, since
no node flies by it. The derivatives then have no lag, and are exact at constant acceleration for
any spacing. The pose itself is not smoothed.
"""

from collections import deque
from collections.abc import Iterator
import math
from typing import Final, final, NamedTuple

from lta_bridge.tracking.pose import Three, TrackerPose
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

HALF_NS: Final = 50_000_000  # half of the window: an airship's motion is many times slower
GAP_NS: Final = 250_000_000  # no derivative is taken across a longer gap


class TrackerMotion(NamedTuple):
    """A pose with its motion."""

    stamp_ns: int  # stamp of the pose [ns]
    pose: TrackerPose  # the pose, not smoothed
    # In the body frame [m/s, rad/s]
    velocity: Three
    rates: Three
    # Standard deviations from the residuals of the parabola; NaN without degrees of freedom [m,
    # rad, m/s, rad/s]
    place_sigma: float
    turn_sigma: float
    velocity_sigma: float
    rates_sigma: float


@final
class MotionWindow:
    """
    Collect poses and yield them with their motion once it is known.

    Attribute `gaps`: number of gaps longer than `GAP_NS`.
    """

    def __init__(self) -> None:
        self.gaps = 0
        self._poses: deque[tuple[int, TrackerPose]] = deque()
        self._next = 0  # index of the first pose not yielded yet

    def clear(self) -> None:
        """Discard all poses."""
        self._poses.clear()
        self._next = 0

    def add_pose(self, stamp_ns: int, pose: TrackerPose) -> Iterator[TrackerMotion]:
        """Add a pose, later than all before; yield the motions that it completes."""
        if self._poses and stamp_ns - self._poses[-1][0] > GAP_NS:
            self.gaps += 1
            self.clear()
        self._poses.append((stamp_ns, pose))
        while self._next < len(self._poses) - 1:
            centre = self._poses[self._next][0]
            # The window of the centre is not complete yet
            if stamp_ns < centre + HALF_NS:
                return
            # The first pose has none before it.
            if self._next > 0:
                yield estimate_motion(list(self._select_window_poses(centre)), centre)
            self._next += 1
            self._drop_old_poses()

    def _select_window_poses(self, centre_ns: int) -> Iterator[tuple[int, TrackerPose]]:
        """Yield the poses of the window, and the direct neighbours even if farther away."""
        for k, item in enumerate(self._poses):
            if abs(item[0] - centre_ns) <= HALF_NS or abs(k - self._next) <= 1:
                yield item

    def _drop_old_poses(self) -> None:
        """Discard poses that no window needs any more."""
        centre = self._poses[self._next][0]
        while self._next > 1 and self._poses[0][0] < centre - HALF_NS:
            self._poses.popleft()
            self._next -= 1


def estimate_motion(poses: list[tuple[int, TrackerPose]], centre_ns: int) -> TrackerMotion:
    """
    Return the motion at one of three or more poses.

    `poses`: stamps [ns] and poses, in order. `centre_ns`: stamp of the pose at which to evaluate
    [ns].
    """
    pose = next(each for stamp, each in poses if stamp == centre_ns)
    t = np.array([1e-9 * (stamp - centre_ns) for stamp, _ in poses])
    turn = Rotation.from_quat(pose.turn)
    own = turn.inv()
    # In the body frame of the central pose, so that the slopes are body velocities
    places = own.apply(np.array([each.place for _, each in poses]) - pose.place)
    turns = (own * Rotation.from_quat([each.turn for _, each in poses])).as_rotvec()
    slope, (place, spun), grown = fit_parabola(t, np.hstack((places, turns)))
    vx, vy, vz, wx, wy, wz = slope
    return TrackerMotion(
        centre_ns, pose, (vx, vy, vz), (wx, wy, wz), place, spun, grown * place, grown * spun
    )


def fit_parabola(
    t: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[list[float], tuple[float, float], float]:
    """
    Return the slope at 0 of least-squares parabolas through positions and rotations.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Times relative to the evaluated pose. [s]
    y : ndarray, shape (n, 6)
        Three coordinates of the position, three of the rotation. [m, rad]

    Returns
    -------
    slope : list of float
        Slope of each column. [1/s]
    sigma : 2-tuple of float
        Standard deviations of position and rotation; NaN without degrees of freedom.
    grown : float
        Factor from the standard deviation of a value to that of the slope. [1/s]

    """
    scale = float(np.max(np.abs(t)))
    # Times scaled to -1..1 for conditioning; columns 1, t, t**2
    columns = np.vander(t / scale, 3, increasing=True)
    inverse = np.linalg.pinv(columns)
    coefficients = inverse @ y
    # Degrees of freedom of three axes; NaN if three poses fit exactly
    spare = 3 * (len(t) - 3) or math.nan
    left = ((y - columns @ coefficients) ** 2).sum(axis=0).tolist()
    sigma = math.sqrt(sum(left[:3]) / spare), math.sqrt(sum(left[3:]) / spare)
    slope: list[float] = (coefficients[1] / scale).tolist()
    # The row norm of the pseudoinverse propagates the noise of a pose to the slope
    return slope, sigma, math.hypot(*inverse[1].tolist()) / scale
