"""
Regress the unexplained wrench of jointly fitted flights on the terms of a law.

The wrench is known at the knots of each piece with a covariance. Whitened by it, and with states,
sensor errors and tolerances marginalized, the evidence of any term is a matter of its products.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_config.schema.vehicle_law import AXES as AXIS_UNITS
from lta_discovery.fit.evidence import (
    compute_posterior,
    knot_precision,
    log_prior,
    PieceReducer,
    ReducedFlight,
)
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.linearized_flight import AXES
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

Array = NDArray[np.float64]

# The six of the body, then forces along the axes of the map
LAW_AXES: Final = tuple(AXIS_UNITS)
MAP: Final = 3  # axes of the map among them, the last


@final
@dataclass(frozen=True, slots=True)
class TermProducts:
    """Products of J terms in the inverse covariance of the wrench."""

    right: Array  # with the wrench, shape (J,)
    inner: Array  # with each other, shape (J, J)
    shared: Array  # with the shared parameters, whitened, shape (F, J)


@final
class WrenchRegression:
    """
    Information that fitted flights hold on a wrench, for some deviations of its random part.

    Parameters
    ----------
    rotations : sequence of ndarray, shape (S, K, 3, 3)
        Attitude at the knots of each flight, body to map.
    deviations : ndarray, shape (6,)
        Of the wrench that no term explains. [N, N m]

    """

    def __init__(
        self,
        joint: JointFit,
        pieces: Sequence[PieceReducer],
        rotations: Sequence[Array],
        deviations: Array,
        floor: Array,
    ) -> None:
        group = LinearizedGroup(tuple(pieces), joint.group.at, joint.group.variance)
        self.deviations, self._group = deviations, group
        self._own = np.flatnonzero(group.variance)
        self._free = np.flatnonzero(joint.prior.free)
        parts = map_parallel(self._reduce_flight, list(zip(pieces, rotations, strict=True)))
        products = np.sum([part[0] for part in parts], axis=0)
        constant = sum(part[1] for part in parts)
        reduced = ReducedFlight(products, constant)
        self.base = compute_posterior(reduced, group.at, joint.prior).log_evidence
        self.base += log_prior(deviations, floor)
        free = self._free
        wide = joint.prior.covariance[np.ix_(free, free)]
        inverse, offset = np.linalg.inv(wide), (joint.prior.mean - group.at)[free]
        self._lower = np.linalg.cholesky(products[np.ix_(free, free)] + inverse)
        right = products[free, -1] + inverse @ offset
        self._seen = solve_triangular(self._lower, right, lower=True)
        self._inner = np.concatenate([part[2] for part in parts])  # (S, 9 K, 9 K)
        self._right = np.concatenate([part[4] for part in parts])  # (S, 9 K)
        back = np.linalg.inv(self._lower).T
        self._shared = np.concatenate([part[3][..., free] @ back for part in parts])
        # Own parameters of each flight: a block for each
        sizes = [len(part[2]) for part in parts]
        self._flights = np.repeat(np.arange(len(parts)), sizes)
        self._own_columns = np.concatenate([part[5] for part in parts])
        self.knots = pieces[0].linear.knots

    def _reduce_flight(
        self, one: tuple[PieceReducer, Array]
    ) -> tuple[Array, float, Array, Array, Array, Array]:
        """Return products, constant, and the information of the pieces on a wrench."""
        reducer, rotation = one
        solved = reducer.solve_latent(self.deviations)
        knots = reducer.linear.knots
        precision = np.kron(np.diag(self.deviations**-2.0), knot_precision(knots))
        inner = precision - precision @ solved.inverse @ precision
        cross = precision @ solved.answer
        cross[..., -1] += reducer.latent_wrench @ precision
        point = reducer.linear.point
        off = self._group.at - point.values
        shift = np.where(self._group.variance > 0.0, 0.0, off)
        cross[..., -1] -= cross[..., :-1] @ shift
        products = self._group._align_products(point, solved.reduced)
        own, variance = self._own, self._group.variance[self._own]
        root = np.linalg.cholesky(products[np.ix_(own, own)] + np.diag(1.0 / variance))
        aside = products[own].copy()
        aside[:, -1] += off[own] / variance
        half = solve_triangular(root, aside, lower=True)
        left = products - half.T @ half
        left[-1, -1] += float(np.sum(off[own] ** 2 / variance))
        constant = solved.reduced.constant - 0.5 * float(np.log(variance).sum())
        constant -= float(np.log(np.diag(root)).sum())
        mine = cross[..., own] @ np.linalg.inv(root).T
        cross = cross - mine @ half
        turn = _expand_axes(rotation)
        turned = np.swapaxes(turn, 1, 2)
        return (
            left,
            constant,
            turned @ inner @ turn,
            turned @ cross[..., :-1],
            (turned @ cross[..., -1:])[..., 0],
            turned @ mine,
        )

    def _axis(self, axis: int) -> slice:
        """Return the knots of an axis."""
        return slice(axis * self.knots, (axis + 1) * self.knots)

    def scan(self, basis: Array, axis: int) -> tuple[Array, Array, Array]:
        """
        Return products of many terms on one axis: right (J,), diagonal (J,), parameters (M, J).

        `basis` are the terms at the knots, shape (S, K, J).
        """
        where = self._axis(axis)
        right = np.einsum('sk,skj->j', self._right[:, where], basis)
        part = np.ascontiguousarray(self._inner[:, where, where])
        diagonal = np.einsum('skj,skj->j', part @ basis, basis)
        aside = self._project(basis, where)
        right = right - aside[-len(self._seen) :].T @ self._seen
        return right, diagonal - np.sum(aside**2, axis=0), aside

    def _project(self, basis: Array, where: slice) -> Array:
        """Return the whitened products with own and shared parameters, shape (M, J)."""
        count = basis.shape[2]
        own = [
            self._own_columns[some, where].reshape(-1, self._own_columns.shape[2]).T
            @ basis[some].reshape(-1, count)
            for some in (self._flights == k for k in range(self._flights[-1] + 1))
        ]
        shared = self._shared[:, where].reshape(-1, self._shared.shape[2]).T
        return np.vstack([*own, shared @ basis.reshape(-1, count)])

    def cross(
        self, basis: Array, axis: int, aside: Array, other: Array, at: int, other_aside: Array
    ) -> Array:
        """Return the products (J,) of terms on an axis with another term (S, K) on axis `at`."""
        pushed = self._inner[:, self._axis(axis), self._axis(at)] @ other[..., None]
        out: Array = np.einsum('sk,skj->j', pushed[..., 0], basis) - aside.T @ other_aside
        return out

    def products(self, terms: Sequence[tuple[Array, int]]) -> TermProducts:
        """Return the products of some terms, each with its values (S, K) and its axis."""
        count = len(terms)
        inner, asides, right = np.zeros((count, count)), [], np.zeros(count)
        for j, (values, axis) in enumerate(terms):
            own, diagonal, aside = self.scan(values[..., None], axis)
            right[j], inner[j, j] = own[0], diagonal[0]
            asides.append(aside)
            for k in range(j):
                other, at = terms[k]
                inner[j, k] = inner[k, j] = self.cross(
                    values[..., None], axis, aside, other, at, asides[k][:, 0]
                )[0]
        shared = np.hstack(asides)[-len(self._seen) :] if asides else np.zeros((0, 0))
        return TermProducts(right, inner, shared)

    def shared_parameters(self, products: TermProducts, weights: Array) -> Array:
        """Return the most probable shared parameters for given weights of the terms, (G,)."""
        seen = self._seen - (products.shared @ weights if len(weights) else 0.0)
        out = self._group.at.copy()
        out[self._free] += np.linalg.solve(self._lower.T, seen)
        return out


def _expand_axes(rotation: Array) -> Array:
    """Return the body wrench of a wrench on LAW_AXES, at the knots, shape (S, 6 K, 9 K)."""
    pieces, knots = rotation.shape[:2]
    out = np.zeros((pieces, AXES, knots, len(LAW_AXES), knots))
    here = np.arange(knots)
    for axis in range(AXES):
        out[:, axis, here, axis, here] = 1.0
    for way in range(MAP):
        for axis in range(3):
            # Row of the rotation: the map axis in the body
            out[:, axis, here, AXES + way, here] = rotation[:, :, way, axis]
    return out.reshape(pieces, AXES * knots, len(LAW_AXES) * knots)
