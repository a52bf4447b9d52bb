# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find what a vehicle file lacks: fit, linearize, search, and again about what was found.

All flights are linearized about a fit of the most probable model so far. On that linear model
every other one is compared (`ModelSearch`). The best of them is fitted, with the noise learned
beside it, and takes the place of the first if the flights then are more probable. What a name
gains is judged in the same way: against a fit of the best model without it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import DELAY_WITH_LAG, FreeParameter
from lta_discovery.parallel import map_parallel
from lta_discovery.posterior.elements import (
    compute_variance,
    Element,
    ElementChoice,
    ForceGroup,
    list_elements,
    NO_ELEMENTS,
)
from lta_discovery.posterior.force_columns import build_scene, compute_wrenches
from lta_discovery.posterior.model_search import (
    LinearEvidence,
    log_prior,
    ModelSearch,
    ScoredModel,
)
from lta_discovery.settings import (
    ALIKE,
    CAPPED_NOISE_FLOORS,
    CERTAIN,
    LEAST_GAIN,
    MOST_SEARCH_STEPS,
    NEGLIGIBLE,
    UNEXPLAINED,
)
from lta_discovery.state_filter.kalman import filter_flight, FilteredFlight
from lta_discovery.state_filter.likelihood import linearize_all, ParameterPrior
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_fit import log_prior_of_noise
from lta_discovery.state_filter.noise_model import NoiseModel, wrench_floor
from lta_discovery.state_filter.parameter_fit import fit_likelihood, smooth_systems
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LINEARIZATIONS: Final = 10  # most of a fit
LEARNING: Final = (0,)  # a fit learns the noise once
EVEN: Final = 1.01  # of a wrench; a cap that it exceeds by less changes nothing
SMALLEST_SINGULAR: Final = 1e-9  # of the largest singular value of columns that move together
SENSOR_EFFECTS: Final = ('gyro_', 'imu_', 'range_', 'pressure_')  # idle without these sensors


@final
@dataclass(frozen=True, slots=True)
class PresentElement:
    """Something that the flights show to be present: one element, or one of a class."""

    # Effects before numbers, the most probable first; the others cannot be told from it
    names: tuple[str, ...]
    kind: str
    probability: float  # that one of them is present
    # By which the best model without them is less probable [nats]; divided by the square of
    # `ParameterFit.excess`, but for a force
    gain: float


@final
class FoundModel(NamedTuple):
    """A fitted model, and what of it the flights show to be present."""

    present: tuple[PresentElement, ...]  # the most decisive first
    values: Array  # of the parameters, relative to the vehicle file, shape (K,)
    covariance: Array  # shape (K, K)
    noise: tuple[NoiseModel, ...]  # of each flight, beside this model
    wrenches: tuple[Array, ...]  # that it leaves unexplained, each (n, 6) [N, N m]


@final
@dataclass(frozen=True, slots=True)
class MissingElements:
    """What the flights tell of the elements that a vehicle file may lack."""

    found: FoundModel  # the best model; of its elements, forces alone are present if any is
    bare: FoundModel  # the same without any element: within the tolerances of the file
    closest: FoundModel | None  # where forces are present, the best model that has none
    probabilities: Mapping[str, float]  # of each element that any good model has
    parameters: tuple[FreeParameter, ...]  # shared ones, and those of each flight
    trust: float  # factor on the tolerances of the file
    models: tuple[ScoredModel, ...]  # the most probable first
    elements: tuple[Element, ...]


def list_flight_unknowns(
    parameters: Sequence[FreeParameter], only_pose: bool
) -> list[FreeParameter]:
    """
    Return the parameters that all flights share, followed by those of each flight.

    What differs between flights may have a mean, too, which is a candidate. `only_pose`: whether
    no flight has other sensors than a tracker.
    """
    acting = [one for one in parameters if not (only_pose and one.name.startswith(SENSOR_EFFECTS))]
    shared = [
        replace(one, tolerance=0.0, per_flight=False) if one.per_flight else one for one in acting
    ]
    return [*shared, *(replace(one, typical=0.0) for one in acting if one.per_flight)]


@final
class _FittedModel(NamedTuple):
    """A model fitted to all flights, and the flights linearized about the fit."""

    scored: ScoredModel  # with its posterior about the fit itself
    values: Array  # relative to the vehicle file, shape (K,)
    covariance: Array  # shape (K, K)
    excess: Array  # as in `ParameterFit`, shape (K,)
    noise: Sequence[NoiseModel]  # of each flight
    systems: Sequence[FlightSystem]

    @property
    def log_posterior(self) -> float:
        """Log density of model and readings, without a constant [nats]."""
        return self.scored.log_posterior


@final
class MissingElementSearch:
    """
    Search the flights of a vehicle for what its file lacks.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle of the file.
    flights : sequence of MeasuredFlight
        All flights to learn from.
    parameters : sequence of FreeParameter
        What may differ from the file: `list_free_parameters`.

    """

    def __init__(
        self,
        vehicle: Vehicle,
        flights: Sequence[MeasuredFlight],
        parameters: Sequence[FreeParameter],
    ) -> None:
        self._nominal = NominalVehicle.from_vehicle(vehicle)
        self._floor = wrench_floor(self._nominal)
        only_pose = all(one.has_only_pose for one in flights)
        self.parameters = list_flight_unknowns(parameters, only_pose)
        self._begin = _FittedModel(
            ScoredModel(NO_ELEMENTS, -math.inf, 1.0),
            np.zeros(len(self.parameters)),
            np.zeros((len(self.parameters), len(self.parameters))),
            np.ones(len(self.parameters)),
            [NoiseModel.guess(self._nominal, one) for one in flights],
            [FlightSystem(vehicle, one, self.parameters) for one in flights],
        )
        self._with_forces = True
        self._fits = list[ScoredModel]()
        self._elements = list_elements(self.parameters, ())
        self._wrenches = [np.zeros((len(one.time), 6, 0)) for one in flights]

    def run(self, tell: Callable[[float], None] = lambda part: None) -> MissingElements:
        """Search, and report an estimate of the progress."""
        # Once more about the motion that the first fit shows
        rough = self._fit(self._begin, self._begin.scored)
        bare = self._fit(rough, rough.scored)
        best, search, ranked = self._climb(bare, tell)
        shares, elements = _sum_shares(ranked), search.elements
        main = self._conclude(best, search, ranked)
        closest = None
        forces = tuple(one for one in main.present if one.kind == 'force')
        if forces:
            # Terms only resemble the form of an unknown force; what they leave is explained by
            # effects that are not there. So beside a force no name is sure
            main = main._replace(present=forces)
            self._with_forces = False
            closest = self._conclude(*self._climb(bare, lambda part: None))
        tell(1.0)
        return MissingElements(
            main,
            _describe_fit(bare, ()),
            closest,
            {elements[k].name: shares[k] for k in sorted(shares, key=lambda k: -shares[k])},
            tuple(self.parameters),
            ranked[0].trust,
            tuple(ranked),
            tuple(elements),
        )

    def _climb(
        self, best: '_FittedModel', tell: Callable[[float], None]
    ) -> tuple['_FittedModel', ModelSearch, list[ScoredModel]]:
        """Return the best model from one on, with the last search and its ranking."""
        self._fits = [best.scored]
        for number in range(MOST_SEARCH_STEPS):
            tell(1.0 - 0.8 ** (number + 1))
            search = self._look(best, best.noise)
            ranked = search.run(best.scored.model)
            better = self._find_better(best, ranked[0])
            if better is None:
                break
            best = better
        first = next(one for one in ranked if one.elements == best.scored.elements)
        # Models that are more probable were refuted when they were fitted
        return self._settle(best), search, ranked[ranked.index(first) :]

    def _settle(self, best: '_FittedModel') -> '_FittedModel':
        """
        Return a fit again, from the numbers of the file for what is within its tolerance.

        What can be scaled together without changing the motion (masses, thrust, drag) drifts in
        steps from one model to the next.
        """
        inside = {k for one in best.scored.elements for k in self._elements[one].columns}
        own = [k in inside for k in range(len(best.values))]
        again = self._try_to_fit(
            best._replace(values=np.where(own, best.values, 0.0)), best.scored
        )
        return best if again is None or again.log_posterior < best.log_posterior else again

    def _find_better(self, best: '_FittedModel', first: ScoredModel) -> '_FittedModel | None':
        """
        Return a fitted model that is more probable than the best one so far, or None.

        `first`: the model to try first.
        """
        tried = {(best.scored.elements, math.inf)}
        for floors in (math.inf, *CAPPED_NOISE_FLOORS):
            most = floors * self._floor
            one, begin = first, best
            if floors < math.inf:
                if all(bool(np.all(each.wrench <= EVEN * most)) for each in best.noise):
                    continue
                # What is missing raises the unexplained wrench, which then hides it: from a lower
                # one, the fit learns whether the rest asks for more
                begin = best._replace(
                    noise=[
                        replace(each, wrench=np.minimum(each.wrench, most)) for each in best.noise
                    ]
                )
                one = self._look(best, begin.noise).run(best.scored.model)[0]
            # The same model from a lower wrench is worth a fit only where nothing explains much
            is_same = one.elements == best.scored.elements
            if (one.elements, floors) in tried or (is_same and floors < UNEXPLAINED):
                continue
            tried.add((one.elements, floors))
            after = self._try_to_fit(begin, one)
            if after is not None and after.log_posterior > best.log_posterior:
                return after
        return None

    def _try_to_fit(self, begin: '_FittedModel', one: ScoredModel) -> '_FittedModel | None':
        """Fit a model; None if the vehicle becomes impossible on the way."""
        try:
            fit = self._fit(begin, one)
        except BadInput:
            return None
        self._fits.append(fit.scored)
        return fit

    def _fit(self, begin: '_FittedModel', one: ScoredModel) -> '_FittedModel':
        """Fit a model, from another one that is fitted."""
        count = len(self.parameters)
        parameters = self._list_parameters_about(begin.values)
        tolerance = np.array([each.tolerance for each in parameters])
        own = np.array([each.per_flight for each in self.parameters])
        tolerance[~own] *= one.trust
        tolerance = np.append(tolerance, np.zeros(self._wrenches[0].shape[2]))
        deviation = np.sqrt(compute_variance(self._elements, one.model, tolerance))
        free = np.flatnonzero(deviation[:count] > 0.0)
        acting = np.flatnonzero(deviation[count:] > 0.0)
        parameters = [replace(self.parameters[k], tolerance=deviation[k]) for k in free]
        terms = [_build_term(int(k), float(deviation[count + k])) for k in acting]
        systems = [
            system.with_parameters(parameters).with_terms(terms, wrenches[..., acting])
            for system, wrenches in zip(begin.systems, self._wrenches, strict=True)
        ]
        start = np.append(begin.values[free], np.zeros(len(acting)))
        fit = fit_likelihood(
            systems, self._nominal, start, begin.noise, LINEARIZATIONS, LEARNING, is_near=True
        )
        values, covariance, excess = np.zeros(count), np.zeros((count, count)), np.ones(count)
        values[free] = np.where(own[free], 0.0, fit.values[: len(free)])
        covariance[np.ix_(free, free)] = fit.covariance[: len(free), : len(free)]
        excess[free] = fit.excess[: len(free)]
        strengths = fit.values[len(free) :]
        forces = [wrenches[..., acting] @ strengths for wrenches in self._wrenches]
        score = fit.evidence + log_prior_of_noise(fit.noise, self._nominal)
        score += log_prior(self._elements, one.model, one.trust)
        return _FittedModel(
            replace(one, log_posterior=score),
            values,
            covariance,
            excess,
            fit.noise,
            smooth_systems(begin.systems, fit, forces),
        )

    def _list_parameters_about(self, values: Array) -> list[FreeParameter]:
        """Return the parameters with their tolerances about some values."""
        at = {one.name: k for k, one in enumerate(self.parameters) if not one.per_flight}
        lag, delay = at.get('motor_lag'), at.get('command_delay.delay')
        out = list(self.parameters)
        if lag is not None and delay is not None:
            # The stages of another lag are unknown
            more = DELAY_WITH_LAG * abs(float(values[lag]))
            out[delay] = replace(out[delay], tolerance=math.hypot(out[delay].tolerance, more))
        return out

    def _look(self, about: '_FittedModel', noise: Sequence[NoiseModel]) -> ModelSearch:
        """Linearize the flights with all columns, and return a search among the models."""
        flights = linearize_all(about.systems, self._nominal, about.values)
        scene = build_scene(flights)

        def filter_with_forces(k: int) -> tuple[list[ForceGroup], Array, FilteredFlight]:
            # The columns of all forces need much memory, so they are not kept
            if not self._with_forces:
                none = np.zeros((len(flights[k].motion), 6, 0))
                return [], none, filter_flight(flights[k], noise[k])
            groups, wrenches = compute_wrenches(about.systems[k], flights[k], scene, self._floor)
            whole = flights[k].add_wrenches(wrenches, np.zeros(wrenches.shape[2]))
            return groups, wrenches, filter_flight(whole, noise[k])

        looks = map_parallel(filter_with_forces, range(len(flights)))
        self._wrenches = [one[1] for one in looks]
        self._elements = list_elements(self.parameters, looks[0][0])
        none = np.zeros(self._wrenches[0].shape[2])
        parameters = self._list_parameters_about(about.values)
        own = ParameterPrior(
            np.array([*(one.tolerance for one in parameters), *none]),
            none,
            none,
            np.array([*(one.per_flight for one in parameters), *(none > 0.0)]),
        )
        values = np.append(about.values, none)
        evidence = LinearEvidence.of([one[2] for one in looks], noise, own, values, self._nominal)
        return ModelSearch(parameters, self._elements, evidence)

    def _conclude(
        self, final: '_FittedModel', search: ModelSearch, ranked: Sequence[ScoredModel]
    ) -> FoundModel:
        """Return what a fitted model and those beside it, the best first, tell together."""
        best, weights, shares = ranked[0], _weigh(ranked), _sum_shares(ranked)
        present, named = [], best
        for choice in best.model:
            names = [choice.element, *_list_alike(search, best, choice)]
            among = [not one.elements.isdisjoint(names) for one in ranked]
            probability = float(weights[among].sum())
            if probability < CERTAIN or self._is_negligible(choice, final.values):
                continue
            rival = next(one for one, some in zip(ranked, among, strict=True) if not some)
            self._try_to_fit(final, rival)
            gain = final.log_posterior - max(
                one.log_posterior for one in self._fits if one.elements.isdisjoint(names)
            )
            element = self._elements[choice.element]
            if element.kind != 'force':
                # Pieces of the flights that disagree more than noise does tell less of an effect,
                # as under a quasi-likelihood (Wedderburn, Biometrika 61, 1974)
                gain /= float(np.max(final.excess[list(element.columns)])) ** 2
            if gain < LEAST_GAIN:
                named = search.score(named.model - {choice}, named.trust)
                continue
            names.sort(key=lambda k: (self._elements[k].kind, -shares.get(k, 0.0)))
            titles = tuple(self._elements[k].name for k in names)
            kind = self._elements[names[0]].kind
            present.append(PresentElement(titles, kind, probability, gain))
            if names[0] != choice.element:
                named = search.exchange(named, choice, names[0])
        if named is not best:
            # The values are those of what is named
            final = self._try_to_fit(final, named) or final
        return _describe_fit(final, sorted(present, key=lambda one: -one.gain))

    def _is_negligible(self, choice: ElementChoice, values: Array) -> bool:
        """Return whether an effect is too small to be told from an error of the model."""
        one = self._elements[choice.element]
        size = np.abs(values[list(one.columns)]) if one.kind == 'effect' else math.inf
        return bool(np.all(size < NEGLIGIBLE * np.array(one.unit)))


def _describe_fit(fit: _FittedModel, present: Sequence[PresentElement]) -> FoundModel:
    """Return a fitted model with what of it is present."""
    wrenches = tuple(one.wrench for one in fit.systems)
    return FoundModel(tuple(present), fit.values, fit.covariance, tuple(fit.noise), wrenches)


def _weigh(ranked: Sequence[ScoredModel]) -> Array:
    """Return the probability of each model among some, the most probable first."""
    odds = np.exp([one.log_posterior - ranked[0].log_posterior for one in ranked])
    weights: Array = odds / odds.sum()
    return weights


def _sum_shares(ranked: Sequence[ScoredModel]) -> dict[int, float]:
    """Return the probability of each element that a model has, by its index."""
    shares = dict[int, float]()
    for one, weight in zip(ranked, _weigh(ranked), strict=True):
        for k in one.elements:
            shares[k] = shares.get(k, 0.0) + float(weight)
    return shares


def _build_term(k: int, deviation: float) -> FreeParameter:
    """Return the strength of a term of a force."""
    return FreeParameter(f'term.{k}', '1', {}, 1.0, 1.0, deviation)


def _list_alike(search: ModelSearch, best: ScoredModel, choice: ElementChoice) -> list[int]:
    """
    Return the effects that do the same as an element of a model, beside the rest of it.

    That is where columns of the effect follow what the element does, as far as the rest of the
    model cannot.
    """
    elements, columns = search.elements, list(search.elements[choice.element].columns)
    if elements[choice.element].kind == 'force':
        return []
    whole = search.restrict(best)
    direction = whole.posterior()[0][np.searchsorted(whole.free, columns)]
    rest = search.restrict(replace(best, model=best.model - {choice}))
    information, across = rest.whole.information, rest.compute_remainder()[1]
    own = information[np.ix_(columns, columns)] - across[:, columns].T @ across[:, columns]
    size = float(direction @ own @ direction)
    out = []
    for k, one in enumerate(elements):
        if one.kind == 'force' or k in best.elements:
            continue
        others = list(one.columns)
        inner = information[np.ix_(others, others)] - across[:, others].T @ across[:, others]
        both = information[np.ix_(others, columns)] - across[:, others].T @ across[:, columns]
        both = both @ direction
        # A column that does nothing follows nothing
        follows = float(both @ np.linalg.lstsq(inner, both, rcond=SMALLEST_SINGULAR)[0])
        if math.sqrt(max(follows, 0.0)) > ALIKE * math.sqrt(size):
            out.append(k)
    return out
