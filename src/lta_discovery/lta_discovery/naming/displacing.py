"""
Whether a candidate of the library stands against what is outside of it.

A candidate that was confirmed may still be the nearest word for something that has none. Signs of
that: a generic rival explains clearly more (more at all, where the candidate is a coefficient of
motion, the word for whatever follows the motion), and leaves little for the candidate to say; or,
when all is named, large forces that follow something remain: on every axis on which the
candidate acts, or beside a coefficient of motion that explained something much smaller; or
anything remains, and the candidate has won little, its flights differ about it, or it is a
coefficient of motion that leaves more than it explains.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final

from lta_discovery.fit.fit import Joint
from lta_discovery.model.knobs import PARTS
from lta_discovery.naming.accept import LARGER, PART
from lta_discovery.naming.beside import (
    acts_on,
    calm,
    lesser,
    LOUD,
    minor,
    partial,
    sound,
    untouched,
)
from lta_discovery.outside.rivals import Rival, Rivals
from lta_discovery.outside.standing import Standing
from lta_discovery.outside.unexplained import CLEAR, remaining
from lta_discovery.outside.verdict import standing
from lta_discovery.replay.linearise import Linearised
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pair = tuple[Joint, Joint]

BETTER: Final = 1.1  # of what a candidate wins ...
MARGIN: Final = 10.0  # ... and nats: by which a rival has to be better to displace it
BESIDE: Final = 11.0  # nats; that a candidate has to win beside such a rival ...
HALF: Final = 0.5  # ... and of what it wins without ...
QUARTER: Final = 0.25  # ... or so much, if it is no part of what remains
SMALL: Final = 1.0  # floors; forces that no rival needs to explain
FOLLOWS: Final = 0.5  # of the variance of what remains; gusts have come to 0.4
FAINT: Final = 24.0  # nats; a name that won less is none beside anything that remains
SURE: Final = 80.0  # nats; with which a coefficient of motion may leave more than it explains
AGREED: Final = 2.5  # deviations; by which the sides may differ about a name beside what remains


def bar(name: str, gain: float) -> float:
    """Return what a rival has to win to displace a candidate that won so much. [nats]"""
    motion = name.partition('.')[0] in PARTS
    return gain if motion else BETTER * gain + MARGIN


def displaced(
    gain: float,
    least: float,
    before: Mapping[str, float],
    after: Mapping[str, float],
    part: float = HALF,
) -> str:
    """
    Return the rival that takes a candidate's place, '' where the candidate stands.

    A rival that is clearly better takes it, unless the candidate has much to say beside it.

    Parameters
    ----------
    gain : float
        Log evidence that the candidate wins on all flights. [nats]
    least : float
        What a rival has to win to be clearly better: `bar`.
    before, after : mapping of str to float
        What each rival wins on them without the candidate, and beside it.
    part : float
        Of its evidence, that a candidate has to win beside such a rival.

    """
    for name in sorted(before, key=lambda one: -before[one]):
        if before[name] <= least:
            break
        if gain + after[name] - before[name] < max(BESIDE, part * gain):
            return name
    return ''


def apart(then: Pair, k: int) -> float:
    """Return by how much the values of a knob differ between the sides, in deviations."""
    values = [each.fitted.mean[k] for each in then]
    spread = sum(each.fitted.covariance[k, k] for each in then)
    return float(abs(values[0] - values[1]) / np.sqrt(spread)) if spread > 0.0 else 0.0


def differ(then: Pair, k: int) -> float:
    """Return by which part of the larger one the values of a knob differ between the sides."""
    one, other = (float(each.fitted.mean[k]) for each in then)
    larger = max(abs(one), abs(other))
    return abs(one - other) / larger if larger > 0.0 else 0.0


def each_won(before: Pair, then: Pair) -> tuple[float, float]:
    """Return the log evidence that fits have won on others, of each side. [nats]"""
    return then[0].evidence - before[0].evidence, then[1].evidence - before[1].evidence


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

    def stands(self, name: str, gain: float, fits: Pair, then: Pair, part: float = HALF) -> bool:
        """
        Tell whether a candidate stands.

        Parameters
        ----------
        name : str
            Of the candidate.
        gain : float
            Log evidence that it wins on all flights. [nats]
        fits, then : pair of Joint
            Of the flights, without it and with it.
        part : float
            As for `displaced`.

        """
        if self._floors(fits).max() < SMALL:
            return True  # there is no force for a rival to follow
        if self._last is None or self._last[0] is not fits:
            self._last = fits, self._gains(fits)
        before = self._last[1]
        least = bar(name, gain)
        if max(before.values()) <= least:
            return True
        return not displaced(gain, least, before, self._gains(then), part)

    def loud(self, fits: Pair) -> bool:
        """Tell whether anything remains."""
        return bool(self._floors(fits).max() > CLEAR)

    def elsewhere(self, name: str, fits: Pair, then: Pair) -> bool:
        """
        Tell whether a candidate is no part of what remains.

        Parameters
        ----------
        name : str
            Of the candidate.
        fits, then : pair of Joint
            Of the flights, without it and with it.

        """
        before, after = self._floors(fits), self._floors(then)
        acts = acts_on(then[0].group.linears[0], name, self._floor)
        return calm(acts, after) or untouched(before, after)

    def withdrawn(self, history: Sequence[tuple[str, Pair]], last: Pair) -> tuple[str, ...]:
        """
        Return the names that were only the nearest word for a part of something else.

        Parameters
        ----------
        history : sequence of (name, pair of Joint)
            Of each effect that was named: the fits without it.
        last : pair of Joint
            With all of them.

        """
        final = self._floors(last)
        if not history or final.max() <= CLEAR:
            return ()
        structured = final.max() > LOUD and self._structured(last)
        fits = [*(before for _, before in history), last]
        return tuple(
            name
            for (name, before), then in zip(history, fits[1:], strict=True)
            if self._falls(name, (before, then), final, structured)
        )

    def _falls(self, name: str, fits: tuple[Pair, Pair], final: Array, structured: bool) -> bool:
        """Tell whether a name falls to what remains, by the fits before it and with it."""
        before, then = fits
        linear, gains = then[0].group.linears[0], each_won(before, then)
        acts, k = acts_on(linear, name, self._floor), linear.names.index(name)
        floors, differs = self._floors(before), differ(then, k)
        weak = apart(then, k) > AGREED and differs > PART
        if weak or (sum(gains) < FAINT and not calm(acts, final)):
            return True
        if minor(name, acts, floors, final) and sum(gains) < SURE:
            return True
        aside = untouched(floors, self._floors(then)) and sound(name, gains, differs)
        if aside or not structured:
            return False
        whole = differs < PART and calm(acts, final) and min(gains) > LARGER
        return partial(acts, floors, final) or (lesser(name, acts, floors, final) and not whole)

    def _structured(self, fits: Pair) -> bool:
        """Tell whether what remains follows something, as gusts do not."""
        left = remaining(self._flights, [each.members for each in fits], self._floor)
        clearly = any(one.carried > FOLLOWS for one in left)
        return clearly or bool(standing(self._found(fits)))

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
