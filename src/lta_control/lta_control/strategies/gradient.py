r"""
DGA, dither-free gradient ascent: one diode, dead reckoning, and a plane through the light.

The drone reckons its place from the speed that it commands, as the paper does,

.. math::

    x_k = x_{k-1} + v_k (\cos\theta_{k-1}, \sin\theta_{k-1})\,\Delta t

keeps the newest pairs of place and light of its forward diode on a map of 2 cm cells, fits a plane
J = a x + b y by least squares, and turns to atan2(b, a). The paper's plane goes through the
origin, where J is not 0: its slope is then mostly the way from there to the mean of the places.
`centred` fits through the mean of the pairs instead, which is the same as a constant term.

Places along a straight line say nothing about the light beside it. A small `ridge` then gives the
least slope that fits, which lies along the line; and the first pairs are taken on an arc (`arc`).

What makes the paper's DGA late is modelled openly: a heading is used `computing` seconds after its
pairs were taken, and for a turn of more than `stop_beyond` the drone stops first and flies on when
it is within `go_within`.
"""

import math
from typing import NamedTuple, TYPE_CHECKING

from lta_config.settings import setting, Settings
from lta_control.cascade import wrap_angle
from lta_control.strategies.protocol import LightSight, NavigationStrategy, SteeringCommand

if TYPE_CHECKING:
    from lta_control.strategies.settings import StrategySettings

PAIRS = 40
NONE = (0.0, 0.0, 0.0)
EMPTY = (NONE,) * PAIRS
Pair = tuple[float, float, float]


class GradientSettings(Settings):
    """The map, the plane, and what takes time."""

    cell: float = setting(0.02, 'Side of a cell of the map.', unit='m', low=1e-3, high=10.0)
    least: float = setting(
        30.0, 'Pairs that the first plane needs.', unit='1', low=3.0, high=float(PAIRS)
    )
    arc: float = setting(
        0.5, 'Turn rate while the first pairs are taken.', unit='rad/s', low=-2.0, high=2.0
    )
    centred: bool = setting(True, 'Whether the plane goes through the mean of the pairs.')
    ridge: float = setting(
        1e-3, 'Mean square of places added to those there are.', unit='m2', low=1e-9, high=10.0
    )
    computing: float = setting(1.0, 'Time to compute a heading.', unit='s', low=0.0, high=60.0)
    stop_beyond: float = setting(
        1.2, 'Turn for which the drone stops.', unit='rad', low=0.0, high=3.2
    )
    go_within: float = setting(
        0.5, 'Heading error at which it flies on.', unit='rad', low=0.0, high=3.2
    )


class GradientMemory(NamedTuple):
    """What DGA remembers."""

    heading: float  # asked for last [rad]
    x: float  # reckoned [m, odom]
    y: float
    speed: float  # commanded last [m/s]
    target: float  # heading that has been computed [rad]
    next: float  # heading that is being computed [rad]
    computed: float  # time for which it has been [s]
    turning: bool
    filled: float  # pairs there are
    pairs: tuple[Pair, ...]  # place [m, odom] and light [counts], the newest last


def start(heading: float) -> GradientMemory:
    """Return the memory before the first light."""
    return GradientMemory(
        heading, 0.0, 0.0, 0.0, heading, heading, 0.0, False, 0.0, EMPTY
    )  # fmt: skip


def steer(
    settings: 'StrategySettings', memory: GradientMemory, sight: LightSight
) -> tuple[SteeringCommand, GradientMemory]:
    """Return the heading of the newest plane, at cruise speed or standing to turn."""
    own, m, dt = settings.dga, memory, sight.interval
    x = m.x + m.speed * math.cos(m.heading) * dt
    y = m.y + m.speed * math.sin(m.heading) * dt
    pairs, more = add_pair(m.pairs, m.filled, (x, y, sight.amplitudes[0]), own.cell)
    count = min(m.filled + more, float(PAIRS))
    target, coming, computed = m.target, m.next, m.computed + dt
    if count < own.least:
        target = coming = m.heading + own.arc * dt
        computed = own.computing
    elif computed >= own.computing:
        # A first heading is not waited for in flight along the arc: its time counts from here.
        target, coming, computed = coming, steepest_heading(own, pairs, count, m.heading), 0.0
    off = abs(wrap_angle(target - sight.heading))
    arcing = count < own.least
    turning = not arcing and off > (own.go_within if m.turning else own.stop_beyond)
    speed = 0.0 if turning else settings.speed
    after = GradientMemory(target, x, y, speed, target, coming, computed, turning, count, pairs)
    return SteeringCommand(target, speed, False), after


def add_pair(
    pairs: tuple[Pair, ...], count: float, new: Pair, cell: float
) -> tuple[tuple[Pair, ...], float]:
    """Return the pairs with a new one, and by how many they are more: a cell keeps its mean."""
    x, y, light = pairs[-1]
    same = math.floor(x / cell) == math.floor(new[0] / cell)
    if count > 0.0 and same and math.floor(y / cell) == math.floor(new[1] / cell):
        return pairs[:-1] + ((new[0], new[1], 0.5 * (light + new[2])),), 0.0  # noqa: RUF005 - numba
    return pairs[1:] + (new,), 1.0  # noqa: RUF005 - numba


def steepest_heading(
    own: GradientSettings, pairs: tuple[Pair, ...], count: float, heading: float
) -> float:
    """Return the heading up the plane through the newest pairs; the old one of a flat plane."""
    first = PAIRS - int(count)
    mean_x = mean_y = mean_j = 0.0
    if own.centred:
        for k in range(first, PAIRS):
            mean_x += pairs[k][0] / count
            mean_y += pairs[k][1] / count
            mean_j += pairs[k][2] / count
    xx = yy = own.ridge * count
    xy = xj = yj = 0.0
    for k in range(first, PAIRS):
        x, y, j = pairs[k][0] - mean_x, pairs[k][1] - mean_y, pairs[k][2] - mean_j
        xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
        xj, yj = xj + x * j, yj + y * j
    a, b = yy * xj - xy * yj, xx * yj - xy * xj  # times the determinant, which is positive
    return math.atan2(b, a) if math.hypot(a, b) > 0.0 else heading


STRATEGY = NavigationStrategy('dga', start, steer)
