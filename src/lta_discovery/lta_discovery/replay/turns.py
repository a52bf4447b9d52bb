"""What turning each knob by its step makes of a vehicle, and of what its body meets."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_discovery.model.knob_sets import Turns
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal, Rows
from lta_discovery.replay.linear import Point
from lta_discovery.replay.replay import Ready, Replay
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class Turn(NamedTuple):
    """A knob of the sensors: the rows before and after its step, and the step."""

    before: Rows
    after: Rows
    step: float


@final
class Met(NamedTuple):
    """
    What flying about a point takes.

    Attributes
    ----------
    rows, ready : Rows, Ready
        Of the point itself.
    moving, reading : tuple of int
        The knobs that change the motion, and those that change what is said of it.
    turns : Turns
        Of the former.
    turned : tuple of Turn
        Of the latter.

    """

    rows: Rows
    ready: Ready
    moving: tuple[int, ...]
    reading: tuple[int, ...]
    turns: Turns
    turned: tuple[Turn, ...]


@final
class _Sets:
    """Sets of parameters and what they meet; the first is the point itself."""

    def __init__(self, replay: Replay, nominal: Nominal) -> None:
        self._replay, self._nominal = replay, nominal
        self.rows = [replay.rows(nominal)]
        self.ready = [replay.ready(self.rows[0])]
        self.faced = [0]

    def pair(self, knob: Knob, value: float) -> tuple[int, int, float]:
        """Add what a knob's step goes between; return both places and the step."""
        present, step = knob.ready(self._nominal), knob.step_at(value)
        before = 0 if present is self._nominal else self._add(knob, present)
        return before, self._add(knob, knob.turned(self._nominal, step)), step

    def _add(self, knob: Knob, nominal: Nominal) -> int:
        """Add the set of a vehicle with a knob turned."""
        rows = self._replay.rows_beside(nominal, self._nominal, self.rows[0])
        self.faced.append(self._meets(knob, rows))
        self.rows.append(rows)
        return len(self.rows) - 1

    def _meets(self, knob: Knob, rows: Rows) -> int:
        """Return which of `ready` a set meets; what the knob does not reach is not run again."""
        if knob.reaches == 'body':
            return 0
        if knob.reaches == 'wrench':
            self.ready.append(self._replay.gained(rows, self.ready[0]))
        else:
            before = self.ready[0] if knob.reaches == 'memory' else None
            self.ready.append(self._replay.ready(rows, before))
        return len(self.ready) - 1

    def turns(self, pairs: Sequence[tuple[int, int, float]]) -> Turns:
        """Return all of it as arrays."""
        before, after, steps = zip(*pairs, strict=True) if pairs else ((), (), ())
        met_by = [ready.by_period() for ready in self.ready]
        return Turns(
            np.array([rows.body for rows in self.rows]),
            np.array([rows.body_on for rows in self.rows]),
            np.array(self.faced, dtype=np.int64),
            np.array([means[0] for means in met_by]),
            np.array([means[1] for means in met_by]),
            np.array([means[2] for means in met_by]),
            np.array(before, dtype=np.int64),
            np.array(after, dtype=np.int64),
            np.array(steps, dtype=np.float64),
        )


def met(
    replay: Replay, knobs: Sequence[Knob], point: Point, wanted: NDArray[np.bool_] | None = None
) -> Met:
    """
    Return what flying about a point takes.

    Parameters
    ----------
    replay : Replay
        The flight.
    knobs : sequence of Knob
        What can be turned.
    point : Point
        The parameters.
    wanted : ndarray of bool, shape (G,), optional
        Which knobs to turn; all if not given.

    Raises
    ------
    BadInput
        If no such vehicle can be.

    """
    sets, pairs, turned = _Sets(replay, point.nominal), [], []
    moving, reading = [], []
    base = sets.rows[0]
    for k, knob in enumerate(knobs):
        if wanted is not None and not wanted[k]:
            continue
        value = float(point.values[k])
        if knob.reaches != 'reading' or replay.delays_commands(knob):
            moving.append(k)
            pairs.append(sets.pair(knob, value))
            continue
        reading.append(k)
        present, step = knob.ready(point.nominal), knob.step_at(value)
        turned_by = knob.turned(point.nominal, step)
        after = replay.rows_beside(turned_by, point.nominal, base)
        same = present is point.nominal
        before = base if same else replay.rows_beside(present, point.nominal, base)
        turned.append(Turn(before, after, step))
    turns = sets.turns(pairs)
    return Met(base, sets.ready[0], tuple(moving), tuple(reading), turns, tuple(turned))
