"""
How small an effect flights could have shown: what an answer of 'nothing' is worth.

The size is the least that naming would accept (`accept`, with the sizes of `scan`), with a margin
for chance: an effect of that size, if nothing else is missing, gets its name 19 times in 20.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import Prior, ReducedFlight
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.acceptance import CandidateTrial, TRIFLE
from lta_discovery.selection.candidate_scan import evidence_gain
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MARGIN: Final = 1.645  # deviations; what chance may take away from an effect once in 20 times
LARGEST: Final = 1e3  # typical sizes; what would have to be larger cannot be seen


@final
class DetectionLimit(NamedTuple):
    """
    One candidate.

    Attributes
    ----------
    knob : str
        Its name.
    unit : str
        Of its size.
    size : float
        From which on it would have been named, 19 times in 20.
    typical : float
        Size of the effect where it is there.

    """

    knob: str
    unit: str
    size: float
    typical: float


def compute_detection_limits(
    sides: Sequence[ReducedFlight],
    prior: Prior,
    knobs: Sequence[FreeParameter],
    named: Sequence[str] = (),
) -> tuple[DetectionLimit, ...]:
    """
    Return how small each candidate could have been, the clearest by its typical size first.

    Parameters
    ----------
    sides : pair of Reduced
        The flights that teach, and those that confirm.
    prior : Prior
        Of the nuisances, as `tolerances` or `shared` has it, and of what is named already.
    knobs : sequence of Knob
        All.
    named : sequence of str
        Those that were found, and are no candidates any more.

    """
    free, variance = prior.free, np.diag(prior.covariance)
    products = [one.products for one in sides]
    products.append(np.sum(products, axis=0))
    out = []
    for k, knob in enumerate(knobs):
        if knob.typical == 0.0 or knob.name in named:
            continue
        others = np.flatnonzero(free & (np.arange(len(free)) != k))
        told = [_marginal_information(one, k, others, variance[others]) for one in products]
        size = _least_size(told, float(variance[k]), knob.typical)
        if size < LARGEST * knob.typical:
            out.append(DetectionLimit(knob.name, knob.unit, size, knob.typical))
    return tuple(sorted(out, key=lambda one: one.size / one.typical))


def _marginal_information(
    products: Array, k: int, others: NDArray[np.int64], variance: Array
) -> float:
    """Return how well flights know a knob, when others are known as their variance says."""
    inner = products[np.ix_(others, others)] + np.diag(1.0 / variance)
    cross = products[others, k]
    return float(products[k, k] - cross @ np.linalg.solve(inner, cross))


def _least_size(informations: Sequence[float], tolerance: float, typical: float) -> float:
    """
    Return the least size that would be named in spite of chance.

    Parameters
    ----------
    told : sequence of three floats
        Information of each side and of both: one over the variance of the knob's value.
    tolerance : float
        Variance of the nominal model's own error.
    typical : float
        Size of the effect where it is there.

    """
    information = informations[-1]
    if information <= 0.0:
        return np.inf
    low, high = TRIFLE * typical, LARGEST * typical
    if not _would_be_named(high, informations, tolerance, typical):
        return np.inf
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
    """Tell whether sides that show an effect as it is would give it a name."""
    first, second, both = (
        evidence_gain(each * size, each, tolerance, typical)[0] for each in information
    )
    return CandidateTrial('', first, second, both - first, 0.0, 0.0).is_accepted
