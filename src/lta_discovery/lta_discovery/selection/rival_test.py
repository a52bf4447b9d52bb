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

from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.model.parameters import PARTS
from lta_discovery.replay.linearizer import FlightLinearizer
from lta_discovery.selection.acceptance import LARGER, PART
from lta_discovery.selection.residual_guards import (
    find_acting_axes,
    is_calm,
    is_lesser,
    is_minor,
    is_partial,
    is_sound,
    is_unaffected,
    LOUD,
)
from lta_discovery.unmodeled.fit_baseline import FitBaseline
from lta_discovery.unmodeled.remainders import CLEAR, find_remainders
from lta_discovery.unmodeled.rivals import GenericRival, RivalSearch
from lta_discovery.unmodeled.verdict import select_confirmed_rivals
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pair = tuple[JointFit, JointFit]

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


def displacement_threshold(name: str, gain: float) -> float:
    """Return what a rival has to win to displace a candidate that won so much. [nats]"""
    motion = name.partition('.')[0] in PARTS
    return gain if motion else BETTER * gain + MARGIN


def find_better_rival(
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
        What a rival has to win to be clearly better: `displacement_threshold`.
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


def scaled_difference(then: Pair, k: int) -> float:
    """Return by how much the values of a knob differ between the sides, in deviations."""
    values = [each.fitted.mean[k] for each in then]
    spread = sum(each.fitted.covariance[k, k] for each in then)
    return float(abs(values[0] - values[1]) / np.sqrt(spread)) if spread > 0.0 else 0.0


def relative_difference(then: Pair, k: int) -> float:
    """Return by which part of the larger one the values of a knob differ between the sides."""
    one, other = (float(each.fitted.mean[k]) for each in then)
    larger = max(abs(one), abs(other))
    return abs(one - other) / larger if larger > 0.0 else 0.0


def evidence_gains(before: Pair, then: Pair) -> tuple[float, float]:
    """Return the log evidence that fits have won on others, of each side. [nats]"""
    return then[0].evidence - before[0].evidence, then[1].evidence - before[1].evidence


@final
class RivalTest:
    """
    The rivals of all candidates of a study.

    Parameters
    ----------
    flights : pair of sequences of Linearised
        Those that teach, and those that confirm.
    floor : ndarray, shape (6,)
        Deviations of the latent wrench that are not worth speaking of.

    """

    def __init__(self, flights: Sequence[Sequence[FlightLinearizer]], floor: Array) -> None:
        self._flights, self._rivals, self._floor = flights, RivalSearch(flights), floor
        self._last: tuple[Pair, dict[str, float]] | None = None

    def withstands_rivals(
        self, name: str, gain: float, fits: Pair, then: Pair, part: float = HALF
    ) -> bool:
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
            As for `find_better_rival`.

        """
        if self._relative_deviations(fits).max() < SMALL:
            return True  # there is no force for a rival to follow
        if self._last is None or self._last[0] is not fits:
            self._last = fits, self._compute_gains(fits)
        before = self._last[1]
        least = displacement_threshold(name, gain)
        if max(before.values()) <= least:
            return True
        return not find_better_rival(gain, least, before, self._compute_gains(then), part)

    def has_remainder(self, fits: Pair) -> bool:
        """Tell whether anything remains."""
        return bool(self._relative_deviations(fits).max() > CLEAR)

    def is_independent(self, name: str, fits: Pair, then: Pair) -> bool:
        """
        Tell whether a candidate is no part of what remains.

        Parameters
        ----------
        name : str
            Of the candidate.
        fits, then : pair of Joint
            Of the flights, without it and with it.

        """
        before, after = self._relative_deviations(fits), self._relative_deviations(then)
        acts = find_acting_axes(then[0].group.linears[0], name, self._floor)
        return is_calm(acts, after) or is_unaffected(before, after)

    def list_withdrawn(self, history: Sequence[tuple[str, Pair]], last: Pair) -> tuple[str, ...]:
        """
        Return the names that were only the nearest word for a part of something else.

        Parameters
        ----------
        history : sequence of (name, pair of Joint)
            Of each effect that was named: the fits without it.
        last : pair of Joint
            With all of them.

        """
        final = self._relative_deviations(last)
        if not history or final.max() <= CLEAR:
            return ()
        structured = final.max() > LOUD and self._is_structured(last)
        fits = [*(before for _, before in history), last]
        return tuple(
            name
            for (name, before), then in zip(history, fits[1:], strict=True)
            if self._is_withdrawn(name, (before, then), final, structured)
        )

    def _is_withdrawn(
        self, name: str, fits: tuple[Pair, Pair], final: Array, structured: bool
    ) -> bool:
        """Tell whether a name falls to what remains, by the fits before it and with it."""
        before, then = fits
        linear, gains = then[0].group.linears[0], evidence_gains(before, then)
        acts, k = find_acting_axes(linear, name, self._floor), linear.names.index(name)
        floors, differs = self._relative_deviations(before), relative_difference(then, k)
        weak = scaled_difference(then, k) > AGREED and differs > PART
        if weak or (sum(gains) < FAINT and not is_calm(acts, final)):
            return True
        if is_minor(name, acts, floors, final) and sum(gains) < SURE:
            return True
        aside = is_unaffected(floors, self._relative_deviations(then)) and is_sound(
            name, gains, differs
        )
        if aside or not structured:
            return False
        whole = differs < PART and is_calm(acts, final) and min(gains) > LARGER
        return is_partial(acts, floors, final) or (
            is_lesser(name, acts, floors, final) and not whole
        )

    def _is_structured(self, fits: Pair) -> bool:
        """Tell whether what remains follows something, as gusts do not."""
        left = find_remainders(self._flights, [each.members for each in fits], self._floor)
        clearly = any(one.carried > FOLLOWS for one in left)
        return clearly or bool(select_confirmed_rivals(self._find_rivals(fits)))

    def _find_rivals(self, fits: Pair) -> tuple[GenericRival, ...]:
        """Return the rivals on some fits."""
        return self._rivals.rank_rivals(
            [FitBaseline.from_joint(each, self._floor) for each in fits]
        )

    def _compute_gains(self, fits: Pair) -> dict[str, float]:
        """Return what each rival wins on all flights."""
        return {one.name: one.total_evidence for one in self._find_rivals(fits)}

    def _relative_deviations(self, fits: Pair) -> Array:
        """Return the deviations, by the floor: geometric mean of the sides."""
        logs = np.mean([np.log(each.deviations / self._floor) for each in fits], axis=0)
        together: Array = np.exp(logs)
        return together
