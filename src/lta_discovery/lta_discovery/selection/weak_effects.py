"""
Search for weak effects that only all flights together can reveal.

The evidence of each side alone includes the penalty for an unknown size (Occam factor). Weak
effects cannot outweigh it twice; on all flights together it counts once. To exclude chance, the
estimates of both sides have to be similar, and no other candidate may be nearly as good.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final, final, NamedTuple

from lta_discovery.fit.deviations import fit_deviations
from lta_discovery.fit.evidence import (
    build_shared_prior,
    NO_SIZES,
    Prior,
    ReducedFlight,
    Sizes,
    widen_tolerance,
)
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.model.candidates import expand_vectors, list_component_sizes, vector_cost
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.candidate_acceptance import CandidateTrial, TIE, TRIFLE
from lta_discovery.selection.candidate_scan import CandidateScore, column_cosines, scan_candidates
from lta_discovery.selection.effect_search import SelectionRound
from lta_discovery.selection.interval import NORMAL, parameter_deviations
import numpy as np

GAIN: Final = 4.5  # nats; required on all flights together
# nats; the same for effects within a tolerance: all flights of an inaccurate vehicle pull in the
# same direction, so that their agreement is no evidence.
WITHIN: Final = 6.0
LEANS: Final = 1.0  # standard deviations; smallest pull of each side
APART: Final = 3.0  # standard deviations; largest difference of the two values
CALM: Final = 2.0  # noise floors; a smaller latent wrench hides no effect
QUIET: Final = 0.25  # of a noise floor; prior of the latent wrench in calm flights
ASKED: Final = 6  # best candidates of a scan
ALIKE: Final = 0.98  # cosine of two columns; above it they are equivalent


@final
class WeakCandidate(NamedTuple):
    """One candidate on all flights."""

    name: str
    gain: float  # gain in log evidence on all flights together [nats]
    # Of the training flights and of the confirming flights
    sides: tuple[CandidateScore, CandidateScore]
    least: float = GAIN  # required gain. [nats]

    @property
    def scaled_difference(self) -> float:
        """Difference of the two values, in standard deviations."""
        first, second = self.sides
        spread = float(np.hypot(first.deviation, second.deviation))
        return abs(first.value - second.value) / spread

    @property
    def is_consistent(self) -> bool:
        """Return whether both sides pull in the same direction, by a similar amount."""
        first, second = (side.score for side in self.sides)
        same = first * second > 0.0 and min(abs(first), abs(second)) > LEANS
        return same and self.scaled_difference < APART

    @property
    def trial(self) -> CandidateTrial:
        """The same as a trial of the effect search."""
        first, second = self.sides
        larger = max(abs(first.value), abs(second.value))
        part = abs(first.value - second.value) / larger if larger > 0.0 else 0.0
        rest = self.gain - first.gain
        return CandidateTrial(
            self.name, first.gain, second.gain, rest, self.scaled_difference, part
        )


def choose_candidate(
    hints: Sequence[WeakCandidate], alike: Sequence[str] = ()
) -> WeakCandidate | None:
    """
    Return the candidate to name, or None.

    `hints`: the best first. `alike`: equivalents of the best.
    """
    if not hints or hints[0].gain <= hints[0].least:
        return None
    # If one side hardly shows the effect, the criteria of strong effects may accept it.
    if not (hints[0].is_consistent or hints[0].trial.is_accepted):
        return None
    others = [one.gain for one in hints[1:] if one.name not in alike]
    return hints[0] if hints[0].gain - max(others, default=0.0) > TIE else None


@final
class WeakEffectSearch:
    """
    Search all training and confirming flights for weak effects.

    `fitter`: the flights, training flights first. `sizes`: prior deviation of each component of
    named effects in typical sizes, where known.
    """

    def __init__(self, fitter: JointFitter, teach: int, sizes: Sizes = NO_SIZES) -> None:
        self._fitter = replace(fitter, floor=QUIET * fitter.floor)
        self._teach, self._knobs, self._sizes = teach, fitter.flights[0].knobs, dict(sizes)

    def refit_with_lower_floor(self, last: JointFit) -> JointFit | None:
        """Refit calm flights with a lower noise floor; None if a wrench may hide effects."""
        if np.any(last.deviations > CALM / QUIET * self._fitter.floor):
            return None
        return self._fitter.fit_deviations(last.group, last.prior, last.deviations)

    def rank_candidates(self, names: Sequence[str], last: JointFit) -> list[WeakCandidate]:
        """Return the best candidates in addition to some effects, the best first."""
        sides = [self._scan_side(part, last) for part in self._reduce_sides(last)]
        out, taken = [], expand_vectors(names)
        for seen in scan_candidates(last.reduced, last.group.at, last.prior, self._knobs)[:ASKED]:
            if seen.name not in taken and all(
                self._is_within_bounds(seen.name, side) for side in sides
            ):
                taken |= expand_vectors([seen.name])
                gain = self._best_gain(seen.name, names, last)
                both = sides[0][seen.name], sides[1][seen.name]
                least = self._required_evidence(seen.name, both)
                out.append(WeakCandidate(seen.name, gain, both, least))
        return sorted(out, key=lambda hint: -hint.gain)

    def _best_gain(self, name: str, names: Sequence[str], last: JointFit) -> float:
        """Return the gain of a candidate, and choose which of its components are present."""

        def fit_evidence(prior: Prior) -> float:
            return fit_deviations(last.group, prior, last.deviations, self._fitter.floor)[1]

        ways = list_component_sizes(name)
        evidence = [
            fit_evidence(build_shared_prior(self._knobs, (*names, name), {**self._sizes, **sizes}))
            for sizes in ways
        ]
        self._sizes.update(ways[int(np.argmax(evidence))])
        without, places = last.evidence, [self._parameter_index(one) for one in ways[0]]
        if np.any(np.diag(last.prior.covariance)[places] > 0.0):
            # The tolerance may be larger than assumed
            wider = fit_evidence(widen_tolerance(last.prior, places))
            without = max(without, wider - float(np.log(2.0)))
        return max(evidence) - without - vector_cost(name)

    def _is_within_bounds(self, name: str, side: Mapping[str, CandidateScore]) -> bool:
        """Return whether a side observes a candidate, with a possible value."""
        seen = side.get(name)
        return seen is not None and self._find_parameter(name).is_within_bounds(
            seen.value, seen.deviation
        )

    def _find_parameter(self, name: str) -> FreeParameter:
        """Return a knob by its name."""
        return self._knobs[self._parameter_index(name)]

    def _parameter_index(self, name: str) -> int:
        """Return which knob has a name."""
        return next(k for k, knob in enumerate(self._knobs) if knob.name == name)

    def _required_evidence(self, name: str, sides: Sequence[CandidateScore]) -> float:
        """Return the required gain of a candidate."""
        knob = self._find_parameter(name)
        tolerance = 0.0 if knob.per_flight else knob.tolerance
        return WITHIN if tolerance > max(side.deviation for side in sides) else GAIN

    def run_round(self, names: Sequence[str], last: JointFit) -> tuple[SelectionRound, JointFit]:
        """
        Run one round; return it and the fit after it.

        `last`: all flights with them, by `refit_with_lower_floor`.
        """
        hints = self.rank_candidates(names, last)
        trials = tuple(hint.trial for hint in hints)
        alike = self._list_equivalents(hints, last)
        best = choose_candidate(hints, alike)
        if best is None:
            return SelectionRound(trials, (), ''), last
        then = self._fitter.fit(
            build_shared_prior(self._knobs, (*names, best.name), self._sizes),
            last.group,
            last.deviations,
        )
        gain = then.evidence - last.evidence - vector_cost(best.name)
        if gain <= best.least or not self._is_significant(best.name, then):
            return SelectionRound(trials, (), ''), last
        return SelectionRound(trials, alike, best.name), then

    def _is_significant(self, name: str, then: JointFit) -> bool:
        """Return whether the interval of an effect excludes 0, and its size is relevant."""
        k = self._parameter_index(name)
        deviation = parameter_deviations(then.fitted, self._knobs, False)[k]
        least = max(NORMAL * deviation, TRIFLE * self._knobs[k].typical)
        return bool(abs(then.fitted.mean[k]) > least)

    def _list_equivalents(self, hints: Sequence[WeakCandidate], last: JointFit) -> tuple[str, ...]:
        """Return the equivalents of the best candidate."""
        names = [hint.name for hint in hints]
        cosine = np.abs(column_cosines(last.reduced, last.prior, names, self._knobs))
        return tuple(name for k, name in enumerate(names) if k and cosine[0, k] > ALIKE)

    def _reduce_sides(self, last: JointFit) -> tuple[ReducedFlight, ReducedFlight]:
        """Return the reduced training and confirming flights about the same point."""
        pieces = last.group.pieces
        first, second = (
            replace(last.group, pieces=some).reduce_flights(last.deviations)
            for some in (pieces[: self._teach], pieces[self._teach :])
        )
        return first, second

    def _scan_side(self, side: ReducedFlight, last: JointFit) -> dict[str, CandidateScore]:
        return {
            seen.name: seen
            for seen in scan_candidates(side, last.group.at, last.prior, self._knobs)
        }
