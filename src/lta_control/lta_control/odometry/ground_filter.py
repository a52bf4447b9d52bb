# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
Filter the motion over ground: velocity and position, with a covariance that accounts for wind.

No sensor on board measures a steady wind. What is known of the motion over ground is that the
drone begins at rest, that drag then carries it along with the air, and that a lamp stands still.
A Kalman filter combines them. Its nine states, in the odom frame, are

- the position p;
- the drift d: the velocity over ground, less the airspeed u of the drag model
  (`lta_control.motion_filters`), which begins at rest as the drone does;
- the wind w, a random walk from a prior of zero mean (`GroundSettings.wind`);
- the lamp: bearing :math:`\varphi` and logarithm of the distance :math:`\rho` from the drone, and
  brightness c. Log-polar coordinates keep the filter consistent while the distance is hardly
  known (Aidala and Hammel, Utilization of modified polar coordinates for bearings-only tracking,
  IEEE Trans. Autom. Control 28, 1983).

.. math::

    p' = u + d, \quad d' = k (w - d), \quad \ln S = c - 2 \rho

with k the slope of the drag over the mass: at rest d = 0, and after some seconds of flight
d = w. S is the strength of the lamp's light. Bearings determine the velocity across the line of
sight relative to the distance, strengths that along it. The distance itself follows from the
motion in the first seconds, when the drift is still small. Without a lamp in view, the
covariance grows to that of the prior.

On the ground, or held by hand, an unknown contact may hold the drone against the wind. The process
noise of the drift is larger there, so that a drone that does not move tells little of the wind.
While it stands still there, its velocity over ground is zero, whatever the wind.

The wind is expected to change little. Innovations of bearings that stay on one side show gusts,
and the process noise then grows with them (covariance matching: Mehra, Approaches to adaptive
filtering, IEEE Trans. Autom. Control 17, 1972).
"""

import math
from typing import NamedTuple

from lta_control.motion import wrap_angle
from lta_control.motion_filters import HullDragModel
from lta_control.odometry.ground_state import (
    BEARING,
    BRIGHTNESS,
    Covariance,
    DRIFT_X,
    DRIFT_Y,
    GroundMotion,
    GroundSettings,
    LOG_DISTANCE,
    Matrix,
    Row,
    slip_variance,
    WIND_X,
    WIND_Y,
    X,
    Y,
)
from lta_control.sighting import LampSighting, NEAREST_SIGHTING
import numpy as np

POSITION_WALK = 0.03  # m in one second: error of the position beyond that of the velocity
DRAG_ERROR = 0.2  # relative error of the drag's slope
STANDS = 0.01  # m/s of a drone that stands still, and m in one second
CONTACT = 0.04  # m/s in one second: floor or hand against the wind
SOURCE_EXTENT = 0.1  # m: lamp and diode ring have an extent, which displaces a near lamp
# m: largest difference of height, which adds to the distance of a near lamp
LAMP_HEIGHT_LIMIT = 1.2
BRIGHTNESS_WALK = 0.02  # of the logarithm of the brightness in one second
ASPECT = 1.0  # of ln(brightness) per radian of bearing: the lamp is seen from another side ...
ASPECT_TIME = 5.0  # ... as long as the bearing changes in one direction [s]
GATE = 4.0  # standard deviations beyond which a sighting is an outlier
DOUBT = 1.5  # s of outliers only, after which the lamp is another one
SEPARATION = 5.0  # Hz: half a bin of the spectrum; lamps differ by more
# Successive innovations of bearings that point to the same side show a gust. Noise averages out.
SIGHTING_PERIOD = 0.1  # s between two sightings
SURPRISE_TIME = 1.5  # s over which innovations are averaged
EXPECTED = 0.07  # square of their normalised mean without gusts
UNSURPRISING_OFFSET = 0.4  # m of displacement of a near lamp that is no surprise
MOST_EXCESS = 1.0  # so that bearings worse than expected do not end all knowledge of the wind
GUST_DRIFT = 0.4  # m/s in one second, of the drift, at an excess of 1
GUST_WIND = 1.0  # m/s in one second, of the wind


def predict_motion(
    settings: GroundSettings,
    hull: HullDragModel,
    state: GroundMotion,
    nose: tuple[float, float],
) -> GroundMotion:
    """Return the state after the way since the last prediction; `nose` is a unit vector."""
    mean, rows, dt = state.mean, state.rows, state.elapsed
    slip = mean[DRIFT_X] - mean[WIND_X], mean[DRIFT_Y] - mean[WIND_Y]
    # Variance of the slip of the true airspeed against the modelled one, over both axes
    spread = slip_variance(rows, DRIFT_X, WIND_X) + slip_variance(rows, DRIFT_Y, WIND_Y)
    error = slip[0] * slip[0] + slip[1] * slip[1] + spread
    # Quadratic drag D: D(u + e) - D(u) is about q (|u| + |u + e|) e
    fast = math.hypot(*state.air) + math.sqrt(
        (state.air[0] + slip[0]) ** 2 + (state.air[1] + slip[1]) ** 2 + spread
    )
    ahead = (hull.linear[0] + hull.quadratic[0] * fast) / hull.mass[0]
    aside = (hull.linear[1] + hull.quadratic[1] * fast) / hull.mass[1]
    cos, sin = nose
    kxx, kxy = cos * cos * ahead + sin * sin * aside, cos * sin * (ahead - aside)
    kyy = sin * sin * ahead + cos * cos * aside
    seen = state.frequency > 0.0
    range_rate = turn_rate = to_x = to_y = 0.0
    if seen:
        away = math.exp(mean[LOG_DISTANCE])
        to_x, to_y = math.cos(mean[BEARING]) / away, math.sin(mean[BEARING]) / away
        range_rate = (state.moved[0] * to_x + state.moved[1] * to_y) / dt
        turn_rate = (state.moved[1] * to_x - state.moved[0] * to_y) / dt

    transition = _Transition(
        dt,
        (dt * kxx, dt * kxy, dt * kyy),
        (1.0 + dt * range_rate, dt * turn_rate),
        (dt * to_x, dt * to_y),
    )
    # F P F^T, by rows and then by columns
    after = _transform_rows(transition, _transform_rows(transition, rows).T)
    excess = min(max(state.innovation**2 - EXPECTED, 0.0), MOST_EXCESS)
    model = settings.thrust_noise**2 + 2.0 * (DRAG_ERROR * 0.5 * (ahead + aside)) ** 2 * error
    if state.on_ground:
        model += CONTACT * CONTACT
    model += GUST_DRIFT * GUST_DRIFT * excess
    gusts = settings.gusts * settings.gusts + GUST_WIND * GUST_WIND * excess
    walk = POSITION_WALK * POSITION_WALK
    noise = np.array((walk, walk, model, model, gusts, gusts, 0.0, 0.0, 0.0))
    after += np.diag(dt * noise)
    if seen:
        after[BRIGHTNESS, BRIGHTNESS] += dt * (
            BRIGHTNESS_WALK * BRIGHTNESS_WALK + 2.0 * ASPECT_TIME * (ASPECT * turn_rate) ** 2
        )
    lamp = mean[BEARING], mean[LOG_DISTANCE]
    if seen:
        away = math.exp(mean[LOG_DISTANCE])
        x = away * math.cos(mean[BEARING]) - state.moved[0]
        y = away * math.sin(mean[BEARING]) - state.moved[1]
        lamp = math.atan2(y, x), math.log(max(math.hypot(x, y), NEAREST_SIGHTING))
    return state._replace(
        mean=(
            mean[X],
            mean[Y],
            mean[DRIFT_X] - dt * (kxx * slip[0] + kxy * slip[1]),
            mean[DRIFT_Y] - dt * (kxy * slip[0] + kyy * slip[1]),
            mean[WIND_X],
            mean[WIND_Y],
            *lamp,
            mean[BRIGHTNESS],
        ),
        rows=after,
        moved=(0.0, 0.0),
        elapsed=0.0,
    )


def hold_still(before: GroundMotion, after: GroundMotion) -> GroundMotion:
    """
    Return the prediction `after` for a drone that stood still since `before`.

    Its velocity over ground is zero within `STANDS`, and independent of all else, such as of a
    wind against which the floor holds it. So its position has the covariance that it had.
    """
    rows = after.rows.copy()
    for i in (X, Y, DRIFT_X, DRIFT_Y):
        is_place = i in (X, Y)
        rows[i] = rows[:, i] = before.rows[i] if is_place else 0.0
        rows[i, i] += STANDS * STANDS * (before.elapsed if is_place else 1.0)
    drift = -after.air[0], -after.air[1]
    return after._replace(mean=(*after.mean[:DRIFT_X], *drift, *after.mean[WIND_X:]), rows=rows)


class _Transition(NamedTuple):
    """What makes up the derivative of the states after a time by those before."""

    dt: float
    pull: Covariance  # of the drag, kxx, kxy and kyy
    lamp: tuple[float, float]  # of bearing and log-distance: by themselves, and by each other
    toward: tuple[float, float]  # unit vector to the lamp over the distance; zero without one


def _transform_rows(f: _Transition, rows: Matrix) -> Matrix:
    """Return F times a matrix."""
    dt, (kxx, kxy, kyy), (same, turn), (x, y) = f
    a, b = rows[DRIFT_X], rows[DRIFT_Y]
    p, q = rows[BEARING], rows[LOG_DISTANCE]
    slip_x, slip_y = a - rows[WIND_X], b - rows[WIND_Y]
    after = rows.copy()
    after[X] += dt * a
    after[Y] += dt * b
    after[DRIFT_X] = a - kxx * slip_x - kxy * slip_y
    after[DRIFT_Y] = b - kxy * slip_x - kyy * slip_y
    after[BEARING] = same * p + turn * q + y * a - x * b
    after[LOG_DISTANCE] = same * q - turn * p - x * a - y * b
    return after


def correct_motion(
    settings: GroundSettings,
    state: GroundMotion,
    sighting: LampSighting,
    bearing: float,
    doubted: float,
) -> GroundMotion:
    """Return the state after a sighting with a bearing in the odom frame [rad]."""
    same = abs(sighting.frequency - state.frequency) < SEPARATION
    if not same:
        return _restart_lamp(settings, state, sighting, bearing)
    mean, rows = state.mean, state.rows
    square = math.exp(2.0 * mean[LOG_DISTANCE])
    bearing_noise = (
        sighting.deviation**2 + settings.bearing_noise**2 + SOURCE_EXTENT * SOURCE_EXTENT / square
    )
    strength_noise = (
        settings.strength_noise**2 + (LAMP_HEIGHT_LIMIT * LAMP_HEIGHT_LIMIT / square) ** 2
    )
    turn = wrap_angle(bearing - mean[BEARING])
    gap = math.log(sighting.strength) - _expect_log_strength(mean)
    turn_size = rows[BEARING, BEARING] + bearing_noise
    gap_size = _measure_strength(rows)[1] + strength_noise
    if turn * turn > GATE * GATE * turn_size or gap * gap > GATE * GATE * gap_size:
        if doubted > DOUBT:
            return _restart_lamp(settings, state, sighting, bearing)
        return state._replace(doubted=doubted)
    usual = turn_size + UNSURPRISING_OFFSET * UNSURPRISING_OFFSET / square
    surprise = turn / math.sqrt(usual) - state.innovation
    innovation = state.innovation + SIGHTING_PERIOD / SURPRISE_TIME * surprise
    # The measured state is the bearing itself, so P H^T is its row
    mean, rows = _update(mean, rows, rows[BEARING], turn / turn_size, turn_size)
    gains, size = _measure_strength(rows)
    gap = math.log(sighting.strength) - _expect_log_strength(mean)
    size += strength_noise
    mean, rows = _update(mean, rows, gains, gap / size, size)
    return state._replace(mean=mean, rows=rows, doubted=0.0, innovation=innovation)


def correct_place(
    state: GroundMotion, place: tuple[float, float], deviation: float
) -> GroundMotion:
    """Return the state after a position that a tracker has measured [m, odom]."""
    mean, rows = state.mean, state.rows
    for axis, value in zip((X, Y), place, strict=True):
        size = rows[axis, axis] + deviation * deviation
        mean, rows = _update(mean, rows, rows[axis], (value - mean[axis]) / size, size)
    return state._replace(mean=mean, rows=rows)


def _expect_log_strength(mean: Row) -> float:
    return mean[BRIGHTNESS] - 2.0 * mean[LOG_DISTANCE]


def _measure_strength(rows: Matrix) -> tuple[Matrix, float]:
    """Return P H^T of the logarithm of the strength, and its variance without noise."""
    gains = rows[BRIGHTNESS] - 2.0 * rows[LOG_DISTANCE]
    return gains, gains[BRIGHTNESS] - 2.0 * gains[LOG_DISTANCE]


def _update(
    mean: Row, rows: Matrix, gains: Matrix, step: float, size: float
) -> tuple[Row, Matrix]:
    """Return mean and covariance after a measurement; `step` is the innovation over its `size`."""
    return tuple((mean + step * gains).tolist()), rows - np.outer(gains, gains / size)


def _restart_lamp(
    settings: GroundSettings, state: GroundMotion, sighting: LampSighting, bearing: float
) -> GroundMotion:
    """Return the state with a lamp of which nothing but this sighting is known."""
    distance = math.log(sighting.distance)
    lamp = bearing, distance, math.log(sighting.strength) + 2.0 * distance
    variance = sighting.spread * sighting.spread
    turn = sighting.deviation**2 + settings.bearing_noise**2
    rows = np.zeros_like(state.rows)
    rows[:BEARING, :BEARING] = state.rows[:BEARING, :BEARING]
    # A brighter lamp is farther away
    noise = settings.strength_noise**2
    rows[BEARING, BEARING], rows[LOG_DISTANCE, LOG_DISTANCE] = turn, variance
    rows[LOG_DISTANCE, BRIGHTNESS] = rows[BRIGHTNESS, LOG_DISTANCE] = 2.0 * variance
    rows[BRIGHTNESS, BRIGHTNESS] = 4.0 * variance + noise
    return state._replace(
        mean=(*state.mean[:BEARING], *lamp),
        rows=rows,
        frequency=sighting.frequency,
        doubted=0.0,
    )
