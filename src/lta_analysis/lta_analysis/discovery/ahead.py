"""
How far ahead a model sees, and how that answers to its knobs: errors at a few horizons.

Each piece begins where the poses around its beginning say, and nothing helps the model on its way:
no latent force, no freed state. That is what a forecast is worth, and what a few knobs can be
fitted to where the model's own error, not the tracker's noise, is what counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_analysis.discovery.linear import Point
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.measured import PERIOD
from lta_analysis.discovery.nominal import Rows
from lta_analysis.discovery.replay import Ready, STEPS
from lta_analysis.discovery.sensing import in_map, told, tracker_frame
from lta_analysis.discovery.tangent import (
    carried,
    middles,
    NUDGE,
    nudged,
    spread_rates,
    transitions,
    turning_rows,
    WIDTH,
)
from lta_analysis.discovery.turning import logarithm, product, reverse
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HORIZONS: Final = (1.0, 2.0, 3.0, 4.0, 5.0)  # s
CHUNK: Final = 32  # pieces at a time, which bounds the memory


@final
@dataclass(frozen=True, slots=True)
class Ahead:
    """
    Errors of one flight about one set of parameters.

    Attributes
    ----------
    left : ndarray, shape (S, H, 6)
        Measured less predicted at each horizon: place, then rotation vector. NaN where the
        flight does not say. [m, rad]
    columns : ndarray, shape (S, H, 6, K)
        How the prediction answers to each knob asked for; K is 0 where none was.

    """

    left: Array
    columns: Array


def ahead(
    flight: Linearised,
    point: Point,
    which: Sequence[int] = (),
    horizons: Sequence[float] = HORIZONS,
) -> Ahead:
    """
    Return how far a model is off ahead of each piece's beginning, and how it answers.

    Parameters
    ----------
    flight : Linearised
        The flight, in pieces longer than the last horizon.
    point : Point
        The parameters; its states and latent forces of the pieces are not used.
    which : sequence of int
        Of the flight's knobs.
    horizons : sequence of float
        [s]

    """
    rows = flight.replay.rows(point.nominal)
    ready = flight.replay.ready(rows)
    index = np.rint(np.asarray(horizons) / PERIOD).astype(np.int64)
    stepped = _stepped(flight, point, rows, ready, which)
    parts = []
    for begin in range(0, len(flight.replay.first), CHUNK):
        some = slice(begin, begin + CHUNK)
        parts.append(_of_some(flight, rows, ready, stepped, index, some))
    left, columns = (np.concatenate(each) for each in zip(*parts, strict=True))
    return Ahead(left, columns)


Stepped = list[tuple[bool, Rows, Rows, float, Ready, Ready]]


def _stepped(
    flight: Linearised, point: Point, rows: Rows, ready: Ready, which: Sequence[int]
) -> Stepped:
    """Return for each knob the model before and after its step."""
    out: Stepped = []
    for k in which:
        knob = flight.knobs[k]
        begun, step = knob.ready(point.nominal), knob.step_at(float(point.values[k]))
        same = begun is point.nominal
        before = rows if same else flight.replay.rows(begun)
        after = flight.replay.rows(knob.turned(point.nominal, step))
        reach = knob.reaches
        first = ready if same else flight.replay.ready(before)
        if reach in ('chain', 'delay'):
            last = flight.replay.ready(after)
        elif reach == 'memory':
            last = flight.replay.ready(after, ready)
        elif reach == 'wrench':
            last = flight.replay.gained(after, first)
        else:
            last = first
        out.append((reach == 'reading', before, after, step, first, last))
    return out


def _of_some(
    flight: Linearised,
    rows: Rows,
    ready: Ready,
    stepped: Stepped,
    index: NDArray[np.int64],
    some: slice,
) -> tuple[Array, Array]:
    """Return errors and columns of some pieces."""
    replay, time = flight.replay, flight.time[some]
    latent = np.zeros((len(time), replay.span, 6))
    seen = replay.cut.start[some]
    start = in_map(seen, rows.acting)
    states = replay.fly(rows, ready, start, latent, some)
    grid = states[:, ::STEPS]
    base = told(grid, time, rows.acting, flight.places)
    at = flight.index[some][:, index]
    turn = logarithm(product(reverse(base.quaternion[:, index]), replay.flight.quaternion[at]))
    left = np.concatenate([replay.flight.position[at] - base.position[:, index], turn], axis=-1)
    left[~replay.cut.inside[some][:, index]] = np.nan
    if not stepped:
        return left, np.zeros((*left.shape, 0))
    change = _changes(flight, rows, ready, stepped, states, some)
    columns = np.ascontiguousarray(change[:, index, :6])
    columns[..., :3, :] = tracker_frame(rows.acting)[0] @ columns[..., :3, :]
    for k, (reading, before, after, step, _, _) in enumerate(stepped):
        if reading:
            a = told(grid, time, before.acting, flight.places)
            b = told(grid, time, after.acting, flight.places)
            columns[..., :3, k] += (b.position - a.position)[:, index] / step
            turned = logarithm(product(reverse(a.quaternion), b.quaternion))
            columns[..., 3:, k] += turned[:, index] / step
    return left, columns


def _changes(
    flight: Linearised, rows: Rows, ready: Ready, stepped: Stepped, states: Array, some: slice
) -> Array:
    """Return how the states at the grid answer, shape (S, n + 1, 12, K)."""
    replay, middle = flight.replay, middles(states)
    latent = np.zeros((*middle.shape[:2], 6))
    base = replay.slopes(rows, ready, middle, latent, some)
    jacobian = np.empty((*base.shape[:2], WIDTH, WIDTH))
    for k in range(WIDTH):
        there = replay.slopes(rows, ready, nudged(middle, k), latent, some)
        jacobian[..., k] = spread_rates((there - base) / NUDGE[k])
    turning_rows(jacobian, middle[..., 10:13])
    inputs = np.zeros((*base.shape[:2], 6, len(stepped)))
    begin = np.zeros((len(states), WIDTH, len(stepped)))
    seen = replay.cut.start[some]
    for k, (reading, before, after, step, first, last) in enumerate(stepped):
        if reading:
            a, b = in_map(seen, before.acting), in_map(seen, after.acting)
            begin[:, :3, k] = (b[:, :3] - a[:, :3]) / step
            begin[:, 3:6, k] = logarithm(product(reverse(a[:, 3:7]), b[:, 3:7])) / step
            continue
        own = base if before is rows else replay.slopes(before, first, middle, latent, some)
        there = replay.slopes(after, last, middle, latent, some)
        inputs[..., k] = ((there - own) / step)[..., 3:]
    a, b = transitions(jacobian, replay.dt)
    return carried(a, b, begin, inputs, STEPS)
