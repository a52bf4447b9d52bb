# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
Estimate the lamp's position and the drone's drift from bearings and strengths over time.

An extended Kalman filter (Bar-Shalom, Li and Kirubarajan, Estimation with applications to
tracking and navigation, 2001, ch. 10) with five states: the lamp relative to the drone p, the
drift w of the drone beyond its own dead reckoning, and the brightness c of the lamp:

.. math::

    p' = -(v + w), \quad w' = \text{noise}, \quad c' = \text{noise},
    \quad \varphi = \operatorname{atan2}(p_y, p_x), \quad \ln S = c - 2 \ln r

with v the velocity through the air, r the length of p, :math:`\varphi` the bearing in odom and S
the strength. The drift contains the wind and the error of the airspeed estimate: for some seconds
after a hand launch in wind that is the whole wind.

Bearings determine the drift across the line to the lamp, but not along it. Strengths determine
only the time to go, r / (v + w). The range r itself follows from the brightness, which is known
in advance within a factor (`LampFilterPrior`).
"""

import math
from typing import NamedTuple

from lta_control.motion import wrap_angle

Row = tuple[float, float, float, float, float]

NEAREST_BEARING = 0.4  # m; at shorter range a bearing carries no position information
FARTHEST_LAMP = 50.0  # m; no lamp is seen from farther away
LAMP_EXTENT = 0.1  # m; apparent displacement, because lamp and diode ring have an extent
LAMP_HEIGHT = 0.8  # m; assumed height of the lamp above or below the diodes
RECKONING_WALK = 0.01  # m; error of dead reckoning in one second
ASPECT_WALK = 0.15  # of ln(brightness) in one second: the lamp is seen from another side


class LampFilterPrior(NamedTuple):
    """Prior knowledge of the lamp and the light."""

    brightness: float  # logarithm of the strength at one metre [ln counts]
    unsure: float  # its standard deviation
    bearing_noise: float  # of one bearing, in addition to its own deviation [rad]
    strength_noise: float  # of the logarithm of one strength
    wind: float  # standard deviation of the drift before the first sight [m/s]
    gusts: float  # change of the drift in one second [m/s]
    over: float = 0.0  # height of the lamp beside the diodes, which adds to its range [m]


class LampFix(NamedTuple):
    """The lamp relative to the drone [m, odom], drift [m/s, odom], brightness, covariance."""

    x: float
    y: float
    wind_x: float
    wind_y: float
    brightness: float
    rows: tuple[Row, Row, Row, Row, Row]


def initialize_fix(
    optics: LampFilterPrior,
    bearing: float,
    deviation: float,
    strength: float,
    drift: tuple[float, float],
) -> LampFix:
    """
    Return the fix from a first sight.

    `bearing` and its `deviation` are in the odom frame [rad], `strength` is above 0 [counts], and
    `drift` is the prior drift [m/s, odom].
    """
    # Range from ln S = c - 2 ln r
    away = math.exp(0.5 * (optics.brightness - math.log(strength)))
    away = min(max(away, NEAREST_BEARING), FARTHEST_LAMP)
    cos, sin = math.cos(bearing), math.sin(bearing)
    slope = 0.5 * away  # derivative of the range by ln(brightness)
    variance = optics.unsure * optics.unsure
    along = slope * slope * (variance + optics.strength_noise**2)
    across = (away * math.hypot(deviation, optics.bearing_noise)) ** 2
    # Rotate the covariance from along/across the ray to x and y.
    xx, xy = along * cos * cos + across * sin * sin, (along - across) * cos * sin
    yy, wind = along * sin * sin + across * cos * cos, optics.wind * optics.wind
    # A brighter lamp is farther away: range and brightness are correlated
    xb, yb = slope * variance * cos, slope * variance * sin
    return LampFix(
        away * cos,
        away * sin,
        drift[0],
        drift[1],
        optics.brightness,
        (
            (xx, xy, 0.0, 0.0, xb),
            (xy, yy, 0.0, 0.0, yb),
            (0.0, 0.0, wind, 0.0, 0.0),
            (0.0, 0.0, 0.0, wind, 0.0),
            (xb, yb, 0.0, 0.0, variance),
        ),
    )


def predict_fix(
    optics: LampFilterPrior, fix: LampFix, moved_x: float, moved_y: float, dt: float
) -> LampFix:
    """Return a fix after a movement through the air [m, odom] in a time [s]."""
    # F P F^T by rows, with F = [[1, -dt], [0, 1]] in each axis
    r, s = fix.rows, dt
    a, b = (
        _propagate_row(_subtract_scaled(r[0], s, r[2]), s),
        _propagate_row(_subtract_scaled(r[1], s, r[3]), s),
    )
    c, d, e = _propagate_row(r[2], s), _propagate_row(r[3], s), _propagate_row(r[4], s)
    gusts = optics.gusts * optics.gusts * dt
    slip, faded = RECKONING_WALK * RECKONING_WALK * dt, ASPECT_WALK * ASPECT_WALK * dt
    rows = (
        (a[0] + slip, a[1], a[2], a[3], a[4]),
        (b[0], b[1] + slip, b[2], b[3], b[4]),
        (c[0], c[1], c[2] + gusts, c[3], c[4]),
        (d[0], d[1], d[2], d[3] + gusts, d[4]),
        (e[0], e[1], e[2], e[3], e[4] + faded),
    )
    return LampFix(
        fix.x - moved_x - fix.wind_x * dt,
        fix.y - moved_y - fix.wind_y * dt,
        fix.wind_x,
        fix.wind_y,
        fix.brightness,
        rows,
    )


def normalized_innovation(
    fix: LampFix, optics: LampFilterPrior, bearing: float, deviation: float
) -> float:
    """Return the difference of a bearing from the fix in standard deviations [1]."""
    slopes, error = _linearize_bearing(fix, bearing)
    noise = _bearing_noise(fix, optics, deviation)
    return abs(error) / math.sqrt(_dot(slopes, _multiply_matrix_vector(fix.rows, slopes)) + noise)


def expected_strength(fix: LampFix) -> float:
    """Return the strength that the fix predicts for a lamp at height `OVER` [counts]."""
    return math.exp(fix.brightness) / (fix.x * fix.x + fix.y * fix.y + LAMP_HEIGHT * LAMP_HEIGHT)


def update_fix(
    fix: LampFix, optics: LampFilterPrior, bearing: float, deviation: float, strength: float
) -> LampFix:
    """Return a fix after one more sight; arguments as in `initialize_fix`."""
    slopes, error = _linearize_bearing(fix, bearing)
    fix = _kalman_update(fix, slopes, error, _bearing_noise(fix, optics, deviation))
    # Linearise again at the updated fix: sequential updates need no matrix inversion.
    slopes, error = _linearize_strength(fix, optics, strength)
    return _kalman_update(fix, slopes, error, _strength_noise(fix, optics))


def bearing_deviation(fix: LampFix) -> float:
    """Return the standard deviation of the fix's bearing [rad]."""
    slopes, _ = _linearize_bearing(fix, 0.0)
    return math.sqrt(max(_dot(slopes, _multiply_matrix_vector(fix.rows, slopes)), 0.0))


def _squared_range(fix: LampFix) -> float:
    """Return the square of the range [m2]."""
    return max(fix.x * fix.x + fix.y * fix.y, NEAREST_BEARING * NEAREST_BEARING)


def _bearing_noise(fix: LampFix, optics: LampFilterPrior, deviation: float) -> float:
    """Return the variance of a bearing [rad2]."""
    return (
        deviation * deviation
        + optics.bearing_noise**2
        + LAMP_EXTENT * LAMP_EXTENT / _squared_range(fix)
    )


def _strength_noise(fix: LampFix, optics: LampFilterPrior) -> float:
    """Return the variance of ln(strength); near a lamp its unknown height adds to it."""
    return optics.strength_noise**2 + (LAMP_HEIGHT * LAMP_HEIGHT / _squared_range(fix)) ** 2


def _linearize_bearing(fix: LampFix, bearing: float) -> tuple[Row, float]:
    """Return the Jacobian of the bearing, and the innovation [rad]."""
    squared = _squared_range(fix)
    error = wrap_angle(bearing - math.atan2(fix.y, fix.x))
    return (-fix.y / squared, fix.x / squared, 0.0, 0.0, 0.0), error


def _linearize_strength(
    fix: LampFix, optics: LampFilterPrior, strength: float
) -> tuple[Row, float]:
    """Return the Jacobian of ln(strength), and the innovation."""
    squared = _squared_range(fix) + optics.over * optics.over
    error = math.log(strength) - (fix.brightness - math.log(squared))
    return (-2.0 * fix.x / squared, -2.0 * fix.y / squared, 0.0, 0.0, 1.0), error


def _kalman_update(fix: LampFix, slopes: Row, error: float, noise: float) -> LampFix:
    """Return a fix after one scalar measurement."""
    r = fix.rows
    g = _multiply_matrix_vector(r, slopes)
    spread = _dot(slopes, g) + noise
    k = error / spread
    return LampFix(
        fix.x + k * g[0],
        fix.y + k * g[1],
        fix.wind_x + k * g[2],
        fix.wind_y + k * g[3],
        fix.brightness + k * g[4],
        (
            _subtract_scaled(r[0], g[0] / spread, g),
            _subtract_scaled(r[1], g[1] / spread, g),
            _subtract_scaled(r[2], g[2] / spread, g),
            _subtract_scaled(r[3], g[3] / spread, g),
            _subtract_scaled(r[4], g[4] / spread, g),
        ),
    )


def _propagate_row(row: Row, dt: float) -> Row:
    """Return a covariance row multiplied by the transposed transition matrix."""
    return row[0] - dt * row[2], row[1] - dt * row[3], row[2], row[3], row[4]


def _subtract_scaled(row: Row, share: float, other: Row) -> Row:
    """Return a row minus a multiple of another."""
    return (
        row[0] - share * other[0],
        row[1] - share * other[1],
        row[2] - share * other[2],
        row[3] - share * other[3],
        row[4] - share * other[4],
    )


def _dot(a: Row, b: Row) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4]


def _multiply_matrix_vector(rows: tuple[Row, Row, Row, Row, Row], column: Row) -> Row:
    return (
        _dot(rows[0], column),
        _dot(rows[1], column),
        _dot(rows[2], column),
        _dot(rows[3], column),
        _dot(rows[4], column),
    )
