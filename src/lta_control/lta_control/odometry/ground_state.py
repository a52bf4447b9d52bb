# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
State and settings of the filter of the motion over ground.

Its nine states and their model are in `ground_filter`.
"""

import math
from typing import NamedTuple

from lta_config.settings import setting, Settings
import numpy as np
from numpy.typing import NDArray

Row = tuple[float, ...]  # one number per state
Matrix = NDArray[np.float64]  # shape (9, 9)
Covariance = tuple[float, float, float]  # xx, xy, yy of a vector in the plane

X, Y, DRIFT_X, DRIFT_Y, WIND_X, WIND_Y, BEARING, LOG_DISTANCE, BRIGHTNESS = range(9)
ZERO_ROW: Row = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

START_DEVIATION = 0.01  # m: standard deviation of the origin
RESTART_DEVIATION = 10.0  # m; of the position, where the filter begins again


class GroundSettings(Settings):
    """Prior knowledge of the wind, and the noise of the drag model and of lamp sightings."""

    wind: float = setting(0.3, 'm/s', 0.0, 20.0)
    """Standard deviation of the wind, along each axis, that is expected before the flight."""
    gusts: float = setting(0.015, 'm/s', 0.0, 5.0)
    """Expected random change of the wind in one second."""
    thrust_noise: float = setting(0.01, 'm/s', 0.0, 5.0)
    """Random error, in one second, of the velocity computed from thrust and drag."""
    bearing_noise: float = setting(0.05, 'rad', 1e-4, 3.0)
    """
    Standard deviation added to that of each bearing. It is larger than the error of one bearing,
    because the errors of successive bearings are alike.
    """
    strength_noise: float = setting(0.06, '1', 1e-3, 5.0)
    """Standard deviation of the logarithm of a measured lamp strength."""


class GroundMotion(NamedTuple):
    """State of the filter; it has no covariance before the first step."""

    # States in the order of the module's constants, and their covariance
    mean: Row = ZERO_ROW
    rows: Matrix = np.zeros((0, 0))
    air: tuple[float, float] = (0.0, 0.0)  # velocity of the drag model [m/s, odom]
    moved: tuple[float, float] = (0.0, 0.0)  # way since the last prediction [m, odom]
    elapsed: float = 0.0  # time since the last prediction [s]
    frequency: float = 0.0  # of the lamp in the state; 0 while there is none [Hz]
    doubted: float = 0.0  # time since the last sighting that fitted, with outliers only [s]
    restarts: int = 0  # how often the filter began again, because its state could not be computed
    on_ground: bool = False  # as in `ModelledMotion`, since the last prediction
    innovation: float = 0.0  # running mean of the normalised innovations of bearings
    # Correction by sightings that the position does not have yet [m, odom]
    pending: tuple[float, float] = (0.0, 0.0)

    @property
    def position(self) -> tuple[float, float]:
        """Position, into which corrections come little by little, so that it never jumps."""
        return self.mean[X] - self.pending[0], self.mean[Y] - self.pending[1]

    @property
    def position_covariance(self) -> Covariance:
        """Covariance of the position; what is pending counts as error [m2, odom]."""
        (x, y), r = self.pending, self.rows
        return r[X, X] + x * x, r[X, Y] + x * y, r[Y, Y] + y * y

    @property
    def velocity(self) -> tuple[float, float]:
        """Velocity over ground [m/s, odom]."""
        return self.air[0] + self.mean[DRIFT_X], self.air[1] + self.mean[DRIFT_Y]

    @property
    def velocity_covariance(self) -> Covariance:
        """Covariance of the velocity over ground [m2/s2, odom]."""
        r = self.rows
        return r[DRIFT_X, DRIFT_X], r[DRIFT_X, DRIFT_Y], r[DRIFT_Y, DRIFT_Y]

    @property
    def airspeed(self) -> tuple[float, float]:
        """Velocity through the air [m/s, odom]."""
        mean, (x, y) = self.mean, self.velocity
        return x - mean[WIND_X], y - mean[WIND_Y]

    @property
    def airspeed_covariance(self) -> Covariance:
        """Covariance of the velocity through the air [m2/s2, odom]."""
        r = self.rows
        return (
            slip_variance(r, DRIFT_X, WIND_X),
            r[DRIFT_X, DRIFT_Y] - r[DRIFT_X, WIND_Y] - r[WIND_X, DRIFT_Y] + r[WIND_X, WIND_Y],
            slip_variance(r, DRIFT_Y, WIND_Y),
        )


def rotate_covariance(covariance: Covariance, angle: float) -> Covariance:
    """Return a covariance in axes that are turned by an angle [rad]."""
    (xx, xy, yy), cos, sin = covariance, math.cos(angle), math.sin(angle)
    return (
        cos * cos * xx + 2.0 * cos * sin * xy + sin * sin * yy,
        (cos * cos - sin * sin) * xy + cos * sin * (yy - xx),
        sin * sin * xx - 2.0 * cos * sin * xy + cos * cos * yy,
    )


def start_ground_motion(settings: GroundSettings) -> GroundMotion:
    """Return the state at rest at the origin, in an unknown wind."""
    wind = settings.wind * settings.wind
    place = START_DEVIATION * START_DEVIATION
    return GroundMotion(rows=np.diag((place, place, 0.0, 0.0, wind, wind, 0.0, 0.0, 0.0)))


def is_computable(state: GroundMotion) -> bool:
    """Return whether all numbers are finite and all variances positive."""
    is_finite = bool(np.isfinite(state.rows).all() and np.isfinite(state.mean).all())
    return is_finite and bool(state.rows.diagonal().min() >= 0.0)


def restart_ground_motion(settings: GroundSettings, state: GroundMotion) -> GroundMotion:
    """Return a state that keeps the position, and knows of the motion no more than the prior."""
    place = [each if math.isfinite(each) else 0.0 for each in state.position]
    fresh = start_ground_motion(settings)
    lost, wind = RESTART_DEVIATION * RESTART_DEVIATION, fresh.rows[WIND_X, WIND_X]
    air = state.air if all(map(math.isfinite, state.air)) else (0.0, 0.0)
    return fresh._replace(
        mean=(*place, *ZERO_ROW[DRIFT_X:]),
        rows=np.diag((lost, lost, wind, wind, wind, wind, 0.0, 0.0, 0.0)),
        air=air,
        restarts=state.restarts + 1,
    )


def place_origin(state: GroundMotion) -> GroundMotion:
    """Return the state at the origin, of which nothing else depends on the position."""
    rows = state.rows.copy()
    rows[:DRIFT_X] = rows[:, :DRIFT_X] = 0.0
    rows[X, X] = rows[Y, Y] = START_DEVIATION * START_DEVIATION
    mean = (0.0, 0.0, *state.mean[DRIFT_X:])
    return state._replace(mean=mean, rows=rows, pending=(0.0, 0.0))


def slip_variance(rows: Matrix, drift: int, wind: int) -> float:
    """Return the variance of a drift less a wind [m2/s2]."""
    return max(float(rows[drift, drift] + rows[wind, wind] - 2.0 * rows[drift, wind]), 0.0)
