# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Search the models of some flights for the most probable ones.

A model is a set of elements, each with one of its sizes, and how far the file is trusted. What the
flights tell of all unknowns is a quadratic form, of which each model takes a part: of normal
unknowns x with variances v, and readings whose log density is c + b x - x A x / 2, the evidence is
c + b (A + 1/v)^-1 b / 2 - log det(1 + v A) / 2.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.posterior.elements import (
    compute_variance,
    Element,
    ElementChoice,
    Model,
    NO_ELEMENTS,
)
from lta_discovery.settings import (
    ADDED,
    BEAM_WIDTH,
    GROWTH,
    HOPELESS,
    LARGEST_MODEL,
    MOST_SWAPS,
    TRUST,
)
from lta_discovery.state_filter.kalman import FilteredFlight
from lta_discovery.state_filter.likelihood import eliminate_own, ParameterPrior
from lta_discovery.state_filter.noise_fit import log_prior_of_noise
from lta_discovery.state_filter.noise_model import NoiseModel
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.stats import norm

Array = NDArray[np.float64]

TINY: Final = 1e-12  # least probability of values within their bounds


@final
@dataclass(frozen=True, slots=True)
class LinearEvidence:
    """What all flights tell of K unknowns under one assumption about the noise."""

    information: Array  # A, shape (K, K)
    pull: Array  # b, of the unknowns themselves, not of their change; shape (K,)
    constant: float  # c [nats]

    @classmethod
    def of(
        cls,
        filtered: Sequence[FilteredFlight],
        noise: Sequence[NoiseModel],
        own: ParameterPrior,
        values: Array,
        nominal: NominalVehicle,
    ) -> 'LinearEvidence':
        """
        Return the evidence of filtered flights without what each has of its own.

        `values`: about which they are linearized, shape (K,).
        """
        information, pull = np.zeros((len(values), len(values))), np.zeros(len(values))
        constant = log_prior_of_noise(noise, nominal)
        for one in filtered:
            products, more = eliminate_own(one.products, own)
            information += products[:-1, :-1]
            pull -= products[:-1, -1]
            constant += more - 0.5 * one.log_determinant - 0.5 * float(products[-1, -1])
        constant -= float(pull @ values) + 0.5 * float(values @ information @ values)
        return cls(information, pull + information @ values, constant)

    def restrict(self, variance: Array) -> 'RestrictedEvidence':
        """Return the evidence of a model; unknowns of variance 0 are absent, shape (K,)."""
        free = np.flatnonzero(variance > 0.0)
        root = np.sqrt(variance[free])
        inner = self.information[np.ix_(free, free)] * np.outer(root, root)
        lower = np.linalg.cholesky(inner + np.eye(len(free)))
        white = solve_triangular(lower, self.pull[free] * root, lower=True, check_finite=False)
        log_evidence = self.constant + 0.5 * float(white @ white)
        log_evidence -= float(np.sum(np.log(np.diag(lower))))
        return RestrictedEvidence(log_evidence, self, free, root, lower, white)


@final
class RestrictedEvidence(NamedTuple):
    """The evidence of a model, and what follows of it."""

    log_evidence: float  # [nats]
    whole: LinearEvidence
    free: NDArray[np.int64]  # unknowns of the model, shape (F,)
    root: Array  # their standard deviations before the flights, shape (F,)
    lower: Array  # Cholesky factor of 1 + v A, shape (F, F)
    white: Array  # shape (F,)

    def posterior(self) -> tuple[Array, Array]:
        """Return mean and covariance of the unknowns of the model, shape (F,), (F, F)."""
        inverse = solve_triangular(self.lower, np.diag(self.root), lower=True, check_finite=False)
        return inverse.T @ self.white, inverse.T @ inverse

    def compute_remainder(self) -> tuple[Array, Array]:
        """
        Return what is left for other unknowns beside the model.

        The pull of each, shape (K,), and the columns whose products, subtracted from those of the
        information, leave that of the others, shape (F, K).
        """
        rows = self.whole.information[self.free] * self.root[:, None]
        across = solve_triangular(self.lower, rows, lower=True, check_finite=False)
        return self.whole.pull - self.white @ across, across


@final
@dataclass(frozen=True, slots=True)
class ScoredModel:
    """A model with its posterior."""

    model: Model
    log_posterior: float  # without a constant [nats]
    trust: float  # most probable factor on the tolerances of the file

    @property
    def elements(self) -> frozenset[int]:
        """Return the elements, whatever their sizes."""
        return frozenset(one.element for one in self.model)


@final
class ModelSearch:
    """
    Search for the most probable models.

    Parameters
    ----------
    parameters : sequence of FreeParameter
        Of the first columns; the others are those of forces.
    elements : sequence of Element
        What a model may contain.
    evidence : LinearEvidence
        Of all flights.

    """

    def __init__(
        self,
        parameters: Sequence[FreeParameter],
        elements: Sequence[Element],
        evidence: LinearEvidence,
    ) -> None:
        self.elements, self.evidence = elements, evidence
        more = len(evidence.pull) - len(parameters)
        shared = [0.0 if one.per_flight else one.tolerance for one in parameters]
        self._tolerance = np.array([*shared, *[0.0] * more])
        self._low = np.array([*(one.low for one in parameters), *[-math.inf] * more])
        self._high = np.array([*(one.high for one in parameters), *[math.inf] * more])
        self._scored: dict[Model, ScoredModel] = {}
        self._best = -math.inf
        self._largest = LARGEST_MODEL

    def run(self, begin: Model = NO_ELEMENTS) -> list[ScoredModel]:
        """
        Return all models that were looked at, the most probable first.

        None has more than `GROWTH` elements beyond those of the model to begin with.
        """
        self._largest = min(len(begin) + GROWTH, LARGEST_MODEL)
        self.score(NO_ELEMENTS)
        self.score(begin)
        extended, exchanged = set[Model](), set[Model]()
        while True:
            ranked = sorted(self._scored.values(), key=lambda one: -one.log_posterior)
            # Of the models that differ in sizes only, the best is extended
            best = dict[frozenset[int], ScoredModel]()
            for one in ranked:
                best.setdefault(one.elements, one)
            ahead = [one for one in list(best.values())[:BEAM_WIDTH] if one.model not in extended]
            for one in ahead:
                extended.add(one.model)
                self._extend(one)
            if not ahead:
                if ranked[0].model in exchanged:
                    return ranked
                exchanged.add(ranked[0].model)
                self._extend_by_exchange(ranked[0])

    def _extend(self, one: ScoredModel) -> None:
        """Look at the models with one element more or less."""
        if len(one.model) < self._largest:
            for more in self._list_additions(one, ADDED):
                self.score(one.model | {more}, one.trust)
        for choice in one.model:
            self.score(one.model - {choice}, one.trust)

    def _extend_by_exchange(self, one: ScoredModel) -> None:
        """Look at the models with another size of an element, or another one in its place."""
        for choice in one.model:
            less = one.model - {choice}
            for size in self.elements[choice.element].sizes:
                self.score(less | {ElementChoice(choice.element, size)}, one.trust)
            for more in self._list_additions(self.score(less, one.trust), MOST_SWAPS):
                self.score(less | {more}, one.trust)

    def score(self, model: Model, hint: float | None = None) -> ScoredModel:
        """
        Return a model with its posterior.

        `hint`: trust of a similar model, with which it is looked at first.
        """
        if model in self._scored:
            return self._scored[model]
        first = TRUST if hint is None else [hint]
        scores = {trust: self._compute_log_posterior(model, trust) for trust in first}
        if hint is not None and scores[hint] > self._best - HOPELESS:
            for trust in TRUST:
                scores.setdefault(trust, self._compute_log_posterior(model, trust))
        chosen = max(scores, key=lambda trust: scores[trust])
        self._best = max(self._best, scores[chosen])
        self._scored[model] = ScoredModel(model, scores[chosen], chosen)
        return self._scored[model]

    def exchange(self, one: ScoredModel, choice: ElementChoice, element: int) -> ScoredModel:
        """Return a model with another element in the place of one, in its most probable size."""
        less = one.model - {choice}
        every = [
            self.score(less | {ElementChoice(element, size)}, one.trust)
            for size in self.elements[element].sizes
        ]
        return max(every, key=lambda each: each.log_posterior)

    def restrict(self, one: ScoredModel) -> RestrictedEvidence:
        """Return the evidence of a model."""
        return self.evidence.restrict(self.compute_variance(one.model, one.trust))

    def compute_variance(self, model: Model, trust: float) -> Array:
        """Return the prior variance of each column; 0 if it is absent, shape (K,)."""
        return compute_variance(self.elements, model, trust * self._tolerance)

    def _compute_log_posterior(self, model: Model, trust: float) -> float:
        restricted = self.evidence.restrict(self.compute_variance(model, trust))
        inside = self._log_share_inside(model, restricted)
        return restricted.log_evidence + inside + log_prior(self.elements, model, trust)

    def _log_share_inside(self, model: Model, restricted: RestrictedEvidence) -> float:
        """
        Return by how much bounds of the elements make a model more probable.

        The logarithm of the posterior probability of values within them by the prior one, for each
        column alone.
        """
        bounded = [
            column
            for choice in model
            for column in self.elements[choice.element].columns
            if np.isfinite(self._low[column]) or np.isfinite(self._high[column])
        ]
        if not bounded:
            return 0.0
        mean, covariance = restricted.posterior()
        at = np.searchsorted(restricted.free, bounded)
        low, high = self._low[bounded], self._high[bounded]
        after = _normal_share(low, high, mean[at], np.sqrt(np.diag(covariance)[at]))
        before = _normal_share(low, high, np.zeros(len(at)), restricted.root[at])
        return float(np.sum(np.log(after) - np.log(before)))

    def _list_additions(self, one: ScoredModel, count: int) -> list[ElementChoice]:
        """Return the most promising additions to a model, with their best sizes."""
        restricted = self.restrict(one)
        pull, across = restricted.compute_remainder()
        gains = dict[ElementChoice, float]()
        for k, element in enumerate(self.elements):
            if k not in one.elements:
                size, gain = self._choose_size(element, restricted.whole, pull, across)
                gains[ElementChoice(k, size)] = gain + element.log_prior
        return sorted(gains, key=lambda choice: -gains[choice])[:count]

    @staticmethod
    def _choose_size(
        element: Element, whole: LinearEvidence, pull: Array, across: Array
    ) -> tuple[float, float]:
        """Return the most probable size of an element beside a model, and its gain [nats]."""
        columns, unit = list(element.columns), np.array(element.unit)
        inner = whole.information[np.ix_(columns, columns)]
        inner = (inner - across[:, columns].T @ across[:, columns]) * np.outer(unit, unit)
        strength, turn = np.linalg.eigh(inner)
        power = (turn.T @ (pull[columns] * unit)) ** 2
        scale = np.array(element.sizes)[:, None] ** 2
        spread = 1.0 + scale * np.maximum(strength, 0.0)
        gains = 0.5 * np.sum(power * scale / spread - np.log(spread), axis=1)
        k = int(np.argmax(gains))
        return element.sizes[k], float(gains[k])


def log_prior(elements: Sequence[Element], model: Model, trust: float) -> float:
    """Return the logarithm of the prior probability of a model [nats]."""
    return math.log(TRUST[trust]) + sum(elements[one.element].log_prior for one in model)


def _normal_share(low: Array, high: Array, mean: Array, deviation: Array) -> Array:
    """Return the probability of values within bounds."""
    inside = norm.cdf((high - mean) / deviation) - norm.cdf((low - mean) / deviation)
    share: Array = np.maximum(inside, TINY)
    return share
