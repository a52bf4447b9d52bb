"""
Test a candidate of the library against generic rivals outside of it.

A confirmed candidate may only be the nearest match of an effect outside the library. It is
withdrawn if a generic rival explains clearly more (for a motion effect: more at all) and leaves it
little evidence. At the end of the search it is also withdrawn if large structured forces remain on
all its axes, or are much larger than a motion effect; and, if anything remains, if its evidence is
weak, its sides disagree, it is a motion effect that leaves more than it explains, or forces far
above the noise remain on all its axes and it is not credible beside them.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final

from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.model.parameters import PARTS
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.selection.candidate_acceptance import LARGER, PART
from lta_discovery.selection.residual_guards import (
    find_acting_axes,
    has_no_remainder,
    is_credible,
    is_generic_effect,
    is_motion_coefficient,
    is_partial_explanation,
    is_small_motion_effect,
    leaves_larger_remainder,
    leaves_remainder_unchanged,
    LOUD,
)
from lta_discovery.unmodeled.fit_baseline import FitBaseline
from lta_discovery.unmodeled.rivals import GenericRival, RivalSearch
from lta_discovery.unmodeled.unexplained_force import CLEAR, find_unexplained_forces
from lta_discovery.unmodeled.verdict import select_confirmed_rivals
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pair = tuple[JointFit, JointFit]

BETTER: Final = 1.1  # of the gain of a candidate ...
MARGIN: Final = 10.0  # ... plus nats: gain at which a rival displaces it
BESIDE: Final = 11.0  # nats; gain of a candidate together with such a rival ...
HALF: Final = 0.5  # ... and part of its gain without ...
QUARTER: Final = 0.25  # ... or this part, if it is independent of the remainder
SMALL: Final = 1.0  # noise floors; smaller forces need no rival
FOLLOWS: Final = 0.5  # of the variance of the remainder; gusts have reached 0.4
FAINT: Final = 24.0  # nats; a name with less evidence is withdrawn if anything remains
# Nats; with more, a motion effect may leave more than it explains; another effect may, with more
# than this on each side, stand beside any remainder.
SURE: Final = 80.0
# Noise floors; a name with such remainders on all its axes has to be credible even if they follow
# nothing, as fast oscillations do.
DROWNED: Final = 20.0
AGREED: Final = 2.5  # standard deviations; largest difference of the sides if anything remains


def displacement_threshold(name: str, gain: float) -> float:
    """Return the gain at which a rival displaces a candidate. [nats]"""
    # Motion effects resemble any rival, so every better rival displaces them
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
    Return the rival that displaces a candidate, '' if there is none.

    A clearly better rival displaces it, unless the candidate keeps enough evidence together with
    it.

    `least`: gain of a clearly better rival: `displacement_threshold`. `before`, `after`: gain of
    each rival without the candidate, and with it.
    """
    # Strongest first, so the loop may stop at the first rival that is too weak
    for name in sorted(before, key=lambda one: -before[one]):
        if before[name] <= least:
            break
        # Evidence of the candidate given the rival: joint gain less the rival's own
        if gain + after[name] - before[name] < max(BESIDE, part * gain):
            return name
    return ''


def scaled_difference(then: Pair, k: int) -> float:
    """Return the difference of a parameter between the sides, in standard deviations."""
    values = [each.fitted.mean[k] for each in then]
    spread = sum(each.fitted.covariance[k, k] for each in then)
    return float(abs(values[0] - values[1]) / np.sqrt(spread)) if spread > 0.0 else 0.0


def relative_difference(then: Pair, k: int) -> float:
    """Return the difference of a parameter between the sides, relative to the larger value."""
    one, other = (float(each.fitted.mean[k]) for each in then)
    larger = max(abs(one), abs(other))
    return abs(one - other) / larger if larger > 0.0 else 0.0


def evidence_gains(before: Pair, then: Pair) -> tuple[float, float]:
    """Return the gain in log evidence of each side. [nats]"""
    return then[0].evidence - before[0].evidence, then[1].evidence - before[1].evidence


@final
class RivalTest:
    """Test candidates against generic rivals."""

    def __init__(self, flights: Sequence[Sequence[FlightLinearizer]], floor: Array) -> None:
        self._flights, self._rivals, self._floor = flights, RivalSearch(flights), floor
        self._last: tuple[Pair, dict[str, float]] | None = None

    def withstands_rivals(
        self, name: str, gain: float, fits: Pair, then: Pair, part: float = HALF
    ) -> bool:
        """
        Return whether no rival displaces a candidate.

        `fits`, `then`: without it and with it.
        """
        if self._relative_deviations(fits).max() < SMALL:
            return True  # no force for a rival to explain
        # Several candidates of a round share the same fits: rate the rivals once
        if self._last is None or self._last[0] is not fits:
            self._last = fits, self._rival_gains(fits)
        before = self._last[1]
        least = displacement_threshold(name, gain)
        if max(before.values()) <= least:
            return True
        return not find_better_rival(gain, least, before, self._rival_gains(then), part)

    def has_remainder(self, fits: Pair) -> bool:
        """Return whether an unexplained force remains."""
        return bool(self._relative_deviations(fits).max() > CLEAR)

    def is_independent(self, name: str, fits: Pair, then: Pair) -> bool:
        """Return whether a candidate is independent of the remainder."""
        before, after = self._relative_deviations(fits), self._relative_deviations(then)
        acts = find_acting_axes(then[0].group.linears[0], name, self._floor)
        return has_no_remainder(acts, after) or leaves_remainder_unchanged(before, after)

    def list_withdrawn_effects(
        self, history: Sequence[tuple[str, Pair]], last: Pair
    ) -> tuple[str, ...]:
        """
        Return the named effects that only match a part of another, unnamed effect.

        `history`: of each named effect: the fits without it.
        """
        final = self._relative_deviations(last)
        if not history or final.max() <= CLEAR:
            return ()
        structured = final.max() > LOUD and self._follows_state(last)
        fits = [*(before for _, before in history), last]
        return tuple(
            name
            for (name, before), then in zip(history, fits[1:], strict=True)
            if self._is_withdrawn(name, (before, then), final, structured)
        )

    def _is_withdrawn(
        self, name: str, fits: tuple[Pair, Pair], final: Array, structured: bool
    ) -> bool:
        """Return whether a name is withdrawn because of the remainder."""
        before, then = fits
        linear, gains = then[0].group.linears[0], evidence_gains(before, then)
        acts, k = find_acting_axes(linear, name, self._floor), linear.names.index(name)
        # Remainder before the candidate was added
        floors, differs = self._relative_deviations(before), relative_difference(then, k)
        unchanged = leaves_remainder_unchanged(floors, self._relative_deviations(then))
        calm = has_no_remainder(acts, final)
        # A remainder elsewhere, which the effect leaves as it is, does not distort its values
        differs_more = scaled_difference(then, k) > AGREED and differs > PART
        if differs_more and not (calm and unchanged):
            return True
        # Moving air shows in surge and sway first; a drag on another axis may stand for the rest
        in_moving_air = is_motion_coefficient(name) and final[:2].min() > CLEAR
        if sum(gains) < FAINT and (not calm or in_moving_air):
            return True
        if leaves_larger_remainder(name, acts, floors, final) and sum(gains) < SURE:
            return True
        credible = is_credible(name, gains, differs)
        if acts.any() and final[acts].min() > DROWNED and not credible:
            return True
        aside = unchanged and credible
        if aside or not structured or self._is_unrivalled(name, before, gains, differs):
            return False
        whole = differs < PART and calm and min(gains) > LARGER
        return is_partial_explanation(acts, floors, final) or (
            is_small_motion_effect(name, acts, floors, final) and not whole
        )

    def _is_unrivalled(
        self, name: str, before: Pair, gains: tuple[float, float], part: float
    ) -> bool:
        """
        Return whether a specific effect explains far more than any generic rival could.

        It is then a cause of its own beside a remainder, however large that is.
        """
        specific = not is_generic_effect(name) and part < PART and min(gains) > SURE
        return specific and QUARTER * sum(gains) > max(self._rival_gains(before).values())

    def _follows_state(self, fits: Pair) -> bool:
        """Return whether the remainder follows the state, unlike gusts."""
        left = find_unexplained_forces(self._flights, [each.members for each in fits], self._floor)
        clearly = any(one.carried > FOLLOWS for one in left)
        return clearly or bool(select_confirmed_rivals(self._find_rivals(fits)))

    def _find_rivals(self, fits: Pair) -> tuple[GenericRival, ...]:
        return self._rivals.rank_rivals(
            [FitBaseline.from_joint(each, self._floor) for each in fits]
        )

    def _rival_gains(self, fits: Pair) -> dict[str, float]:
        """Return the gain of each rival on all flights."""
        return {one.name: one.total_evidence for one in self._find_rivals(fits)}

    def _relative_deviations(self, fits: Pair) -> Array:
        """Return the deviations by the noise floor, as geometric mean of the sides."""
        # Ratios are averaged in the logarithm, so that neither side dominates
        logs = np.mean([np.log(each.deviations / self._floor) for each in fits], axis=0)
        together: Array = np.exp(logs)
        return together
