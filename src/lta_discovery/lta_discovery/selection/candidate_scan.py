"""Every candidate at a glance: what it would gain beside the nuisances."""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import Prior, ReducedFlight
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# How many typical sizes an effect may have, and what the larger ones cost beforehand [nats]: a
# prior with heavy tails, three scales of 85, 12 and 3 %.
SIZES: Final[dict[float, float]] = {1.0: 0.0, 5.0: 2.0, 25.0: 3.5}


@final
class CandidateScore(NamedTuple):
    """
    One candidate.

    Attributes
    ----------
    name : str
        Of the knob.
    gain : float
        Log Bayes factor of its being there against its being only tolerance. [nats]
    score : float
        Pull over the root of the information: N(0, 1) where nothing is hidden.
    value, deviation : float
        Of the knob where the candidate is there, in the unit of the knob.
    sigma : float
        |value| over the deviation and the nominal model's own tolerance together.
    size : float
        Of SIZES: how many typical sizes make it most probable.

    """

    name: str
    gain: float
    score: float
    value: float
    deviation: float
    sigma: float
    size: float = 1.0


def evidence_gain(
    pull: float, information: float, tolerance: float, typical: float
) -> tuple[float, float]:
    """
    Return what it gains that a candidate is there, against its being only tolerance, and its size.

    Parameters
    ----------
    pull, information : float
        Of its column: the most probable value times the information, and one over its variance.
    tolerance : float
        Variance of the nominal model's own error.
    typical : float
        Size of the effect where it is there.

    Returns
    -------
    float, float
        Log Bayes factor [nats]; the entry of SIZES that makes it most probable.

    """
    gains = {
        size: _column_evidence(pull, information, tolerance + (size * typical) ** 2) - cost
        for size, cost in SIZES.items()
    }
    size = max(gains, key=lambda one: gains[one])
    return gains[size] - _column_evidence(pull, information, tolerance), size


def _column_evidence(pull: float, information: float, variance: float) -> float:
    """Return the log evidence of a column with a variance, against 0."""
    more = 1.0 + information * variance
    return float(0.5 * pull**2 * variance / more - 0.5 * np.log(more))


def scan_candidates(
    reduced: ReducedFlight, at: Array, prior: Prior, knobs: Sequence[FreeParameter]
) -> list[CandidateScore]:
    """
    Return all candidates that are not in the model yet, the strongest first.

    Parameters
    ----------
    reduced : Reduced
        The flight about a point.
    at : ndarray, shape (G,)
        Where the knobs stand there.
    prior : Prior
        Of the nuisances and of what is in the model already, each by itself (`tolerances`).
    knobs : sequence of Knob
        In the order of `at`, which goes on with the errors of the sensors.

    """
    free, deviation = prior.free, np.sqrt(np.diag(prior.covariance))
    count, products = len(at), reduced.products
    precision = np.where(free, np.where(free, deviation, 1.0) ** -2.0, 0.0)
    # Columns that are held have no share: put out of the way, not left out.
    inner = np.where(np.outer(free, free), products[:count, :count], 0.0)
    inner[np.diag_indices(count)] += np.where(free, precision, 1.0)
    right = np.where(free, products[:count, -1] + precision * (prior.mean - at), 0.0)
    inverse = np.linalg.inv(inner)
    out = []
    for k, knob in enumerate(knobs):
        if knob.typical == 0.0:
            continue
        column = np.where(free, products[:count, k], 0.0)
        own, others, force = inverse, column, right
        if free[k]:
            # Without the candidate's own share among the nuisances.
            own = inverse - np.outer(inverse[k], inverse[k]) / inverse[k, k]
            others = column.copy()
            others[k] = 0.0
        information = products[k, k] - others @ own @ others
        pull = products[k, -1] - others @ own @ force
        if information * knob.typical**2 < 1e-6:
            continue  # this flight says nothing of it
        had = prior.covariance[k, k]
        pull -= information * (prior.mean - at)[k]
        won, size = evidence_gain(pull, information, had, knob.typical)
        whole = had + (size * knob.typical) ** 2
        value = pull / (information + 1.0 / whole)
        spread = 1.0 / (information + 1.0 / whole)
        best = pull / information
        sigma = abs(best) / np.sqrt(1.0 / information + had)
        score = pull / np.sqrt(information) / np.sqrt(1.0 + information * had)
        there = value + prior.mean[k], float(np.sqrt(spread))
        out.append(CandidateScore(knob.name, won, float(score), *there, sigma, size))
    return sorted(out, key=lambda seen: -seen.gain)


def column_cosines(
    reduced: ReducedFlight, prior: Prior, names: Sequence[str], parameters: Sequence[FreeParameter]
) -> Array:
    """
    Return how alike candidates look: the cosine between their columns, nuisances marginalised.

    Parameters
    ----------
    reduced : Reduced
        The flight about a point.
    prior : Prior
        Of the nuisances; the candidates' own tolerances are left out.
    names : sequence of str
        The candidates.
    known : sequence of Knob
        All knobs.

    Returns
    -------
    ndarray, shape (n, n)
        1 in the diagonal; near 1 or -1 where no such flight can tell two apart; 0 for a candidate
        that leaves no trace.

    """
    order = [knob.name for knob in parameters]
    picked = np.array([order.index(name) for name in names], dtype=np.int64)
    free = prior.free
    free[picked] = False
    at = np.flatnonzero(free)
    inner = reduced.products[np.ix_(at, at)] + np.diag(1.0 / np.diag(prior.covariance)[at])
    cross = reduced.products[np.ix_(at, picked)]
    left = reduced.products[np.ix_(picked, picked)] - cross.T @ np.linalg.solve(inner, cross)
    size = np.sqrt(np.maximum(np.diag(left), 0.0))
    whole = np.outer(size, size)
    cosine: Array = np.divide(left, whole, out=np.zeros_like(left), where=whole > 0.0)
    return cosine
