# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
DGA, dither-free gradient ascent: one diode, dead reckoning, and a plane fitted to the light.

The drone dead-reckons its position from the speed that it commands and the heading that its IMU
measures, as in the paper (`commanded_heading`: from the heading that it commands),

.. math::

    x_k = x_{k-1} + v_k (\cos\theta_{k-1}, \sin\theta_{k-1})\,\Delta t

keeps the latest pairs of position and forward-diode light on a map of 2 cm cells, fits a plane J
= a x + b y by least squares, and turns to atan2(b, a). The paper's plane goes through the origin,
where J is not 0: its slope then points mostly from there to the mean position. `centred` fits
through the mean of the pairs instead, which equals a constant term.

Positions along a straight line do not determine the slope across it. A small `ridge` then selects
the smallest slope that fits, which lies along the line, and the first pairs are taken on an arc
(`arc`). The delays of the paper's DGA are explicit: a heading is used `computing` seconds after
its pairs were taken, and for a turn of more than `stop_beyond` the drone stops and resumes when
it is within `go_within`.
"""

import math
from typing import NamedTuple

from lta_control.motion import wrap_angle
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy, SteeringCommand
from lta_control.strategies.settings import GradientSettings, MAP_SAMPLES, StrategySettings

NO_SAMPLE = (0.0, 0.0, 0.0)
EMPTY_SAMPLES = (NO_SAMPLE,) * MAP_SAMPLES
Pair = tuple[float, float, float]


class GradientState(NamedTuple):
    """State of DGA."""

    heading: float  # last commanded [rad]
    x: float  # dead reckoned [m, odom]
    y: float
    speed: float  # commanded last [m/s]
    target: float  # heading that has been computed [rad]
    next: float  # heading that is being computed [rad]
    computed: float  # time for which it has been [s]
    turning: bool
    filled: float  # number of pairs so far
    pairs: tuple[Pair, ...]  # place [m, odom] and light [counts], the newest last


def start(heading: float) -> GradientState:
    """Return the memory before the first light."""
    return GradientState(heading, 0.0, 0.0, 0.0, heading, heading, 0.0, False, 0.0, EMPTY_SAMPLES)


def steer(
    settings: StrategySettings, memory: GradientState, sight: LightMeasurement
) -> tuple[SteeringCommand, GradientState]:
    """Return the heading of the latest plane, at cruise speed or stopped for a turn."""
    own, m, dt = settings.dga, memory, sight.interval
    # The speed is the commanded one, as in the paper
    course = m.heading if own.commanded_heading else sight.heading
    x = m.x + m.speed * math.cos(course) * dt
    y = m.y + m.speed * math.sin(course) * dt
    pairs, more = add_pair(m.pairs, m.filled, (x, y, sight.amplitudes[0]), own.cell)
    count = min(m.filled + more, float(MAP_SAMPLES))
    target, coming, computed = m.target, m.next, m.computed + dt
    if count < own.least:
        target = coming = m.heading + own.arc * dt
        computed = own.computing
    elif computed >= own.computing:
        # The computing time of the first heading starts after the arc is complete.
        target, coming, computed = coming, steepest_heading(own, pairs, count, m.heading), 0.0
    off = abs(wrap_angle(target - sight.heading))
    arcing = count < own.least
    turning = not arcing and off > (own.go_within if m.turning else own.stop_beyond)
    speed = 0.0 if turning else settings.speed
    after = GradientState(target, x, y, speed, target, coming, computed, turning, count, pairs)
    return SteeringCommand(target, speed, False), after


def add_pair(
    pairs: tuple[Pair, ...], count: float, new: Pair, cell: float
) -> tuple[tuple[Pair, ...], float]:
    """Return the pairs with a new one, and the change in number; a cell keeps its mean."""
    x, y, light = pairs[-1]
    same = math.floor(x / cell) == math.floor(new[0] / cell)
    if count > 0.0 and same and math.floor(y / cell) == math.floor(new[1] / cell):
        mean = 0.5 * (light + new[2])
        return pairs[:-1] + ((new[0], new[1], mean),), 0.0  # noqa: RUF005 - numba
    return pairs[1:] + (new,), 1.0  # noqa: RUF005 - numba


def steepest_heading(
    own: GradientSettings, pairs: tuple[Pair, ...], count: float, heading: float
) -> float:
    """Return the heading up the plane through the latest pairs; the old one for a flat plane."""
    # The newest pairs are last; earlier entries are still empty
    first = MAP_SAMPLES - int(count)
    mean_x = mean_y = mean_j = 0.0
    if own.centred:
        for k in range(first, MAP_SAMPLES):
            mean_x += pairs[k][0] / count
            mean_y += pairs[k][1] / count
            mean_j += pairs[k][2] / count
    # Normal equations of the plane, with the ridge on the diagonal
    xx = yy = own.ridge * count
    xy = xj = yj = 0.0
    for k in range(first, MAP_SAMPLES):
        x, y, j = pairs[k][0] - mean_x, pairs[k][1] - mean_y, pairs[k][2] - mean_j
        xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
        xj, yj = xj + x * j, yj + y * j
    a, b = yy * xj - xy * yj, xx * yj - xy * xj  # times the determinant, which is positive
    return math.atan2(b, a) if math.hypot(a, b) > 0.0 else heading


GRADIENT_STRATEGY = NavigationStrategy('dga', start, steer)
