"""
Compute robust variances of parameters from the scatter between pieces of the flights.

The posterior assumes white noise and an exact model, and is overconfident where these fail. The
sandwich estimator (Huber 1967) uses the actual score of each piece instead, with the leverage
correction HC3 (MacKinnon and White 1985). Priors of vehicle and sensors count as before.
"""

from typing import Final

from lta_discovery.fit.evidence import PieceReducer
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.replay.linearized_flight import LinearizationPoint, LinearizedFlight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DRAWN: Final = 0.9  # largest leverage of one piece in the correction


def reduce_each_piece(linear: LinearizedFlight, deviations: Array) -> Array:
    """Return the products of each piece without its unknowns, shape (S, G + 1, G + 1)."""
    out = []
    # One piece at a time: only the sum over pieces is kept in a reduced flight
    for s in range(len(linear.rows)):
        one = slice(s, s + 1)
        point = LinearizationPoint(
            linear.point.nominal, linear.point.values, linear.point.random[one]
        )
        piece = LinearizedFlight(
            linear.names, linear.grams[one], linear.rows[one], point, linear.residual
        )
        out.append(PieceReducer(piece).eliminate_unknowns(deviations).products)
    return np.array(out)


def sandwich_variance(joint: JointFit) -> Array:
    """Return the robust variance of the shared parameters, shape (G,)."""
    covariance = joint.fitted.covariance
    free = joint.prior.free
    precision = np.zeros_like(covariance)
    # The prior is the inner part of the sandwich that the pieces do not cover
    precision[np.ix_(free, free)] = np.linalg.inv(joint.prior.covariance[np.ix_(free, free)])
    pulled = np.zeros(len(covariance))
    for member in joint.members:
        scores, informations, own = _flight_scores(joint, member.linear, member.fitted.mean)
        precision += own
        moved = scores @ covariance
        # Leverage: share of a parameter's information that comes from one piece
        shares = np.einsum('ka,sab,bk->sk', covariance, informations, covariance)
        shares = np.minimum(shares / np.maximum(np.diag(covariance), 1e-300), DRAWN)
        # HC3: a piece pulls the estimate towards itself; undo that by its leverage
        pulled += np.sum((moved / (1.0 - shares)) ** 2, axis=0)
    out: Array = pulled + np.diag(covariance @ precision @ covariance)
    return out


def _flight_scores(
    joint: JointFit, linear: LinearizedFlight, mean: Array
) -> tuple[Array, Array, Array]:
    """Return score and information of each piece for shared parameters, and the flight's prior."""
    products = reduce_each_piece(linear, joint.deviations)
    own = np.flatnonzero(joint.group.variance)
    inner, right = products[:, :-1, :-1], products[:, :-1, -1]
    # Gradient of the log density at the posterior mean
    scores = right - inner @ (mean - linear.point.values)
    whole = inner.sum(axis=0)
    before = np.diag(1.0 / joint.group.variance[own])
    through = np.eye(len(whole))
    answer = np.linalg.solve(whole[np.ix_(own, own)] + before, whole[own])
    through[own] -= answer
    informations = np.einsum('ab,sac,cd->sbd', through, inner, through, optimize=True)
    return scores @ through, informations, answer.T @ before @ answer
