"""
What is named, put to the test on all flights together.

Each effect is removed and everything else refitted: what that costs is its evidence. And each is
replaced by every other candidate: one that does as well is what these flights cannot tell from it,
and one that does better takes its place.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, Prior, wrench_floor
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.model.candidates import expand_vectors, vector_components
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.linearizer import FlightLinearizer
from lta_discovery.selection.acceptance import LARGER, TIE, TRIFLE
from lta_discovery.selection.candidate_scan import column_cosines
from lta_discovery.selection.effect_search import EffectSearchResult, MOST, Pair, SelectionRound
from lta_discovery.selection.weak_effects import WeakEffectSearch
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Nats that removing an effect has to cost. Fewer than each earns its name by: what hides in a
# tolerance that all flights share is won on each by itself, and cannot be won twice.
KEPT: Final = LARGER
CERTAIN: Final = 60.0  # nats; what is so much worse about the old point needs no refit
NEAR: Final = 15.0  # nats; nor is a rival refitted that is so much worse
ALIKE: Final = 0.9  # of the cosine of two columns; beyond it they are two words for one thing
RIVALS: Final = 2  # refitted for each effect
ROUNDS: Final = 4  # linearisations of all flights together
ANY: Final = 30.0  # typical sizes: as good as any
CLEAR: Final = 3.0  # deviations; a component of a vector within them is not told


@final
@dataclass(frozen=True, slots=True)
class VerifiedEffects:
    """
    What stands.

    Attributes
    ----------
    names : tuple of str
        Of the effects, the dearest first.
    costs : mapping of str to float
        Log evidence that removing each costs. [nats]
    rivals : mapping of str to tuple of str
        What could stand in the place of each, the better first.
    unlike : mapping of str to tuple of str
        Those of them that do not even look like it: an open question, not another word for it.
    full, bare : Joint
        All flights with the effects, and without any.
    measured : Joint
        All flights with the effects, of whose sizes nothing is taken to be known beforehand: a
        usual size is good for telling effects apart, and would pull a value towards 0.
    steps : tuple of Step
        Rounds in which fainter effects were looked for, on all flights together.

    """

    names: tuple[str, ...]
    costs: Mapping[str, float]
    rivals: Mapping[str, tuple[str, ...]]
    unlike: Mapping[str, tuple[str, ...]]
    full: JointFit
    bare: JointFit
    measured: JointFit
    steps: tuple[SelectionRound, ...] = ()

    def select_components(
        self, parameters: Sequence[FreeParameter], deviations: Array
    ) -> dict[str, tuple[int, ...]]:
        """
        Return which knobs are told of each name: of a vector, the components that stand out.

        Parameters
        ----------
        known : sequence of Knob
            All.
        deviations : ndarray, shape (G,)
            Of what was measured.

        """
        order, mean = [knob.name for knob in parameters], self.measured.fitted.mean
        out = {}
        for name in self.names:
            places = [order.index(one) for one in vector_components(name) if one in order]
            # A component that is off by no more than vehicles are is no part of what is missing.
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
    All flights that teach or confirm.

    Parameters
    ----------
    nominal : Nominal
        The vehicle as its file has it.
    flights : sequence of Linearised
        In the order of the pairs of `EffectSearchResult`.

    """

    def __init__(self, nominal: NominalVehicle, flights: Sequence[FlightLinearizer]) -> None:
        self.knobs = flights[0].knobs
        self._order = [knob.name for knob in self.knobs]
        self.fitter = JointFitter(
            nominal, flights, per_flight_variance(self.knobs), wrench_floor(nominal)
        )
        self._sizes: dict[str, float] = {}

    def run(self, named: EffectSearchResult) -> VerifiedEffects:
        """Return what stands of what was named."""
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
            found, full, name_now = self._swap_effect(name, names, full)
            if name_now != name:
                names = tuple(name_now if one == name else one for one in names)
                costs[name_now] = costs.pop(name)
            rivals[name_now] = tuple(found)
            unlike[name_now] = tuple(one for one, same in found.items() if not same)
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
        """Add effects that only all flights together show; return the rounds."""
        faint, steps = WeakEffectSearch(self.fitter, teach, self._sizes), []
        last = faint.fit_lower_floor(full)
        while last is not None and len(names) < MOST:
            step, last = faint.run_round(names, last)
            steps.append(step)
            if not step.named:
                break
            names = (*names, step.named)
        if last is not None and any(step.named for step in steps):
            full = self.fitter.fit_deviations(last.group, last.prior, last.deviations)
        return tuple(steps), full

    def _fit_values(self, full: JointFit, names: Sequence[str]) -> JointFit:
        """Fit the effects without a word on how large they usually are."""
        covariance = full.prior.covariance.copy()
        for k in self._component_indices(names):
            covariance[k, k] += (ANY * self.knobs[k].typical) ** 2
        prior = Prior(full.prior.mean, covariance)
        return self.fitter.fit(prior, full.group, full.deviations, ROUNDS)

    def _fit_jointly(self, names: Sequence[str], pair: Pair) -> JointFit:
        """Fit all flights together, from where one of the sides stands, whichever fits better."""
        joined = pair[0].group.join(pair[1].group)
        deviations = np.sqrt(pair[0].deviations * pair[1].deviations)
        prior = build_shared_prior(self.knobs, names, self._sizes)
        groups = [replace(joined, at=side.group.at) for side in pair]
        begin = min(groups, key=lambda group: self.fitter.compute_misfit(prior, group, deviations))
        return self.fitter.fit(prior, begin, deviations, ROUNDS)

    def _remove_effect(self, last: JointFit, name: str, names: Sequence[str]) -> JointFit:
        """Return all flights with other effects, one of them back at 0, as linear as they are."""
        at = last.group.at.copy()
        at[self._component_indices([name])] = 0.0
        prior = build_shared_prior(self.knobs, names, self._sizes)
        return self.fitter.fit_deviations(replace(last.group, at=at), prior, last.deviations)

    def _component_indices(self, names: Sequence[str]) -> list[int]:
        """Return which knobs are the components of some effects."""
        wanted = expand_vectors(names)
        return [k for k, name in enumerate(self._order) if name in wanted]

    def _refit_without(self, last: JointFit, name: str, names: Sequence[str]) -> JointFit:
        """Return the same, refitted."""
        begun = self._remove_effect(last, name, names)
        return self.fitter.fit(begun.prior, begun.group, begun.deviations, ROUNDS)

    def _removal_costs(
        self, names: Sequence[str], full: JointFit, bare: JointFit
    ) -> dict[str, float]:
        """Return what removing each costs."""
        if len(names) == 1:
            return {names[0]: full.evidence - bare.evidence}
        out = {}
        for name in names:
            rest = tuple(one for one in names if one != name)
            cost = full.evidence - self._remove_effect(full, name, rest).evidence
            if cost < CERTAIN:
                cost = full.evidence - self._refit_without(full, name, rest).evidence
            out[name] = cost
        return out

    def _swap_effect(
        self, name: str, names: Sequence[str], full: JointFit
    ) -> tuple[dict[str, bool], JointFit, str]:
        """Return what does as well as an effect and whether it looks like it, and the better."""
        near = self._find_near_rivals(name, names, full)
        found: dict[str, tuple[float, bool]] = {}
        best, then = name, full
        refits = 0
        for other, (linear, alike) in near.items():
            evidence = linear
            # What looks alike is refitted only where it promises to be the better word.
            if (not alike or linear > then.evidence + TIE) and refits < RIVALS:
                instead = tuple(other if one == name else one for one in names)
                fitted, refits = self._refit_without(full, name, instead), refits + 1
                evidence = fitted.evidence
                if evidence > then.evidence + TIE:
                    best, then = other, fitted
            found[other] = evidence, alike
        if best != name:
            found[name] = full.evidence, found.pop(best)[1]
        close = [one for one in found if then.evidence - found[one][0] < TIE]
        close.sort(key=lambda one: -found[one][0])
        return {one: found[one][1] for one in close}, then, best

    def _find_near_rivals(
        self, name: str, names: Sequence[str], full: JointFit
    ) -> dict[str, tuple[float, bool]]:
        """Return what could do as well in a linear world: its evidence, and its likeness."""
        taken = expand_vectors(names)
        others = [
            knob.name for knob in self.knobs if knob.typical > 0.0 and knob.name not in taken
        ]
        cosine = column_cosines(full.reduced, full.prior, [name, *others], self.knobs)[0]
        near = {}
        for other, alike in zip(others, np.abs(cosine[1:]), strict=True):
            if np.isfinite(alike) and alike > 0.3:
                instead = tuple(other if one == name else one for one in names)
                lost = full.evidence - self._remove_effect(full, name, instead).evidence
                if lost < NEAR:
                    near[other] = full.evidence - lost, bool(alike > ALIKE)
        return dict(sorted(near.items(), key=lambda one: -one[1][0]))
