"""
Estimate the standard deviations of the latent wrench by maximum evidence.

Large deviations can hide a large missing effect. The search therefore starts both from the given
deviations and from small ones, and the better result is used.
"""

from collections.abc import Callable, Sequence
from typing import Final

from lta_discovery.fit.evidence import Prior
from lta_discovery.fit.evidence_gradient import compute_evidence_gradient, EvidenceGradient
from lta_discovery.fit.flight_group import LinearizedGroup
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMALL: Final = 2.5  # noise floors; largest deviations of the second start
STRIDES: Final = 12  # most steps
HALVES: Final = 4  # most halvings of a step
LONGEST: Final = 2.0  # longest step in the logarithm of a deviation
STRAIGHT: Final = 0.75  # of the gain predicted by the slope; on a parabola a full step gains half
WORTH: Final = 0.01  # nats; the search ends at a smaller predicted gain
LOWEST: Final = 0.05  # noise floors; bound of a deviation
HIGHEST: Final = 1e3  # noise floors; bound of a deviation


def compute_newton_step(gradient: EvidenceGradient) -> Array:
    """
    Return the Newton step in the logarithms of the deviations.

    The evidence is closer to a parabola in a variance than in its logarithm. The step is converted
    accordingly: longer upwards, shorter downwards.
    """
    # Newton step in log deviation; 1 + 2 step is the linear factor on the variance
    step = np.linalg.solve(gradient.bend, gradient.slope)
    # The bound keeps the logarithm defined for long downward steps
    out: Array = 0.5 * np.log(np.maximum(1.0 + 2.0 * step, np.exp(-2.0 * LONGEST)))
    return np.minimum(out, LONGEST)


def maximize_evidence(
    steep: Callable[[Array], EvidenceGradient], start: Array, floor: Array, worth: float = WORTH
) -> tuple[Array, float]:
    """
    Maximize the evidence over the deviations by damped Fisher scoring on their logarithms.

    `steep`: log evidence of deviations with its slope; -inf where undefined. `worth`: predicted
    gain below which the search ends [nats].
    """
    low, high = np.log(LOWEST * floor), np.log(HIGHEST * floor)
    at, part = np.clip(np.log(start), low, high), 1.0
    now = steep(np.exp(at))
    for _ in range(STRIDES if np.isfinite(now.value) else 0):
        # Recompute the step after clipping: the predicted gain has to match it
        step = np.clip(at + part * compute_newton_step(now), low, high) - at
        # First-order gain of the step [nats]
        promised = float(now.slope @ step)
        if promised < worth:
            break
        for _ in range(HALVES):
            there = steep(np.exp(at + step))
            if there.value > now.value:
                break
            # Keep later steps shorter too, since the quadratic model overestimates here
            step, part = 0.5 * step, 0.5 * part
        else:
            break
        gained, at, now = there.value - now.value, at + step, there
        if gained > STRAIGHT * promised:
            part *= 2.0  # little curvature: lengthen the next step
        elif gained < worth:
            break
        else:
            part = min(part, 1.0)
    return np.exp(at), now.value


def fit_deviations(
    group: LinearizedGroup,
    prior: Prior,
    start: Array,
    floor: Array,
    caps: Sequence[float] = (SMALL,),
    worth: float = WORTH,
) -> tuple[Array, float]:
    """
    Return the most probable deviations of the latent wrench, and their log evidence.

    `caps`: upper limits of further starts [noise floors].
    """
    # Columns with a fixed parameter do not affect the evidence
    narrow, indices = group.select(prior.free)
    own = Prior(prior.mean[indices], prior.covariance[np.ix_(indices, indices)])

    def evaluate_gradient(deviations: Array) -> EvidenceGradient:
        try:
            return compute_evidence_gradient(narrow, own, deviations, floor)
        except np.linalg.LinAlgError:
            # Extreme deviations leave only rounding errors of a column.
            return EvidenceGradient(-np.inf, np.zeros(len(floor)), np.eye(len(floor)))

    # Starts from small deviations cannot hide a large missing effect
    starts = [start, *(np.minimum(start, cap * floor) for cap in caps)]
    distinct = [s for k, s in enumerate(starts) if k == 0 or not np.allclose(s, start)]
    return max(
        (maximize_evidence(evaluate_gradient, s, floor, worth) for s in distinct),
        key=lambda pair: pair[1],
    )
