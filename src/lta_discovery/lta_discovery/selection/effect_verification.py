"""
Verify named effects on all flights together.

Each effect is removed and everything else refitted: the cost is its evidence. Each is also
replaced by every other candidate. Equally good ones are its rivals; a better one replaces it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_discovery.fit.evidence import (
    build_shared_prior,
    per_flight_variance,
    Prior,
    widen_tolerance,
    wrench_floor,
)
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.model.candidates import (
    expand_vectors,
    list_component_sizes,
    vector_components,
    vector_cost,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.selection.candidate_acceptance import LARGER, TIE, TRIFLE
from lta_discovery.selection.candidate_scan import column_cosines
from lta_discovery.selection.effect_search import EffectSearchResult, MOST, Pair, SelectionRound
from lta_discovery.selection.residual_guards import find_acting_axes
from lta_discovery.selection.weak_effects import WeakEffectSearch
from lta_discovery.unmodeled.fit_baseline import FitBaseline
from lta_discovery.unmodeled.rivals import RivalSearch
from lta_discovery.unmodeled.verdict import select_evident_rivals
from lta_model.effects.protocol import AXES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Nats; smallest cost of removal. Less than for acceptance: shared tolerances absorb part of an
# effect on each side separately, and that gain does not add up.
KEPT: Final = LARGER
CERTAIN: Final = 60.0  # nats; a removal with a larger linearized cost needs no refit
NEAR: Final = 15.0  # nats; a rival with a larger linearized loss is ignored
ALIKE: Final = 0.9  # cosine of two columns; above it they are equivalent
RIVALS: Final = 2  # most refitted rivals of an effect
ROUNDS: Final = 4  # most linearizations of all flights
ANY: Final = 30.0  # typical sizes; deviation of a practically flat prior
CLEAR: Final = 3.0  # standard deviations; smaller vector components are not reported


@final
@dataclass(frozen=True, slots=True)
class VerifiedEffects:
    """Verified effects."""

    names: tuple[str, ...]  # of the effects, by decreasing evidence
    costs: Mapping[str, float]  # log evidence lost without each [nats]
    rivals: Mapping[str, tuple[str, ...]]  # equally good replacements of each, the better first
    # Rivals with a dissimilar column: real ambiguities, not equivalents
    unlike: Mapping[str, tuple[str, ...]]
    # All flights with the effects, and without any
    full: JointFit
    bare: JointFit
    # All flights with the effects and flat priors of their sizes. The usual priors serve to
    # compare effects, but would bias the values towards 0.
    measured: JointFit
    steps: tuple[SelectionRound, ...] = ()  # rounds of the search for weak effects on all flights

    def without_effects(self) -> 'VerifiedEffects':
        """Return the same flights with nothing named."""
        return VerifiedEffects((), {}, {}, {}, self.bare, self.bare, self.bare, self.steps)

    def select_components(
        self, parameters: Sequence[FreeParameter], deviations: Array
    ) -> dict[str, tuple[int, ...]]:
        """Return the parameters to report of each name: significant components of vectors."""
        order, mean = [knob.name for knob in parameters], self.measured.fitted.mean
        out = {}
        for name in self.names:
            places = [order.index(one) for one in vector_components(name) if one in order]
            # A component within tolerance and uncertainty is not significant.
            spread = [float(np.hypot(deviations[k], parameters[k].tolerance)) for k in places]
            clear = [
                k
                for k, sigma in zip(places, spread, strict=True)
                if abs(mean[k]) > max(CLEAR * sigma, TRIFLE * parameters[k].typical)
            ]
            out[name] = tuple(clear) or (order.index(name),)
        return out


@final
class EffectVerification:
    """
    Verify effects on all training and confirming flights.

    `flights`: in the order of the pairs of `EffectSearchResult`.
    """

    def __init__(self, nominal: NominalVehicle, flights: Sequence[FlightLinearizer]) -> None:
        self.knobs = flights[0].knobs
        self._order = [knob.name for knob in self.knobs]
        self.fitter = JointFitter(
            nominal, flights, per_flight_variance(self.knobs), wrench_floor(nominal)
        )
        self._sizes: dict[str, float] = {}
        # Prior scales of the components with which each rival does best
        self._rival_sizes: dict[str, dict[str, float]] = {}

    def run(self, named: EffectSearchResult) -> VerifiedEffects:
        """Return the verified effects of a search."""
        bare = self._fit_jointly((), named.bare)
        names, self._sizes = named.names, dict(named.sizes)
        full = self._fit_jointly(names, named.fits) if names else bare
        costs = self._removal_costs(names, full, bare) if names else {}
        while min(costs.values(), default=KEPT) < KEPT:
            weakest = min(costs, key=lambda name: costs[name])
            names = tuple(name for name in names if name != weakest)
            full = self._refit_without(full, weakest, names) if names else bare
            costs = self._removal_costs(names, full, bare)
        rivals: dict[str, tuple[str, ...]] = {}
        unlike: dict[str, tuple[str, ...]] = {}
        for name in names:
            verdict, full, name_now = self._compare_with_rivals(name, names, full)
            if name_now != name:
                names = tuple(name_now if one == name else one for one in names)
                costs[name_now] = costs.pop(name)
            rivals[name_now] = tuple(verdict)
            unlike[name_now] = tuple(one for one, same in verdict.items() if not same)
        more, full = self._add_weak_effects(names, full, len(named.bare[0].group.pieces))
        for step in more:
            if step.named:
                costs[step.named] = step.trials[0].joint_evidence
                rivals[step.named], unlike[step.named] = step.tied, ()
        names = (*names, *(step.named for step in more if step.named))
        ranked = tuple(sorted(names, key=lambda name: -costs[name]))
        measured = self._fit_values(full, ranked) if ranked else full
        return VerifiedEffects(ranked, costs, rivals, unlike, full, bare, measured, more)

    def _add_weak_effects(
        self, names: tuple[str, ...], full: JointFit, teach: int
    ) -> tuple[tuple[SelectionRound, ...], JointFit]:
        """Add effects that are detectable only on all flights together; return the rounds."""
        faint, steps = WeakEffectSearch(self.fitter, teach, self._sizes), []
        last = faint.refit_with_lower_floor(full)
        while last is not None and len(names) < MOST:
            step, last = faint.run_round(names, last)
            steps.append(step)
            if not step.named:
                break
            then = self.fitter.fit_deviations(last.group, last.prior, last.deviations)
            # Its little evidence is no match for a force outside the library on the same axes
            if self._acts_with_rival(step.named, then, teach):
                steps[-1] = replace(step, named='')
                break
            names, full = (*names, step.named), then
        return tuple(steps), full

    def _acts_with_rival(self, name: str, full: JointFit, teach: int) -> bool:
        """Return whether a generic rival is evident on an axis on which an effect acts."""
        floor = self.fitter.floor
        acts = find_acting_axes(full.group.linears[0], name, floor)
        if not acts.any():
            return False
        sides = slice(0, teach), slice(teach, None)
        rivals = RivalSearch([self.fitter.flights[side] for side in sides]).rank_rivals(
            [FitBaseline.from_part(full, side, floor) for side in sides]
        )
        axes = {axis for one in select_evident_rivals(rivals) for axis in one.axes}
        return any(axis in axes for axis, here in zip(AXES, acts, strict=True) if here)

    def _fit_values(self, full: JointFit, names: Sequence[str]) -> JointFit:
        """Fit the effects with flat priors of their sizes."""
        covariance = full.prior.covariance.copy()
        for k in self._component_indices(names):
            covariance[k, k] += (ANY * self.knobs[k].typical) ** 2
        prior = Prior(full.prior.mean, covariance)
        return self.fitter.fit(prior, full.group, full.deviations, ROUNDS)

    def _fit_jointly(self, names: Sequence[str], pair: Pair) -> JointFit:
        """Fit all flights together, starting from the side that fits better."""
        joined = pair[0].group.combine_groups(pair[1].group)
        deviations = np.sqrt(pair[0].deviations * pair[1].deviations)
        prior = build_shared_prior(self.knobs, names, self._sizes)
        groups = [replace(joined, at=side.group.at) for side in pair]
        begin = min(groups, key=lambda group: self.fitter.compute_misfit(prior, group, deviations))
        return self.fitter.fit(prior, begin, deviations, ROUNDS)

    def _remove_effect(self, last: JointFit, name: str, names: Sequence[str]) -> JointFit:
        """Set one effect to 0 in the linearized flights, with the prior of other effects."""
        at = last.group.at.copy()
        at[self._component_indices([name])] = 0.0
        prior = build_shared_prior(self.knobs, names, self._sizes)
        return self.fitter.fit_deviations(replace(last.group, at=at), prior, last.deviations)

    def _component_indices(self, names: Sequence[str]) -> list[int]:
        """Return the indices of the effects' components."""
        components = expand_vectors(names)
        return [k for k, name in enumerate(self._order) if name in components]

    def _refit_without(self, last: JointFit, name: str, names: Sequence[str]) -> JointFit:
        """Refit all flights without one effect."""
        begun = self._remove_effect(last, name, names)
        return self.fitter.fit(begun.prior, begun.group, begun.deviations, ROUNDS)

    def _removal_costs(
        self, names: Sequence[str], full: JointFit, bare: JointFit
    ) -> dict[str, float]:
        """Return the cost of removing each effect."""
        out = {}
        for name in names:
            rest = tuple(one for one in names if one != name)
            if rest:
                cost = full.evidence - self._remove_effect(full, name, rest).evidence
                if cost < CERTAIN:
                    cost = full.evidence - self._refit_without(full, name, rest).evidence
            else:
                cost = full.evidence - bare.evidence
            out[name] = min(cost, self._cost_within_tolerance(name, rest, full))
        return out

    def _cost_within_tolerance(self, name: str, rest: Sequence[str], full: JointFit) -> float:
        """Return the linearized cost of an effect if its tolerance is larger than assumed."""
        places = self._component_indices([name])
        prior = build_shared_prior(self.knobs, rest, self._sizes)
        # All flights share the error of the vehicle file, so it counts once, not on each side
        if not np.any(np.diag(prior.covariance)[places] > 0.0):
            return np.inf
        at = full.group.at.copy()
        at[places] = 0.0
        group, wider = replace(full.group, at=at), widen_tolerance(prior, places)
        without = self.fitter.fit_deviations(group, wider, full.deviations).evidence
        return full.evidence - without + float(np.log(2.0))

    def _compare_with_rivals(
        self, name: str, names: Sequence[str], full: JointFit
    ) -> tuple[dict[str, bool], JointFit, str]:
        """Return the rivals of an effect with their similarity, the best fit, and its effect."""
        near = self._find_near_rivals(name, names, full)
        gains: dict[str, tuple[float, bool]] = {}
        best, then, most = name, full, full.evidence
        refits = 0
        for other, (linear, alike) in near.items():
            evidence = linear
            # A similar candidate is refitted only if its linearized evidence is higher.
            if (not alike or linear > most + TIE) and refits < RIVALS:
                instead = tuple(other if one == name else one for one in names)
                self._sizes.update(self._rival_sizes.get(other, {}))
                fitted, refits = self._refit_without(full, name, instead), refits + 1
                evidence = fitted.evidence + vector_cost(name) - vector_cost(other)
                if evidence > most + TIE:
                    best, then, most = other, fitted, evidence
            gains[other] = evidence, alike
        if best != name:
            gains[name] = full.evidence, gains.pop(best)[1]
        close = [one for one in gains if most - gains[one][0] < TIE]
        close.sort(key=lambda one: -gains[one][0])
        return {one: gains[one][1] for one in close}, then, best

    def _find_near_rivals(
        self, name: str, names: Sequence[str], full: JointFit
    ) -> dict[str, tuple[float, bool]]:
        """Return the linearized evidence of candidate replacements, and their similarity."""
        taken = expand_vectors(names)
        others = [
            knob.name for knob in self.knobs if knob.typical > 0.0 and knob.name not in taken
        ]
        cosine = column_cosines(full.reduced, full.prior, [name, *others], self.knobs)[0]
        near = {}
        for other, alike in zip(others, np.abs(cosine[1:]), strict=True):
            if np.isfinite(alike) and alike > 0.3:
                lost = full.evidence - self._linear_rival_evidence(name, other, names, full)
                if lost < NEAR:
                    near[other] = full.evidence - lost, bool(alike > ALIKE)
        return dict(sorted(near.items(), key=lambda one: -one[1][0]))

    def _linear_rival_evidence(
        self, name: str, other: str, names: Sequence[str], full: JointFit
    ) -> float:
        """Return the linearized evidence of a rival in place of an effect, each at its cost."""
        instead = tuple(other if one == name else one for one in names)
        before, best = self._sizes, -np.inf
        for sizes in list_component_sizes(other):
            self._sizes = {**before, **sizes}
            evidence = self._remove_effect(full, name, instead).evidence
            if evidence > best:
                best, self._rival_sizes[other] = evidence, sizes
        self._sizes = before
        return best + vector_cost(name) - vector_cost(other)
