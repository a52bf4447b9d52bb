"""
A flight about a set of parameters: what is left over, and how it answers to everything.

Columns are the states at the beginning of each piece, knots of a latent force and moment, the
pressure of each piece, and every knob. Per piece only the products of the whitened columns with
each other are kept, so that all that follows is algebra on small matrices.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_analysis.discovery.knobs import Knob
from lta_analysis.discovery.linear import AXES, hats, KNOTS, Linear, Point, RANDOM, SENSORS
from lta_analysis.discovery.measured import CHANNELS, PERIOD
from lta_analysis.discovery.nominal import Rows
from lta_analysis.discovery.replay import Ready, Replay, STEPS
from lta_analysis.discovery.sensing import Places, readings, Told, told
from lta_analysis.discovery.tangent import (
    carried,
    middles,
    moved,
    NUDGE,
    nudged,
    spread_rates,
    transitions,
    turning_rows,
    WIDTH,
)
from lta_analysis.discovery.turning import logarithm, product, reverse
from lta_sim.measurement import read
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CHUNK: Final = 16  # pieces at a time, which bounds the memory


class Turn(NamedTuple):
    """The rows before and after a knob's step, and the step."""

    before: Rows
    after: Rows
    step: float


class Met(NamedTuple):
    """What flying about a point takes: itself, and before and after each knob's step."""

    rows: Rows
    ready: Ready
    turned: list[Turn]
    thrown: list[tuple[Ready, Ready]]


@final
class Linearised:
    """
    Makes the columns of one flight.

    Parameters
    ----------
    replay : Replay
        The flight.
    knobs : sequence of Knob
        What can be turned.
    places : Places
        Of the sensors.

    Attributes
    ----------
    index, time : ndarray, shape (S, n)
        Of each piece, the points of the grid and their times. [s]

    """

    def __init__(self, replay: Replay, knobs: Sequence[Knob], places: Places) -> None:
        self.replay, self.knobs, self.places = replay, list(knobs), places
        flight, cut = replay.flight, replay.cut
        steps = cut.first[:, None] + np.arange(cut.length)
        self.index = np.minimum(steps, len(flight.time) - 1)
        self.time = flight.time[0] + PERIOD * steps
        self._hats = hats(replay.span)

    def _turned(self, point: Point, base: Rows) -> list[Turn]:
        """Return for each knob the rows before and after its step."""
        out = []
        for knob, value in zip(self.knobs, point.values, strict=False):
            ready, step = knob.ready(point.nominal), knob.step_at(value)
            before = base if ready is point.nominal else self.replay.rows(ready)
            after = self.replay.rows(knob.turned(point.nominal, step))
            out.append(Turn(before, after, step))
        return out

    def trajectory(self, point: Point, which: slice = slice(None)) -> Array:
        """Return the states at each step, shape (S, span + 1, 13)."""
        rows = self.replay.rows(point.nominal)
        return self._fly(rows, self.replay.ready(rows), point, which)

    def _fly(self, rows: Rows, ready: Ready, point: Point, which: slice) -> Array:
        """Return the states at each step of some pieces."""
        start = moved(self.replay.cut.start[which], point.random[which, :WIDTH])
        return self.replay.fly(rows, ready, start, self._latent(point, which), which)

    def _latent(self, point: Point, which: slice) -> Array:
        """Return the latent force and moment in each step."""
        knots = point.random[which, WIDTH : WIDTH + AXES * KNOTS].reshape(-1, AXES, KNOTS)
        return np.ascontiguousarray(np.einsum('saj,kj->ska', knots, self._hats))

    def _met(self, point: Point) -> Met:
        """Return what flying about a point takes, before and after each knob's step."""
        rows = self.replay.rows(point.nominal)
        ready, turned = self.replay.ready(rows), self._turned(point, rows)
        thrown = [
            self._ready(knob, turn, rows, ready)
            for knob, turn in zip(self.knobs, turned, strict=True)
        ]
        return Met(rows, ready, turned, thrown)

    def columns(self, point: Point, which: slice = slice(None)) -> tuple[Array, Array]:
        """
        Return the columns about a point, and what is left over, by the noise.

        Parameters
        ----------
        point : Point
            The parameters.
        which : slice
            Of the pieces.

        Returns
        -------
        ndarray, shape (S, n, 14, N), and ndarray, shape (S, n, 14)
            RANDOM columns, then the knobs, then SENSORS; measured less predicted.

        """
        return self._columns(point, self._met(point), which)

    def at(self, point: Point) -> Linear:
        """Return the flight about a point; `BadInput` if no such vehicle can be."""
        met, pieces = self._met(point), len(self.replay.first)
        size = RANDOM + len(self.knobs) + len(SENSORS) + 1
        grams = np.empty((pieces, size, size))
        counts = np.empty(pieces, dtype=np.int64)
        residual = np.empty((pieces, self.replay.cut.length, len(CHANNELS)))
        for begin in range(0, pieces, CHUNK):
            which = slice(begin, begin + CHUNK)
            columns, left = self._columns(point, met, which)
            table = np.concatenate([columns, left[..., None]], axis=-1)
            known = np.isfinite(left)
            table[~known] = 0.0
            flat = table.reshape(len(table), -1, size)
            grams[which] = np.swapaxes(flat, 1, 2) @ flat
            counts[which] = known.sum(axis=(1, 2))
            residual[which] = left
        names = (*(knob.name for knob in self.knobs), *SENSORS)
        return Linear(names, grams, counts, point, residual)

    def _ready(self, knob: Knob, turn: Turn, rows: Rows, ready: Ready) -> tuple[Ready, Ready]:
        """Return what the body meets before and after a knob's step."""
        before, after, _ = turn
        same = before is rows
        reach = knob.reaches
        first = ready if same else self.replay.ready(before)
        if reach in ('chain', 'delay'):
            return first, self.replay.ready(after)
        if reach == 'memory':
            return first, self.replay.ready(after, ready)
        if reach == 'wrench':
            return first, self.replay.gained(after, first)
        return first, ready

    def _columns(self, point: Point, met: Met, which: slice) -> tuple[Array, Array]:
        """Return whitened columns and what is left over, as `columns`."""
        rows, ready, turned, _ = met
        states = self._fly(rows, ready, point, which)
        grid = states[:, ::STEPS]
        time = self.time[which]
        base = told(grid, time, rows.acting, self.places)
        left = self._left(base, point, which)
        change = self._changes(point, met, states, which)
        columns = self._sensed(change, grid, time, rows, base)
        for k, (before, after, step) in enumerate(turned):
            if self.knobs[k].reaches == 'reading':
                columns[..., RANDOM + k] += self._read(grid, time, before, after) / step
        own = RANDOM + len(self.knobs)
        columns[..., 13, [RANDOM - 1, own]] = 1.0
        for axis in range(3):
            columns[..., 9 + axis, own + 1 + axis] = base.readings[..., 3 + axis]
        columns /= self.replay.flight.noise[:, None]
        return columns, left / self.replay.flight.noise

    def left(self, grid: Array, point: Point, rows: Rows) -> Array:
        """
        Return measured less predicted, NaN where nothing was measured.

        Parameters
        ----------
        grid : ndarray, shape (S, n + 1, 13)
            Predicted states of all pieces.
        point, rows : Point, Rows
            The parameters.

        Returns
        -------
        ndarray, shape (S, n, 14)
            By CHANNELS, in SI.

        """
        base = told(grid, self.time, rows.acting, self.places)
        return self._left(base, point, slice(None))

    def _left(self, base: Told, point: Point, which: slice) -> Array:
        """Return measured less predicted."""
        flight, index = self.replay.flight, self.index[which]
        turn = logarithm(product(reverse(base.quaternion), flight.quaternion[index]))
        readings_left = flight.readings[index] - base.readings
        offset, *scales = point.values[-len(SENSORS) :]
        readings_left[..., 7] -= offset + point.random[which, -1:]
        readings_left[..., 3:6] -= np.array(scales) * base.readings[..., 3:6]
        left = np.concatenate(
            [flight.position[index] - base.position, turn, readings_left], axis=-1
        )
        left[~self.replay.cut.inside[which]] = np.nan
        left[..., ~np.isfinite(flight.noise)] = np.nan
        left[~np.isfinite(left)] = np.nan
        return left

    def _changes(self, point: Point, met: Met, states: Array, which: slice) -> Array:
        """Return how the states at the grid answer, shape (S, n + 1, 12, N)."""
        rows, ready, turned, thrown = met
        middle, latent = middles(states), self._latent(point, which)
        replay = self.replay

        def slopes(r: Rows, faced: Ready, at: Array, force: Array) -> Array:
            return replay.slopes(r, faced, at, force, which)

        base = slopes(rows, ready, middle, latent)
        jacobian = np.empty((*base.shape[:2], WIDTH, WIDTH))
        for k in range(WIDTH):
            there = slopes(rows, ready, nudged(middle, k), latent)
            jacobian[..., k] = spread_rates((there - base) / NUDGE[k])
        turning_rows(jacobian, middle[..., 10:13])
        inputs = np.zeros((*base.shape[:2], 6, RANDOM + len(self.knobs) + len(SENSORS)))
        for axis in range(AXES):
            push = latent.copy()
            push[..., axis] += 1.0
            answer = (slopes(rows, ready, middle, push) - base)[..., 3:]
            first = WIDTH + axis * KNOTS
            inputs[..., first : first + KNOTS] = answer[..., None] * self._hats[:, None, :]
        for k, knob in enumerate(self.knobs):
            if knob.reaches == 'reading':
                continue
            (before, after, step), (faced, faces) = turned[k], thrown[k]
            own = base if before is rows else slopes(before, faced, middle, latent)
            there = slopes(after, faces, middle, latent)
            inputs[..., RANDOM + k] = ((there - own) / step)[..., 3:]
        begin = np.zeros((WIDTH, inputs.shape[-1]))
        begin[:, :WIDTH] = np.eye(WIDTH)
        a, b = transitions(jacobian, replay.dt)
        return carried(a, b, begin, inputs, STEPS)

    def _sensed(self, change: Array, grid: Array, time: Array, rows: Rows, base: Told) -> Array:
        """Return how what is said answers, shape (S, n, 14, C)."""
        begin, end = grid[:, :-1], grid[:, 1:]
        first, last = (np.empty((*begin.shape[:2], 8, WIDTH)) for _ in range(2))
        for k in range(WIDTH):
            for out, pair in ((first, (nudged(begin, k), end)), (last, (begin, nudged(end, k)))):
                there = readings(*pair, time, rows.acting, self.places)
                out[..., k] = (there - base.readings) / NUDGE[k]
        position = change[:, :-1, :3]
        if rows.acting['pose']:
            position = _frame(rows) @ position
        rest = first @ change[:, :-1] + last @ change[:, 1:]
        return np.concatenate([position, change[:, :-1, 3:6], rest], axis=2)

    def _read(self, grid: Array, time: Array, before: Rows, after: Rows) -> Array:
        """Return the difference of what is said under other measurement effects."""
        a = told(grid, time, before.acting, self.places)
        b = told(grid, time, after.acting, self.places)
        turn = logarithm(product(reverse(a.quaternion), b.quaternion))
        return np.concatenate([b.position - a.position, turn, b.readings - a.readings], axis=-1)


def _frame(rows: Rows) -> Array:
    """Return the rotation into the tracker's frame."""
    axes = [read(rows.acting['pose'], (*axis, 0.0, 0.0, 0.0, 1.0), 0.0)[:3] for axis in np.eye(3)]
    return np.array(axes).T
