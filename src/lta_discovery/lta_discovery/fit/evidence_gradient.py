"""
How the log evidence answers to the deviations of the latent wrench.

Its slope along the logarithm of a deviation is what the wrench is expected to be, by the data and
all else that is unknown, less what its prior says that it is (Fisher's identity); its bend is
expected to be that of variance components (Harville 1977). Both come from what is solved for the
evidence itself, so that no step aside has to be tried.
"""

from typing import final, NamedTuple

from lta_discovery.fit.evidence import (
    compute_posterior,
    knot_precision,
    LatentSolution,
    log_prior,
    log_prior_slope,
    ParameterPosterior,
    PieceReducer,
    Prior,
)
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.linearized_flight import AXES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class EvidenceGradient(NamedTuple):
    """
    The log evidence at some deviations.

    Attributes
    ----------
    value : float
        Itself, with the prior of the deviations. [nats]
    slope : ndarray, shape (6,)
        Along the logarithms of the deviations.
    bend : ndarray, shape (6, 6)
        Minus its expected second derivative along them.

    """

    value: float
    slope: Array
    bend: Array


def compute_evidence_gradient(
    group: LinearizedGroup, prior: Prior, deviations: Array, floor: Array
) -> EvidenceGradient:
    """
    Return the log evidence, its slope and its bend.

    Parameters
    ----------
    group : Group
        The flights.
    prior : Prior
        Of what they share.
    deviations, floor : ndarray, shape (6,)
        Of the latent wrench, and those that are not worth speaking of.

    Raises
    ------
    LinAlgError
        If the deviations are so far off that nothing is left of a column but rounding.

    """
    solved = map_parallel(lambda pieces: pieces.solve_latent(deviations), group.pieces)
    found = compute_posterior(
        group.sum_flights([each.reduced for each in solved]), group.at, prior
    )

    def compute_share(one: tuple[PieceReducer, LatentSolution]) -> tuple[Array, Array]:
        pieces, each = one
        return _flight_gradient(
            pieces, each, group.flight_posterior(pieces, each.reduced, found), deviations
        )

    slope, bend = log_prior_slope(deviations, floor)
    for more, less in map_parallel(compute_share, list(zip(group.pieces, solved, strict=True))):
        slope, bend = slope + more, bend + less
    return EvidenceGradient(found.log_evidence + log_prior(deviations, floor), slope, bend)


def _flight_gradient(
    pieces: PieceReducer, solved: LatentSolution, own: ParameterPosterior, deviations: Array
) -> tuple[Array, Array]:
    """Return the share of one flight in slope and bend."""
    change = own.mean - pieces.linear.point.values
    answer = solved.answer[:, :, :-1]
    latent = solved.answer[:, :, -1] - answer @ change + pieces.latent_wrench
    covariance = solved.inverse + answer @ own.covariance @ np.swapaxes(answer, 1, 2)
    count = pieces.linear.knots
    inverse, variance = knot_precision(count), deviations**2
    knots = latent.reshape(-1, AXES, count)
    blocks = covariance.reshape(-1, AXES, count, AXES, count)
    spent = np.einsum('saj,jk,sak->a', knots, inverse, knots)
    spent += np.einsum('saiaj,ji->a', blocks, inverse, optimize=True)
    slope = spent / variance - count * len(knots)
    # What the data leave of the prior's say: I - C K^-1 / variance, by pairs of axes.
    left = -(blocks @ inverse) / variance[:, None]
    for axis in range(AXES):
        left[:, axis, :, axis] += np.eye(count)
    bend = 2.0 * np.einsum('saibj,sbjai->ab', left, left, optimize=True)
    return slope, bend
