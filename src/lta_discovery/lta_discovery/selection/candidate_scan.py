"""Scan all candidates for their linearized gain in evidence, marginal over the nuisances."""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import Prior, ReducedFlight, WIDER
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Prior deviations in typical sizes, and the prior cost of larger ones [nats]: a
# prior with heavy tails, three scales of 85, 12 and 3 %.
SIZES: Final[dict[float, float]] = {1.0: 0.0, 5.0: 2.0, 25.0: 3.5}


@final
class CandidateScore(NamedTuple):
    """Linearized evidence for one candidate."""

    name: str
    gain: float  # log Bayes factor of the effect against tolerance alone [nats]
    # Pull over the root of the information: N(0, 1) without an effect.
    score: float
    # Posterior of the parameter with the effect, in its unit
    value: float
    deviation: float
    sigma: float  # |value| over the combined deviation of estimate and tolerance
    size: float = 1.0  # the most probable of SIZES


def evidence_gain(
    pull: float, information: float, tolerance: float, typical: float
) -> tuple[float, float]:
    """
    Return the log Bayes factor of an effect against tolerance alone [nats], and its size of SIZES.

    `pull` is the maximum likelihood value times `information`, the inverse variance. `tolerance`
    is the variance of the nominal model's error.
    """
    gains = {
        size: _column_evidence(pull, information, tolerance + (size * typical) ** 2) - cost
        for size, cost in SIZES.items()
    }
    size = max(gains, key=lambda one: gains[one])
    # The alternative is the tolerance alone, not an exactly known parameter
    return gains[size] - _column_evidence(pull, information, tolerance), size


def wider_tolerance_gain(pull: float, information: float, tolerance: float) -> float:
    """Return how much better a larger tolerance explains a pull; 0 if it does not. [nats]"""
    wider = _column_evidence(pull, information, WIDER**2 * tolerance) - float(np.log(2.0))
    return max(wider - _column_evidence(pull, information, tolerance), 0.0)


def _column_evidence(pull: float, information: float, variance: float) -> float:
    """Return the log evidence of a column with a prior variance, against a value of 0."""
    # Ratio of prior to posterior variance; its logarithm is the Occam penalty
    more = 1.0 + information * variance
    return float(0.5 * pull**2 * variance / more - 0.5 * np.log(more))


def scan_candidates(
    reduced: ReducedFlight, at: Array, prior: Prior, knobs: Sequence[FreeParameter]
) -> list[CandidateScore]:
    """
    Return the scores of all candidates that are not in the model yet, the highest first.

    `prior`: of nuisances and present effects, with independent parameters (`build_prior`).
    `knobs`: in the order of `at`, which continues with the sensor errors.
    """
    # The prior is diagonal here (`build_prior`), so roots of its diagonal suffice
    free, deviation = prior.free, np.sqrt(np.diag(prior.covariance))
    count, products = len(at), reduced.products
    precision = np.where(free, np.where(free, deviation, 1.0) ** -2.0, 0.0)
    # Fixed columns get a unit diagonal, so that the matrix keeps its shape and is invertible.
    inner = np.where(np.outer(free, free), products[:count, :count], 0.0)
    inner[np.diag_indices(count)] += np.where(free, precision, 1.0)
    right = np.where(free, products[:count, -1] + precision * (prior.mean - at), 0.0)
    inverse = np.linalg.inv(inner)
    out = []
    for k, knob in enumerate(knobs):
        # A nuisance only, never a candidate
        if knob.typical == 0.0:
            continue
        column = np.where(free, products[:count, k], 0.0)
        own, others, force = inverse, column, right
        if free[k]:
            # Remove the candidate itself from the nuisances (rank-one downdate of the inverse).
            own = inverse - np.outer(inverse[k], inverse[k]) / inverse[k, k]
            others = column.copy()
            # The column has to exclude the candidate too
            others[k] = 0.0
        information = products[k, k] - others @ own @ others
        pull = products[k, -1] - others @ own @ force
        # A typical effect would change the log likelihood by less than 1e-6
        if information * knob.typical**2 < 1e-6:
            continue  # not observable in this flight
        had = prior.covariance[k, k]
        # The pull is about the linearization point; shift it to the prior mean
        pull -= information * (prior.mean - at)[k]
        won, size = evidence_gain(pull, information, had, knob.typical)
        whole = had + (size * knob.typical) ** 2
        value = pull / (information + 1.0 / whole)
        spread = 1.0 / (information + 1.0 / whole)
        best = pull / information
        sigma = abs(best) / np.sqrt(1.0 / information + had)
        # Tolerance widens the distribution of the pull without an effect
        score = pull / np.sqrt(information) / np.sqrt(1.0 + information * had)
        there = value + prior.mean[k], float(np.sqrt(spread))
        out.append(CandidateScore(knob.name, won, float(score), *there, sigma, size))
    return sorted(out, key=lambda seen: -seen.gain)


def column_cosines(
    reduced: ReducedFlight, prior: Prior, names: Sequence[str], parameters: Sequence[FreeParameter]
) -> Array:
    """
    Return the cosines between the columns of candidates, nuisances marginalized.

    `prior`: of the nuisances; the candidates' own tolerances are ignored. The result has shape (n,
    n): 1 on the diagonal; close to 1 or -1 for indistinguishable pairs; 0 for unobservable ones.
    """
    order = [knob.name for knob in parameters]
    picked = np.array([order.index(name) for name in names], dtype=np.int64)
    free = prior.free
    free[picked] = False
    at = np.flatnonzero(free)
    # Project the candidates' columns orthogonal to the nuisances
    inner = reduced.products[np.ix_(at, at)] + np.diag(1.0 / np.diag(prior.covariance)[at])
    cross = reduced.products[np.ix_(at, picked)]
    left = reduced.products[np.ix_(picked, picked)] - cross.T @ np.linalg.solve(inner, cross)
    size = np.sqrt(np.maximum(np.diag(left), 0.0))
    whole = np.outer(size, size)
    cosine: Array = np.divide(left, whole, out=np.zeros_like(left), where=whole > 0.0)
    return cosine
