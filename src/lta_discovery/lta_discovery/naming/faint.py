"""
Effects too faint for any flight alone: what all of them say together, and each says as well.

Evidence that is asked of each flight by itself pays twice for not knowing how large an effect is,
and what a flight has to win alone, no faint effect can. On all flights together it is paid once.
What keeps chance out is asked of the sides afterwards: that each by itself leans the same way, by
as much, and that nothing else does nearly as well.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final, final, NamedTuple

from lta_discovery.fit.deviations import weighed
from lta_discovery.fit.evidence import NO_SIZES, Reduced, shared, Sizes
from lta_discovery.fit.fit import Fitter, Joint
from lta_discovery.model.candidates import whole
from lta_discovery.model.knobs import Knob
from lta_discovery.naming.accept import TIE, Trial, TRIFLE
from lta_discovery.naming.interval import NORMAL, spread
from lta_discovery.naming.naming import Step
from lta_discovery.naming.scan import likeness, scan, Seen
import numpy as np

GAIN: Final = 4.5  # nats; of all flights together
# The same of what hides in a tolerance: all flights of a vehicle that is merely off by much lean
# the same way, so that their agreement is no witness.
WITHIN: Final = 6.0
LEANS: Final = 1.0  # deviations; by which each side has to pull, the same way as the other
APART: Final = 3.0  # deviations; by which the two values may differ
CALM: Final = 2.0  # floors; a latent wrench below it hides nothing that pushes
QUIET: Final = 0.25  # of a floor; what is taken to be usual where flights are calm
ASKED: Final = 6  # candidates of a glance
ALIKE: Final = 0.98  # of the cosine of two columns; beyond it one name stands for both


@final
class Hint(NamedTuple):
    """
    One candidate on all flights.

    Attributes
    ----------
    name : str
        Its name.
    gain : float
        Log evidence that it wins on all flights together. [nats]
    sides : pair of Seen
        What those that teach and those that confirm say of it by themselves.
    least : float
        Log evidence that it has to win. [nats]

    """

    name: str
    gain: float
    sides: tuple[Seen, Seen]
    least: float = GAIN

    @property
    def apart(self) -> float:
        """Difference of the two values, in deviations."""
        first, second = self.sides
        spread = float(np.hypot(first.deviation, second.deviation))
        return abs(first.value - second.value) / spread

    @property
    def leans(self) -> bool:
        """Tell whether both sides pull the same way, and by as much."""
        first, second = (side.score for side in self.sides)
        same = first * second > 0.0 and min(abs(first), abs(second)) > LEANS
        return same and self.apart < APART

    @property
    def trial(self) -> Trial:
        """The same in the words of flights that are put to the test one by one."""
        first, second = self.sides
        larger = max(abs(first.value), abs(second.value))
        part = abs(first.value - second.value) / larger if larger > 0.0 else 0.0
        rest = self.gain - first.gain
        return Trial(self.name, first.gain, second.gain, rest, self.apart, part)


def chosen(hints: Sequence[Hint], alike: Sequence[str] = ()) -> Hint | None:
    """
    Return the candidate that is named, None where none is.

    Parameters
    ----------
    hints : sequence of Hint
        The best first.
    alike : sequence of str
        Those that cannot be told from the best.

    """
    if not hints or hints[0].gain <= hints[0].least:
        return None
    # A side in which an effect hardly shows need not lean, if it is by no means a faint one.
    if not (hints[0].leans or hints[0].trial.accepted):
        return None
    others = [one.gain for one in hints[1:] if one.name not in alike]
    return hints[0] if hints[0].gain - max(others, default=0.0) > TIE else None


@final
class Faint:
    """
    All flights that teach or confirm.

    Parameters
    ----------
    fitter : Fitter
        The flights, those that teach first.
    teach : int
        How many teach.
    sizes : mapping of str to float
        How many typical sizes the effects that were named may have, where it is not one.

    """

    def __init__(self, fitter: Fitter, teach: int, sizes: Sizes = NO_SIZES) -> None:
        self._fitter = replace(fitter, floor=QUIET * fitter.floor)
        self._teach, self._knobs, self._sizes = teach, fitter.flights[0].knobs, sizes

    def quiet(self, last: Joint) -> Joint | None:
        """Return calm flights with less force supposed; None where others may hide in it."""
        if np.any(last.deviations > CALM / QUIET * self._fitter.floor):
            return None
        return self._fitter.settled(last.group, last.prior, last.deviations)

    def hints(self, names: Sequence[str], last: Joint) -> list[Hint]:
        """Return the best candidates beside some effects, the best first."""
        sides = [self._seen(part, last) for part in self._sides(last)]
        out, taken = [], whole(names)
        for seen in scan(last.reduced, last.group.at, last.prior, self._knobs)[:ASKED]:
            if seen.name not in taken and all(self._found(seen.name, side) for side in sides):
                taken |= whole([seen.name])
                prior = shared(self._knobs, (*names, seen.name), self._sizes)
                there = weighed(last.group, prior, last.deviations, self._fitter.floor)[1]
                both = sides[0][seen.name], sides[1][seen.name]
                gain, least = there - last.evidence, self._least(seen.name, both)
                out.append(Hint(seen.name, gain, both, least))
        return sorted(out, key=lambda hint: -hint.gain)

    def _found(self, name: str, side: Mapping[str, Seen]) -> bool:
        """Tell whether a side says anything of a candidate, and nothing that cannot be."""
        seen = side.get(name)
        return seen is not None and self._knob(name).possible(seen.value, seen.deviation)

    def _knob(self, name: str) -> Knob:
        """Return a knob by its name."""
        return self._knobs[self._place(name)]

    def _place(self, name: str) -> int:
        """Return which knob has a name."""
        return next(k for k, knob in enumerate(self._knobs) if knob.name == name)

    def _least(self, name: str, sides: Sequence[Seen]) -> float:
        """Return what a candidate has to win, by what bounds it: tolerance or flights."""
        knob = self._knob(name)
        tolerance = 0.0 if knob.per_flight else knob.tolerance
        return WITHIN if tolerance > max(side.deviation for side in sides) else GAIN

    def next(self, names: Sequence[str], last: Joint) -> tuple[Step, Joint]:
        """
        Return the next round, and all flights after it.

        Parameters
        ----------
        names : sequence of str
            The effects that are in the model.
        last : Joint
            All flights with them, by `quiet`.

        """
        hints = self.hints(names, last)
        trials = tuple(hint.trial for hint in hints)
        alike = self._alike(hints, last)
        best = chosen(hints, alike)
        if best is None:
            return Step(trials, (), ''), last
        then = self._fitter.fit(
            shared(self._knobs, (*names, best.name), self._sizes), last.group, last.deviations
        )
        if then.evidence - last.evidence <= best.least or not self._is_something(best.name, then):
            return Step(trials, (), ''), last
        return Step(trials, alike, best.name), then

    def _is_something(self, name: str, then: Joint) -> bool:
        """Tell whether an effect is there at all, anywhere in its interval, and no trifle."""
        k = self._place(name)
        deviation = spread(then.fitted, self._knobs, False)[k]
        least = max(NORMAL * deviation, TRIFLE * self._knobs[k].typical)
        return bool(abs(then.fitted.mean[k]) > least)

    def _alike(self, hints: Sequence[Hint], last: Joint) -> tuple[str, ...]:
        """Return the names that are one with the best."""
        names = [hint.name for hint in hints]
        cosine = np.abs(likeness(last.reduced, last.prior, names, self._knobs))
        return tuple(name for k, name in enumerate(names) if k and cosine[0, k] > ALIKE)

    def _sides(self, last: Joint) -> tuple[Reduced, Reduced]:
        """Return what those that teach and those that confirm say, about the same point."""
        pieces = last.group.pieces
        first, second = (
            replace(last.group, pieces=some).reduced(last.deviations)
            for some in (pieces[: self._teach], pieces[self._teach :])
        )
        return first, second

    def _seen(self, side: Reduced, last: Joint) -> dict[str, Seen]:
        """Return all candidates on one side."""
        return {seen.name: seen for seen in scan(side, last.group.at, last.prior, self._knobs)}
