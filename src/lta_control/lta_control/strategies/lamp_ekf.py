r"""
Where a lamp is and how the drone drifts, from bearings and strengths over time.

An extended Kalman filter (Bar-Shalom, Li and Kirubarajan, Estimation with applications to tracking
and navigation, 2001, ch. 10) of five numbers: the lamp relative to the drone p, the drift w of the
drone beyond its own dead reckoning, and the brightness c of the lamp:

.. math::

    p' = -(v + w), \quad w' = \text{noise}, \quad c' = \text{noise},
    \quad \varphi = \operatorname{atan2}(p_y, p_x), \quad \ln S = c - 2 \ln r

with v the velocity through the air, r the length of p, :math:`\varphi` the bearing in odom and S
the strength. The drift is the wind, and whatever the airspeed estimate is wrong by: after a hand
lets go in wind that is all of the wind, for some seconds.

Across the line to the lamp the bearings tell the drift. Along it they tell nothing, and strengths
tell the time to go, r / (v + w), alone: what r itself is comes from the brightness, which the
drone knows beforehand within a factor (`Optics`).
"""

import math
from typing import NamedTuple

from lta_control.cascade import wrap_angle

Row = tuple[float, float, float, float, float]

NEAREST = 0.4  # m; nearer, a bearing says nothing about where the drone is
FARTHEST = 50.0  # m; farther, no lamp is seen
ASIDE = 0.1  # m by which a lamp seems to stand elsewhere: it and the diodes are no points
OVER = 0.8  # m by which it may stand higher or lower than the diodes
SLIP = 0.01  # m, of dead reckoning in a second
FADING = 0.15  # of the logarithm of the brightness in a second: a lamp seen from another side


class LampFilterPrior(NamedTuple):
    """What is known of the lamp and of the light beforehand."""

    brightness: float  # logarithm of the strength at one metre [ln counts]
    unsure: float  # its standard deviation
    bearing_noise: float  # of one bearing beyond its own deviation [rad]
    strength_noise: float  # of the logarithm of one strength
    wind: float  # standard deviation of the drift before anything is seen [m/s]
    gusts: float  # how much the drift changes in a second [m/s]


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
    Return what a first sight tells.

    Parameters
    ----------
    optics : Optics
        What is known beforehand.
    bearing, deviation : float
        Of the lamp, odom frame. [rad]
    strength : float
        Above 0. [counts]
    drift : tuple of float
        As far as it is known. [m/s, odom]

    """
    away = math.exp(0.5 * (optics.brightness - math.log(strength)))
    away = min(max(away, NEAREST), FARTHEST)
    cos, sin = math.cos(bearing), math.sin(bearing)
    slope = 0.5 * away  # of the range by the brightness
    variance = optics.unsure * optics.unsure
    along = slope * slope * (variance + optics.strength_noise**2)
    across = (away * math.hypot(deviation, optics.bearing_noise)) ** 2
    xx, xy = along * cos * cos + across * sin * sin, (along - across) * cos * sin
    yy, wind = along * sin * sin + across * cos * cos, optics.wind * optics.wind
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
    """Return a fix after a way through the air [m, odom] in a time [s]."""
    r, s = fix.rows, dt
    a, b = (
        _propagate_row(_subtract_scaled(r[0], s, r[2]), s),
        _propagate_row(_subtract_scaled(r[1], s, r[3]), s),
    )
    c, d, e = _propagate_row(r[2], s), _propagate_row(r[3], s), _propagate_row(r[4], s)
    gusts = optics.gusts * optics.gusts * dt
    slip, faded = SLIP * SLIP * dt, FADING * FADING * dt
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
    """Return how many standard deviations a bearing is off what the fix says. [1]"""
    slopes, error = _linearize_bearing(fix, bearing)
    noise = _bearing_noise(fix, optics, deviation)
    return abs(error) / math.sqrt(_dot_product(slopes, _multiply_rows(fix.rows, slopes)) + noise)


def expected_strength(fix: LampFix) -> float:
    """Return the strength that the fix says, of a lamp somewhat higher or lower. [counts]"""
    return math.exp(fix.brightness) / (fix.x * fix.x + fix.y * fix.y + OVER * OVER)


def update_fix(
    fix: LampFix, optics: LampFilterPrior, bearing: float, deviation: float, strength: float
) -> LampFix:
    """Return a fix after one more sight; arguments as of `initialize_fix`."""
    slopes, error = _linearize_bearing(fix, bearing)
    fix = _kalman_update(fix, slopes, error, _bearing_noise(fix, optics, deviation))
    slopes, error = _linearize_strength(fix, strength)
    return _kalman_update(fix, slopes, error, _strength_noise(fix, optics))


def bearing_deviation(fix: LampFix) -> float:
    """Return the standard deviation of the bearing that the fix says. [rad]"""
    slopes, _ = _linearize_bearing(fix, 0.0)
    return math.sqrt(max(_dot_product(slopes, _multiply_rows(fix.rows, slopes)), 0.0))


def _squared_range(fix: LampFix) -> float:
    """Return the square of the range. [m2]"""
    return max(fix.x * fix.x + fix.y * fix.y, NEAREST * NEAREST)


def _bearing_noise(fix: LampFix, optics: LampFilterPrior, deviation: float) -> float:
    """Return the variance of a bearing. [rad2]"""
    return deviation * deviation + optics.bearing_noise**2 + ASIDE * ASIDE / _squared_range(fix)


def _strength_noise(fix: LampFix, optics: LampFilterPrior) -> float:
    """Return the variance of a strength's logarithm: near a lamp its height counts."""
    return optics.strength_noise**2 + (OVER * OVER / _squared_range(fix)) ** 2


def _linearize_bearing(fix: LampFix, bearing: float) -> tuple[Row, float]:
    """Return the slopes of the bearing and what it is beyond the fix's own. [rad]"""
    squared = _squared_range(fix)
    error = wrap_angle(bearing - math.atan2(fix.y, fix.x))
    return (-fix.y / squared, fix.x / squared, 0.0, 0.0, 0.0), error


def _linearize_strength(fix: LampFix, strength: float) -> tuple[Row, float]:
    """Return the slopes of the strength's logarithm and what it is beyond the fix's own."""
    squared = _squared_range(fix)
    error = math.log(strength) - (fix.brightness - math.log(squared))
    return (-2.0 * fix.x / squared, -2.0 * fix.y / squared, 0.0, 0.0, 1.0), error


def _kalman_update(fix: LampFix, slopes: Row, error: float, noise: float) -> LampFix:
    """Return a fix after one measured number."""
    r = fix.rows
    g = _multiply_rows(r, slopes)
    spread = _dot_product(slopes, g) + noise
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
    """Return a row of the covariance with its columns moved on."""
    return row[0] - dt * row[2], row[1] - dt * row[3], row[2], row[3], row[4]


def _subtract_scaled(row: Row, share: float, other: Row) -> Row:
    """Return a row less a share of another."""
    return (
        row[0] - share * other[0],
        row[1] - share * other[1],
        row[2] - share * other[2],
        row[3] - share * other[3],
        row[4] - share * other[4],
    )


def _dot_product(a: Row, b: Row) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4]


def _multiply_rows(rows: tuple[Row, Row, Row, Row, Row], column: Row) -> Row:
    return (
        _dot_product(rows[0], column),
        _dot_product(rows[1], column),
        _dot_product(rows[2], column),
        _dot_product(rows[3], column),
        _dot_product(rows[4], column),
    )
