"""
Compute the gradient of the log evidence in the deviations of the latent wrench.

The slope in the logarithm of a deviation is the posterior expectation of the squared wrench less
its prior expectation (Fisher's identity). The bend is the expected information of variance
components (Harville 1977). Both follow from the solution for the evidence, without finite
differences.
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
    """Log evidence at some deviations."""

    value: float  # including the prior of the deviations [nats]
    slope: Array  # gradient in the logarithms of the deviations, shape (6,)
    bend: Array  # minus the expected Hessian, shape (6, 6)


def compute_evidence_gradient(
    group: LinearizedGroup, prior: Prior, deviations: Array, floor: Array
) -> EvidenceGradient:
    """
    Compute the log evidence, its slope and its bend.

    Raises
    ------
    LinAlgError
        If extreme deviations leave only rounding errors of a column.

    """
    solved = map_parallel(lambda pieces: pieces.solve_latent(deviations), group.pieces)
    posterior = compute_posterior(
        group.sum_flights([each.reduced for each in solved]), group.at, prior
    )

    def compute_flight_gradient(one: tuple[PieceReducer, LatentSolution]) -> tuple[Array, Array]:
        pieces, each = one
        return _flight_gradient(
            pieces, each, group.flight_posterior(pieces, each.reduced, posterior), deviations
        )

    slope, bend = log_prior_slope(deviations, floor)
    for more, less in map_parallel(
        compute_flight_gradient, list(zip(group.pieces, solved, strict=True))
    ):
        slope, bend = slope + more, bend + less
    return EvidenceGradient(posterior.log_evidence + log_prior(deviations, floor), slope, bend)


def _flight_gradient(
    pieces: PieceReducer, solved: LatentSolution, own: ParameterPosterior, deviations: Array
) -> tuple[Array, Array]:
    """Return the contribution of one flight to slope and bend."""
    # Posterior mean of the wrench at the flight's own parameters
    change = own.mean - pieces.linear.point.values
    answer = solved.answer[:, :, :-1]
    latent = solved.answer[:, :, -1] - answer @ change + pieces.latent_wrench
    # Add the uncertainty of the parameters to that at fixed parameters
    covariance = solved.inverse + answer @ own.covariance @ np.swapaxes(answer, 1, 2)
    count = pieces.linear.knots
    inverse, variance = knot_precision(count), deviations**2
    knots = latent.reshape(-1, AXES, count)
    blocks = covariance.reshape(-1, AXES, count, AXES, count)
    # Expected squared wrench: that of the mean plus the trace of its covariance.
    spent = np.einsum('saj,jk,sak->a', knots, inverse, knots)
    spent += np.einsum('saiaj,ji->a', blocks, inverse, optimize=True)
    # Zero where the squared wrench equals its prior expectation
    slope = spent / variance - count * len(knots)
    # Information of the data relative to the prior: I - C K^-1 / variance, by pairs of axes.
    left = -(blocks @ inverse) / variance[:, None]
    for axis in range(AXES):
        left[:, axis, :, axis] += np.eye(count)
    bend = 2.0 * np.einsum('saibj,sbjai->ab', left, left, optimize=True)
    return slope, bend
