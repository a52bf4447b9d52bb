"""
Compute detection limits: the smallest size of each effect that the flights could reveal.

The limit is the smallest size that `acceptance` would accept, plus a margin for noise: an effect
of that size, if nothing else is missing, is named in 19 of 20 cases.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import Prior, ReducedFlight
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.candidate_acceptance import CandidateTrial, LARGER, TRIFLE
from lta_discovery.selection.candidate_scan import evidence_gain, wider_tolerance_gain
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MARGIN: Final = 1.645  # standard deviations; one-sided 95 % margin for noise
LARGEST: Final = 1e3  # typical sizes; effects with a larger limit are undetectable


@final
class DetectionLimit(NamedTuple):
    """Detection limit of one candidate."""

    knob: str
    unit: str
    size: float  # smallest size that is named in 19 of 20 cases
    typical: float  # typical size of the effect


def compute_detection_limits(
    sides: Sequence[ReducedFlight],
    prior: Prior,
    knobs: Sequence[FreeParameter],
    named: Sequence[str] = (),
) -> tuple[DetectionLimit, ...]:
    """
    Return the detection limits of the candidates, the lowest relative to typical sizes first.

    `sides`: training flights, and confirming ones.
    """
    free, variance = prior.free, np.diag(prior.covariance)
    products = [one.products for one in sides]
    # Third entry: both sides together, which gives the held-out gain
    products.append(np.sum(products, axis=0))
    out = []
    for k, knob in enumerate(knobs):
        if knob.typical == 0.0 or knob.name in named:
            continue
        others = np.flatnonzero(free & (np.arange(len(free)) != k))
        information = [_marginal_information(one, k, others, variance[others]) for one in products]
        size = _smallest_nameable_size(information, float(variance[k]), knob.typical)
        if size < LARGEST * knob.typical:
            out.append(DetectionLimit(knob.name, knob.unit, size, knob.typical))
    return tuple(sorted(out, key=lambda one: one.size / one.typical))


def _marginal_information(
    products: Array, k: int, others: NDArray[np.int64], variance: Array
) -> float:
    """Return the information on a parameter, marginal over others with prior variances."""
    inner = products[np.ix_(others, others)] + np.diag(1.0 / variance)
    cross = products[others, k]
    return float(products[k, k] - cross @ np.linalg.solve(inner, cross))


def _smallest_nameable_size(
    informations: Sequence[float], tolerance: float, typical: float
) -> float:
    """
    Return the smallest size that would be named despite noise.

    `informations`: inverse variance of the value from each side, and from both, sequence of three
    floats. `tolerance`: variance of the nominal model's error.
    """
    information = informations[-1]
    if information <= 0.0:
        return np.inf
    low, high = TRIFLE * typical, LARGEST * typical
    # Not even the largest size is named: the bisection would not converge to a limit
    if not _would_be_named(high, informations, tolerance, typical):
        return np.inf
    # Bisect on a logarithmic scale, as limits span many orders of magnitude
    while high > 1.001 * low:
        middle = float(np.sqrt(low * high))
        low, high = (
            (low, middle)
            if _would_be_named(middle, informations, tolerance, typical)
            else (middle, high)
        )
    return high + MARGIN * float(np.sqrt(1.0 / information + tolerance))


def _would_be_named(
    size: float, information: Sequence[float], tolerance: float, typical: float
) -> bool:
    """Return whether noise-free flights would name an effect of some size."""
    # Without noise the pull of an effect is information times size
    first, second, both = (
        evidence_gain(each * size, each, tolerance, typical)[0] for each in information
    )
    # Verification asks this of all flights together
    sure = both - wider_tolerance_gain(information[2] * size, information[2], tolerance) > LARGER
    # The last zeros: without noise both sides measure the same value
    return sure and CandidateTrial('', first, second, both - first, 0.0, 0.0).is_accepted
