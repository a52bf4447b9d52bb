"""
Search for missing effects one by one, until no candidate is confirmed.

A linear scan of all candidates (`scan_candidates`) can overestimate gains, and large unexplained
forces can hide an effect. The best few candidates are therefore refitted, separately on training
and confirming flights, and only these refits decide.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.fit import initial_guess
from lta_discovery.fit.deviations import fit_deviations
from lta_discovery.fit.evidence import (
    build_shared_prior,
    per_flight_variance,
    posterior_as_prior,
    Prior,
    Sizes,
    wrench_floor,
)
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.fit.multistart import choose_start, TRIED
from lta_discovery.model.candidates import (
    expand_vectors,
    list_component_sizes,
    vector_components,
    vector_cost,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.selection.candidate_acceptance import APART, CandidateTrial, TIE, TRIFLE
from lta_discovery.selection.candidate_scan import column_cosines, scan_candidates, SIZES
from lta_discovery.selection.residual_guards import is_generic_effect
from lta_discovery.selection.rival_test import (
    AGREED,
    HALF,
    QUARTER,
    relative_difference,
    RivalTest,
    scaled_difference,
)
import numpy as np

Pair = tuple[JointFit, JointFit]
# Candidates to refit: predicted gain [nats], and indistinguishable candidates.
Glance = Mapping[str, tuple[float, tuple[str, ...]]]

QUICK: Final = 5  # best candidates of each scan
REFITTED: Final = 4  # most refitted candidates of a round
CAP: Final = 1.5  # noise floors; largest deviations in the second scan
MOST: Final = 4  # most effects
WORTH: Final = 1.0  # nats; a candidate with a smaller scan gain is ignored
ROUGHLY: Final = 0.3  # nats; accuracy of a predicted gain
HOPE: Final = 5.0  # nats; a candidate with a smaller predicted gain on all flights is ignored
# of the best gain so far; a candidate with a smaller prediction is not refitted
HOPELESS: Final = 0.35
ALIKE: Final = 0.98  # cosine of two columns; above it one refit stands for both
UNLIKE: Final = 0.5  # cosine; below it the failure of one candidate does not affect the other
CHANCES: Final = 1  # further scans, excluding failed candidates
EVEN: Final = 0.2  # of the gain on one side; such a candidate needs this much on the other
CAPPED: Final = 2.5  # noise floors; largest deviations at the start of a fit


def _prior_cost(name: str, sizes: Sizes) -> float:
    """Return the prior cost of an unusual size, and of the choice of components. [nats]"""
    return SIZES[sizes.get(name, 1.0)] + vector_cost(name)


@final
@dataclass(frozen=True, slots=True)
class SelectionRound:
    """One round of the search."""

    trials: tuple[CandidateTrial, ...]  # refitted candidates, the best first
    tied: tuple[str, ...]  # candidates that are indistinguishable from the best
    named: str  # '' if none was confirmed


@final
@dataclass(frozen=True, slots=True)
class EffectSearchResult:
    """Result of the search."""

    # Rounds; the last named nothing unless the limit was reached
    steps: tuple[SelectionRound, ...]
    names: tuple[str, ...]  # of the effects, in the order of acceptance
    fits: Pair  # of training and confirming flights, with the effects
    bare: Pair  # the same without any
    # Prior deviation of each component in typical sizes, where known
    sizes: Sizes = field(default_factory=dict)


@final
class EffectSearch:
    """
    Search the flights of one vehicle for missing effects.

    `flights`: training and confirming flights, at least one each.
    """

    def __init__(
        self,
        nominal: NominalVehicle,
        flights: tuple[Sequence[FlightLinearizer], Sequence[FlightLinearizer]],
    ) -> None:
        self.nominal, self.flights = nominal, flights
        self.knobs = flights[0][0].knobs
        self.floor = wrench_floor(nominal)
        own = per_flight_variance(self.knobs)
        self.fitters = [JointFitter(nominal, each, own, self.floor) for each in flights]
        self._displacing = RivalTest(flights, self.floor)
        self._names = [knob.name for knob in self.knobs]
        # Prior scale of each component, 0 if it is absent; filled by the scan
        self._sizes: dict[str, float] = {}

    def run(self, progress: Callable[[float], None] = lambda part: None) -> EffectSearchResult:
        """Search for missing effects, and report an estimate of the progress."""
        named: tuple[str, ...] = ()
        bare = fits = self._fit_without_effects()
        steps: list[SelectionRound] = []
        history: list[tuple[str, Pair]] = []
        while len(named) < MOST:
            # The number of rounds is unknown: approach 1 geometrically
            progress(1.0 - 0.7 * 0.5 ** len(steps))
            step, then = self._run_round(named, fits)
            steps.append(step)
            if not step.named:
                break
            # The fits without this effect, to judge it once all effects are known
            history.append((step.named, fits))
            named, fits = (*named, step.named), then
        gone = {
            *self._displacing.list_withdrawn_effects(history, fits),
            *self._find_impossible(named, fits),
        }
        if gone:
            named = tuple(name for name in named if name not in gone)
            fits = self._fit_effects(named, bare) if named else bare
            # The rounds stay in the report, but no longer name the withdrawn effects
            steps = [replace(one, named='') if one.named in gone else one for one in steps]
        sizes = {name: self._sizes[name] for name in expand_vectors(named) & {*self._sizes}}
        return EffectSearchResult(tuple(steps), named, fits, bare, sizes)

    def _fit_without_effects(self) -> Pair:
        """Fit all flights without any effect."""
        prior = build_shared_prior(self.knobs)

        def fit_side(fitter: JointFitter) -> JointFit:
            points = [
                unchanged_vehicle_point(self.nominal, self.knobs, each.replay.cut)
                for each in fitter.flights
            ]
            at, points, deviations = initial_guess.guess_start(
                fitter, prior, points[0].values, points
            )
            return fitter.fit(prior, fitter.linearize_flights(at, points), deviations)

        first, second = map_parallel(fit_side, self.fitters)
        return first, second

    def _find_parameter(self, name: str) -> FreeParameter:
        """Return a knob by its name."""
        return self.knobs[self._names.index(name)]

    def _find_impossible(self, named: Sequence[str], fits: Pair) -> set[str]:
        """Return the effects with an impossible value on one side."""
        out = set[str]()
        for name in named:
            for k in self._component_indices(name):
                for this in fits:
                    value, deviation = this.fitted.mean[k], np.sqrt(this.fitted.covariance[k, k])
                    if not self.knobs[k].is_within_bounds(float(value), float(deviation)):
                        out.add(name)
        return out

    def _component_indices(self, name: str) -> list[int]:
        """Return the indices of a candidate's components."""
        return [self._names.index(one) for one in vector_components(name) if one in self._names]

    def _is_too_small(self, name: str, fits: Pair) -> bool:
        """Return whether a candidate is too small to be named, on either side."""
        places = self._component_indices(name)
        # A vector counts by its largest component
        typical = np.array([self.knobs[k].typical for k in places])
        sizes = [np.max(np.abs(this.fitted.mean[places]) / typical) for this in fits]
        return bool(min(sizes) < TRIFLE)

    def _fit_effects(self, named: Sequence[str], before: Pair) -> Pair:
        """Fit all flights with some effects, starting from earlier fits."""
        prior = build_shared_prior(self.knobs, named, self._sizes)

        def fit_side(one: tuple[JointFitter, JointFit]) -> JointFit:
            fitter, last = one
            # Let the new effect explain what the latent wrench absorbed before
            deviations = np.minimum(last.deviations, CAPPED * self.floor)
            begin = choose_start(fitter, prior, last.group, deviations, named)
            return fitter.fit(prior, begin, deviations)

        first, second = map_parallel(fit_side, list(zip(self.fitters, before, strict=True)))
        return first, second

    def _shortlist_candidates(
        self, named: Sequence[str], fits: Pair, failed: Sequence[str] = ()
    ) -> Glance:
        """
        Return the few candidates to refit, with predicted gains and indistinguishable candidates.

        Candidates similar to a failed one are excluded, and then also the generic ones.
        """
        prior = build_shared_prior(self.knobs, named, self._sizes)
        out = {*expand_vectors(named), *self._list_excluded_candidates(failed, prior, fits)}
        gain_by_name: dict[str, float] = {}
        # Ways in which each candidate may be present, and the component that it is named after
        ways: dict[tuple[str, ...], dict[frozenset[tuple[str, float]], str]] = {}
        for this in fits:
            # A second scan with a stiffer latent wrench, which can hide less
            capped = this.group.reduce_flights(np.minimum(this.deviations, CAP * self.floor))
            for reduced in (this.reduced, capped):
                seen = [
                    s
                    for s in scan_candidates(reduced, this.group.at, prior, self.knobs)
                    if s.name not in out
                    and self._find_parameter(s.name).is_plausible_estimate(s.value, s.deviation)
                ]
                for one in seen[:QUICK]:
                    if one.gain > WORTH:
                        own_ways = ways.setdefault(vector_components(one.name), {})
                        for sizes in list_component_sizes(one.name, one.size):
                            own_ways.setdefault(frozenset(sizes.items()), one.name)
        for own_ways in ways.values():
            gains = {
                way: self._predict_gain(name, dict(way), named, fits)
                for way, name in own_ways.items()
            }
            # Scans may suggest several prior scales and components: use the most probable ones
            best = max(gains, key=lambda way: gains[way])
            self._sizes.update(best)
            gain_by_name[own_ways[best]] = gains[best]
        ranked = sorted(gain_by_name, key=lambda name: -gain_by_name[name])
        worth = [name for name in ranked if gain_by_name[name] > HOPE]
        return {
            name: (gain_by_name[name], same)
            for name, same in self._select_distinct(worth, prior, fits).items()
        }

    def _select_distinct(
        self, ranked: list[str], prior: Prior, fits: Pair
    ) -> dict[str, tuple[str, ...]]:
        """Return the first few candidates that are distinguishable on all flights."""
        alike = np.min(
            [np.abs(column_cosines(this.reduced, prior, ranked, self.knobs)) for this in fits],
            axis=0,
        )
        out: dict[str, tuple[str, ...]] = {}
        for i, name in enumerate(ranked):
            same = [other for other in out if alike[i, ranked.index(other)] > ALIKE]
            # Attach to the better of two similar candidates; one refit decides for both
            if same:
                out[same[0]] = (*out[same[0]], name)
            elif expand_vectors(out) & {name}:
                continue  # a component of what is tried already
            elif len(out) < REFITTED:
                out[name] = ()
        return out

    def _predict_gain(self, name: str, way: Sizes, named: Sequence[str], fits: Pair) -> float:
        """Return the gain of a candidate with free deviations, without a new linearization."""
        prior = build_shared_prior(self.knobs, (*named, name), {**self._sizes, **way})

        def evidence_gain(this: JointFit) -> float:
            refit = fit_deviations(this.group, prior, this.deviations, self.floor, worth=ROUGHLY)
            return refit[1] - this.evidence

        return sum(map_parallel(evidence_gain, fits)) - _prior_cost(name, way)

    def _list_excluded_candidates(
        self, failed: Sequence[str], prior: Prior, fits: Pair
    ) -> set[str]:
        """Return failed candidates, similar ones, and generic ones."""
        if not failed:
            return set()
        others = [knob.name for knob in self.knobs if knob.typical > 0.0]
        names = [*failed, *(name for name in others if name not in failed)]
        words = {name for name in others if is_generic_effect(name)}
        alike = [np.abs(column_cosines(this.reduced, prior, names, self.knobs)) for this in fits]
        nearest = np.max(alike, axis=0)[:, : len(failed)].max(axis=1)
        near = zip(names, nearest, strict=True)
        return {*failed, *words, *(name for name, cosine in near if cosine > UNLIKE)}

    def _run_round(self, named: tuple[str, ...], fits: Pair) -> tuple[SelectionRound, Pair]:
        """
        Run one round of the search.

        An effect outside the library raises the scores of similar candidates. If these fail,
        dissimilar candidates are tried as well. If a force still remains, so are candidates with
        discontinuous effects, which the linear scan cannot score.
        """
        step, then = self._try_candidates(named, fits, self._shortlist_candidates(named, fits))
        trials = step.trials
        examined = {*expand_vectors(named), *(trial.name for trial in trials)}
        for _ in range(CHANCES):
            if step.named or not step.trials or not self._displacing.has_remainder(fits):
                break
            failed = tuple(trial.name for trial in trials)
            step, then = self._try_candidates(
                named, fits, self._shortlist_candidates(named, fits, failed), failed
            )
            trials = (*trials, *step.trials)
        # An infinite prediction: always refit, since the scan cannot score these
        jumping = {name: (np.inf, ()) for name in TRIED if name in set(self._names) - examined}
        if jumping and not step.named and self._displacing.has_remainder(fits):
            step, then = self._try_candidates(named, fits, jumping)
            trials = (*step.trials, *(one for one in trials if one.name not in jumping))
        return replace(step, trials=trials), then

    def _try_candidates(
        self, named: tuple[str, ...], fits: Pair, glance: Glance, failed: Sequence[str] = ()
    ) -> tuple[SelectionRound, Pair]:
        """Refit the best candidates of a scan, and select one."""
        tried: dict[str, tuple[CandidateTrial, Pair]] = {}
        for name, (promise, _) in glance.items():
            most = max((trial.total_evidence for trial, _ in tried.values()), default=0.0)
            # Save refits that cannot win against the best one so far
            if promise < HOPELESS * most and name not in TRIED:
                continue
            try:
                then = self._fit_effects((*named, name), fits)
            except BadInput:
                continue  # no vehicle with this effect can be fitted
            tried[name] = self._evaluate_candidate(name, named, fits, then), then
        ranked = sorted(tried, key=lambda name: -tried[name][0].total_evidence)
        trials = tuple(tried[name][0] for name in ranked)
        # A lesser candidate is not confirmed by the failure of a better one, unless that fell to
        # something outside the library, or its own flights contradict each other.
        close = [
            trial for trial in trials if trials[0].total_evidence - trial.total_evidence < TIE
        ]
        fell = False
        for trial in trials:
            then = tried[trial.name][1]
            if not trial.is_accepted or self._find_impossible((trial.name,), then):
                continue
            if self._is_too_small(trial.name, then):
                continue
            if failed and not self._is_independent(trial, fits, then):
                continue
            if not (
                fell or trial in close or self._is_admissible(trial, trials, named, fits, failed)
            ):
                continue
            part = QUARTER if failed else HALF
            fell = not self._displacing.withstands_rivals(
                trial.name, trial.total_evidence, fits, then, part
            )
            if not fell:
                others = tuple(
                    one.name for one in close if one is not trial and not one.is_contradictory
                )
                tied = (*glance[trial.name][1], *others)
                return SelectionRound(trials, tied, trial.name), then
        return SelectionRound(trials, (), ''), fits

    def _is_independent(self, trial: CandidateTrial, fits: Pair, then: Pair) -> bool:
        """Return whether a candidate is sound, and not part of the remaining force."""
        # An effect that one side hardly supports may be an artefact of the other
        least, most = sorted((trial.gain, trial.replicated))
        sound = trial.wins_on_both and least > EVEN * most and trial.apart < AGREED
        return sound and self._displacing.is_independent(trial.name, fits, then)

    def _is_admissible(
        self,
        trial: CandidateTrial,
        trials: Sequence[CandidateTrial],
        named: tuple[str, ...],
        fits: Pair,
        failed: Sequence[str],
    ) -> bool:
        """
        Return whether a candidate may be named although others gain clearly more.

        The others have to be distinguishable from it and contradictory between the two sides.
        After failed candidates, the others need only be distinguishable, or disagree on their
        value.
        """
        above = [one for one in trials if one.total_evidence >= trial.total_evidence + TIE]
        if failed:
            above = [one for one in above if one.apart < APART]
        elif not (trial.wins_on_both and all(one.is_contradictory for one in above)):
            return False
        if not above:
            return True
        prior = build_shared_prior(self.knobs, named, self._sizes)
        names = [trial.name, *(one.name for one in above)]
        alike = [
            np.abs(column_cosines(this.reduced, prior, names, self.knobs))[0, 1:] for this in fits
        ]
        return bool(np.max(alike) < UNLIKE)

    def _evaluate_candidate(
        self, name: str, named: tuple[str, ...], fits: Pair, then: Pair
    ) -> CandidateTrial:
        """Return the evidence for a candidate on all flights."""
        places, cost = self._component_indices(name), _prior_cost(name, self._sizes)
        return CandidateTrial(
            name,
            then[0].evidence - fits[0].evidence - cost,
            then[1].evidence - fits[1].evidence - cost,
            self._predictive_evidence(then) - self._predictive_evidence(fits),
            max(scaled_difference(then, k) for k in places),
            relative_difference(then, self._names.index(name)),
        )

    def _predictive_evidence(self, fits: Pair) -> float:
        """Return the evidence of the confirming flights under the training posterior."""
        # Cross-validation: what the training flights taught has to help the others
        prior = posterior_as_prior(fits[0].fitted)
        return fit_deviations(fits[1].group, prior, fits[1].deviations, self.floor)[1]
