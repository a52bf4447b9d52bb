"""
How much force flights leave unexplained: the most probable deviations of the latent wrench.

A large missing effect can hide behind large deviations; so they are looked for from where they are
and from small ones, and the better is taken.
"""

from collections.abc import Callable, Sequence
from typing import Final

from lta_discovery.fit.evidence import Prior
from lta_discovery.fit.evidence_gradient import compute_evidence_gradient, EvidenceGradient
from lta_discovery.fit.flight_group import LinearizedGroup
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMALL: Final = 2.5  # floors; the largest deviations of the second start
STRIDES: Final = 12  # at most
HALVES: Final = 4  # of a stride that does not help
LONGEST: Final = 2.0  # of the logarithm of a deviation; a stride
STRAIGHT: Final = 0.75  # of what a slope promises; on a parabola a stride gains half
WORTH: Final = 0.01  # nats; a stride that promises less is not made
LOWEST: Final = 0.05  # floors; of a deviation
HIGHEST: Final = 1e3  # floors; of a deviation


def newton_strides(gradient: EvidenceGradient) -> Array:
    """
    Return by how much the logarithms of the deviations should change.

    The evidence is nearer to a parabola in a variance than in its logarithm: where there is too
    much, a stride is made longer, where there is too little, shorter.
    """
    step = np.linalg.solve(gradient.bend, gradient.slope)
    out: Array = 0.5 * np.log(np.maximum(1.0 + 2.0 * step, np.exp(-2.0 * LONGEST)))
    return np.minimum(out, LONGEST)


def maximize_evidence(
    steep: Callable[[Array], EvidenceGradient], start: Array, floor: Array, worth: float = WORTH
) -> tuple[Array, float]:
    """
    Return the deviations of greatest value near a start, and the value.

    Fisher's scoring on the logarithms, halved until it helps.

    Parameters
    ----------
    steep : callable
        Log evidence of deviations, -inf where there is none, with its slope.
    start, floor : ndarray, shape (6,)
        Deviations to begin with, and those that are not worth speaking of.
    worth : float
        Log evidence below which a stride is not made. [nats]

    """
    low, high = np.log(LOWEST * floor), np.log(HIGHEST * floor)
    at, part = np.clip(np.log(start), low, high), 1.0
    now = steep(np.exp(at))
    for _ in range(STRIDES if np.isfinite(now.value) else 0):
        step = np.clip(at + part * newton_strides(now), low, high) - at
        promised = float(now.slope @ step)
        if promised < worth:
            break
        for _ in range(HALVES):
            there = steep(np.exp(at + step))
            if there.value > now.value:
                break
            step, part = 0.5 * step, 0.5 * part
        else:
            break
        gained, at, now = there.value - now.value, at + step, there
        if gained > STRAIGHT * promised:
            part *= 2.0  # a hillside that hardly bends
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
    Return the most probable deviations of the latent wrench, and the log evidence with theirs.

    Parameters
    ----------
    group : Group
        The flights.
    prior : Prior
        Of what they share.
    start, floor : ndarray, shape (6,)
        Deviations to begin with, and those that are not worth speaking of.
    caps : sequence of float
        Of further starts. [floors]
    worth : float
        As for `maximize_evidence`.

    """
    narrow, kept = group.select_columns(prior.free)
    own = Prior(prior.mean[kept], prior.covariance[np.ix_(kept, kept)])

    def evaluate_gradient(deviations: Array) -> EvidenceGradient:
        try:
            return compute_evidence_gradient(narrow, own, deviations, floor)
        except np.linalg.LinAlgError:
            # So far off that nothing is left of a column but rounding.
            return EvidenceGradient(-np.inf, np.zeros(len(floor)), np.eye(len(floor)))

    starts = [start, *(np.minimum(start, cap * floor) for cap in caps)]
    distinct = [s for k, s in enumerate(starts) if k == 0 or not np.allclose(s, start)]
    return max(
        (maximize_evidence(evaluate_gradient, s, floor, worth) for s in distinct),
        key=lambda found: found[1],
    )
