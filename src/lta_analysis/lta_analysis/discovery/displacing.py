"""
Whether a candidate of the library stands against what is outside of it.

A candidate that was confirmed may still be the nearest word for something that has none. Two
signs of that: a generic rival explains clearly more, and leaves little for the candidate to say;
or large forces remain, and the candidate has made none of them smaller.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final

from lta_analysis.discovery.fit import Joint
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.rivals import Rivals
from lta_analysis.discovery.standing import Standing
from lta_analysis.discovery.unexplained import CLEAR
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pair = tuple[Joint, Joint]

BETTER: Final = 1.1  # of what a candidate wins ...
MARGIN: Final = 10.0  # ... and nats: by which a rival has to be better to displace it
BESIDE: Final = 11.0  # nats; that a candidate has to win beside such a rival ...
HALF: Final = 0.5  # ... and of what it wins without
SMALLER: Final = 0.8  # of a large deviation; what a candidate has to make it
PLAIN: Final = 100.0  # nats; evidence that needs no such sign


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


def beside_the_point(before: Array, after: Array) -> bool:
    """
    Tell whether large forces remain and a candidate has made none of them smaller.

    Parameters
    ----------
    before, after : ndarray, shape (6,)
        Deviations of the latent wrench without the candidate and with it. [floors]

    """
    large = before > CLEAR
    return bool(np.any(after > CLEAR) and not np.any(large & (after < SMALLER * before)))


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
        self._rivals, self._floor = Rivals(flights), floor
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
        was, now = (self._floors(each) for each in (fits, then))
        if gain < PLAIN and beside_the_point(was, now):
            return False
        if self._last is None or self._last[0] is not fits:
            self._last = fits, self._gains(fits)
        before = self._last[1]
        if max(before.values()) <= BETTER * gain + MARGIN:
            return True
        return not displaced(gain, before, self._gains(then))

    def _gains(self, fits: Pair) -> dict[str, float]:
        """Return what each rival wins on all flights."""
        found = self._rivals.found([Standing.of(each, self._floor) for each in fits])
        return {one.name: one.total for one in found}

    def _floors(self, fits: Pair) -> Array:
        """Return the deviations, by the floor: geometric mean of the sides."""
        logs = np.mean([np.log(each.deviations / self._floor) for each in fits], axis=0)
        together: Array = np.exp(logs)
        return together
