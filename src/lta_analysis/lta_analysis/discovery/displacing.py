"""
Whether a candidate of the library stands against what is outside of it.

A candidate that was confirmed may still be the nearest word for something that has none. Two
signs of that: a generic rival explains clearly more, and leaves little for the candidate to say;
or, when all is named, a large force that follows something remains on every axis on which the
candidate has explained a part of it.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import Final, final

from lta_analysis.discovery.fit import Joint
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.rivals import Rival, Rivals
from lta_analysis.discovery.standing import Standing
from lta_analysis.discovery.unexplained import CLEAR, remaining
from lta_analysis.discovery.verdict import standing
from lta_sim.effects.protocol import AXES as NAMES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pair = tuple[Joint, Joint]

BETTER: Final = 1.1  # of what a candidate wins ...
MARGIN: Final = 10.0  # ... and nats: by which a rival has to be better to displace it
BESIDE: Final = 11.0  # nats; that a candidate has to win beside such a rival ...
HALF: Final = 0.5  # ... and of what it wins without
SMALL: Final = 1.0  # floors; forces that no rival needs to explain
TOUCHED: Final = 0.93  # of a large deviation; less than that, and a candidate has a part in it
MOST: Final = 0.4  # of it; what may remain where the candidate was most of it


def displaced(gain: float, before: Mapping[str, float], after: Mapping[str, float]) -> str:
    """
    Return the rival that takes a candidate's place, '' where the candidate stands.

    A rival that is clearly better takes it, unless the candidate has much to say beside it.

    Parameters
    ----------
    gain : float
        Log evidence that the candidate wins on all flights. [nats]
    before, after : mapping of str to float
        What each rival wins on them without the candidate, and beside it.

    """
    for name in sorted(before, key=lambda one: -before[one]):
        if before[name] <= BETTER * gain + MARGIN:
            break
        if gain + after[name] - before[name] < max(BESIDE, HALF * gain):
            return name
    return ''


def partial(before: Array, after: Array, final: Array, structured: Collection[int]) -> bool:
    """
    Tell whether a candidate has only explained a part of something larger.

    Parameters
    ----------
    before, after, final : ndarray, shape (6,)
        Deviations of the latent wrench without the candidate, with it, and with all that was
        named after it. [floors]
    structured : collection of int
        Axes on which what remains follows something, as gusts do not.

    """
    touched = np.flatnonzero((before > CLEAR) & (after < TOUCHED * before))
    left = [k in structured and final[k] > CLEAR and final[k] > MOST * before[k] for k in touched]
    return bool(left) and all(left)


@final
class Displacing:
    """
    The rivals of all candidates of a study.

    Parameters
    ----------
    flights : pair of sequences of Linearised
        Those that teach, and those that confirm.
    floor : ndarray, shape (6,)
        Deviations of the latent wrench that are not worth speaking of.

    """

    def __init__(self, flights: Sequence[Sequence[Linearised]], floor: Array) -> None:
        self._flights, self._rivals, self._floor = flights, Rivals(flights), floor
        self._last: tuple[Pair, dict[str, float]] | None = None

    def stands(self, gain: float, fits: Pair, then: Pair) -> bool:
        """
        Tell whether a candidate stands.

        Parameters
        ----------
        gain : float
            Log evidence that it wins on all flights. [nats]
        fits, then : pair of Joint
            Of the flights, without it and with it.

        """
        if self._floors(fits).max() < SMALL:
            return True  # there is no force for a rival to follow
        if self._last is None or self._last[0] is not fits:
            self._last = fits, self._gains(fits)
        before = self._last[1]
        if max(before.values()) <= BETTER * gain + MARGIN:
            return True
        return not displaced(gain, before, self._gains(then))

    def withdrawn(self, history: Sequence[tuple[str, Pair, Pair]], last: Pair) -> tuple[str, ...]:
        """
        Return the names that were only the nearest word for a part of something else.

        Parameters
        ----------
        history : sequence of (name, pair of Joint, pair of Joint)
            Of each effect that was named: the fits without it, and with it.
        last : pair of Joint
            With all of them.

        """
        final = self._floors(last)
        if not history or final.max() <= CLEAR:
            return ()
        structured = self._structured(last)
        return tuple(
            name
            for name, before, after in history
            if partial(self._floors(before), self._floors(after), final, structured)
        )

    def _structured(self, fits: Pair) -> set[int]:
        """Return the axes on which what remains follows something."""
        left = remaining(self._flights, [each.members for each in fits], self._floor)
        follow = {one.axis for one in left if one.follows}
        for one in standing(self._found(fits)):
            follow |= set(one.axes)
        return {NAMES.index(axis) for axis in follow}

    def _found(self, fits: Pair) -> tuple[Rival, ...]:
        """Return the rivals on some fits."""
        return self._rivals.found([Standing.of(each, self._floor) for each in fits])

    def _gains(self, fits: Pair) -> dict[str, float]:
        """Return what each rival wins on all flights."""
        return {one.name: one.total for one in self._found(fits)}

    def _floors(self, fits: Pair) -> Array:
        """Return the deviations, by the floor: geometric mean of the sides."""
        logs = np.mean([np.log(each.deviations / self._floor) for each in fits], axis=0)
        together: Array = np.exp(logs)
        return together
