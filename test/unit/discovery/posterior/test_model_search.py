# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Evidence and search against every model of a small linear problem, computed densely."""

from dataclasses import replace
from itertools import combinations, product
import math

from lta_discovery.model.parameters import FreeParameter
from lta_discovery.posterior.elements import Element, ElementChoice, Model
from lta_discovery.posterior.model_search import LinearEvidence, ModelSearch
from lta_discovery.settings import TRUST
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.stats import multivariate_normal, norm

Array = NDArray[np.float64]

ROWS, TOLERANCES, SIZES = 60, np.array([0.3, 0.2]), (1.0, 3.0)
# Two tolerances of the file, then six columns of five elements, one of which has two columns
COLUMNS = ((2,), (3,), (4, 5), (6,), (7,))
PRIOR = math.log(0.05)
TRUTH = np.array([0.1, -0.2, 0.0, 1.5, 0.0, 0.0, -0.8, 0.0])


class Problem:
    """Readings that are linear in eight unknowns, with white noise of deviation 1."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self.design = rng.standard_normal((ROWS, len(TRUTH)))
        self.values = self.design @ TRUTH + rng.standard_normal(ROWS)

    @property
    def evidence(self) -> LinearEvidence:
        """Return the quadratic form of the readings."""
        constant = -0.5 * float(self.values @ self.values) - 0.5 * ROWS * math.log(2.0 * math.pi)
        return LinearEvidence(self.design.T @ self.design, self.design.T @ self.values, constant)

    def log_density(self, variance: Array) -> float:
        """Return the density of the readings with normal unknowns."""
        covariance = np.eye(ROWS) + self.design * variance @ self.design.T
        density: float = multivariate_normal(np.zeros(ROWS), covariance).logpdf(self.values)
        return density


def build_parameters() -> list[FreeParameter]:
    out = []
    for k in range(len(TRUTH)):
        tolerance = float(TOLERANCES[k]) if k < len(TOLERANCES) else 0.0
        moves = {('effect', str(k)): 1.0}
        out.append(FreeParameter(f'effect.{k}', '1', moves, 1.0, 1.0, tolerance, 1.0))
    return out


def build_elements() -> list[Element]:
    return [
        Element(f'element {k}', 'effect', columns, (1.0,) * len(columns), SIZES, PRIOR)
        for k, columns in enumerate(COLUMNS)
    ]


def list_models() -> list[Model]:
    """Return every set of elements with every choice of sizes."""
    out = []
    for count in range(len(COLUMNS) + 1):
        for chosen in combinations(range(len(COLUMNS)), count):
            every = product(SIZES, repeat=count)
            out += [frozenset(map(ElementChoice, chosen, sizes)) for sizes in every]
    return out


def compute_densely(problem: Problem, model: Model) -> float:
    """Return the logarithm of a model's posterior with the best trust in the file."""
    scores = []
    for trust, share in TRUST.items():
        variance = np.zeros(len(TRUTH))
        variance[: len(TOLERANCES)] = (trust * TOLERANCES) ** 2
        for one in model:
            variance[list(COLUMNS[one.element])] += one.size**2
        scores.append(problem.log_density(variance) + len(model) * PRIOR + math.log(share))
    return max(scores)


@pytest.mark.parametrize('seed', range(5))
def test_the_search_finds_the_most_probable_of_all_models(seed: int) -> None:
    problem = Problem(seed)
    search = ModelSearch(build_parameters(), build_elements(), problem.evidence)
    ranked = search.run()
    wanted = {model: compute_densely(problem, model) for model in list_models()}
    best = max(wanted, key=lambda model: wanted[model])
    assert ranked[0].model == best
    assert ranked[0].log_posterior == pytest.approx(wanted[best], rel=1e-9)
    assert {1, 3} <= ranked[0].elements


def test_the_posterior_of_a_model_is_that_of_linear_regression() -> None:
    problem, model = Problem(1), frozenset({ElementChoice(1, 3.0)})
    search = ModelSearch(build_parameters(), build_elements(), problem.evidence)
    scored = search.score(model)
    mean, covariance = search.restrict(scored).posterior()
    design = problem.design[:, [0, 1, 3]]
    prior = np.array([*(scored.trust * TOLERANCES), 3.0])
    precision = design.T @ design + np.diag(prior**-2.0)
    np.testing.assert_allclose(covariance, np.linalg.inv(precision), rtol=1e-9)
    np.testing.assert_allclose(mean, np.linalg.solve(precision, design.T @ problem.values))


def test_beside_a_model_the_rest_is_what_its_unknowns_leave() -> None:
    """The readings, whitened by the covariance that the model gives them."""
    problem, variance = Problem(2), np.array([0.3, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.5])
    pull, across = problem.evidence.restrict(variance).compute_remainder()
    weight = np.linalg.inv(np.eye(ROWS) + problem.design * variance @ problem.design.T)
    np.testing.assert_allclose(pull, problem.design.T @ weight @ problem.values, rtol=1e-9)
    wanted = problem.design.T @ weight @ problem.design
    left = problem.evidence.information - across.T @ across
    np.testing.assert_allclose(left, wanted, rtol=1e-9, atol=1e-9)


def test_a_value_beyond_its_bound_makes_a_model_less_probable() -> None:
    """By the share of the posterior that is inside, over that of the prior."""
    problem, model = Problem(3), frozenset({ElementChoice(1, 3.0)})
    parameters, elements = build_parameters(), build_elements()
    free = ModelSearch(parameters, elements, problem.evidence).score(model)
    parameters[3] = replace(parameters[3], low=-1.0, high=1.4)
    search = ModelSearch(parameters, elements, problem.evidence)
    bounded = search.score(model)
    mean, covariance = search.restrict(bounded).posterior()
    after = norm(mean[2], math.sqrt(covariance[2, 2]))
    before = norm(0.0, 3.0)
    share = (after.cdf(1.4) - after.cdf(-1.0)) / (before.cdf(1.4) - before.cdf(-1.0))
    wanted = free.log_posterior + math.log(share)
    assert bounded.log_posterior == pytest.approx(wanted, rel=1e-9)
