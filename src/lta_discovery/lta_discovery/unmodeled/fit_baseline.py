"""
Marginalize fitted flights for generic term groups.

As in `evidence`, the unknowns of pieces, per-flight and shared parameters are eliminated. The
result for a group are its products with itself and with the residual.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import final, NamedTuple

from lta_discovery.fit.evidence import log_prior, Prior, unknown_precision
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.fit.triangular import invert_lower
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.linearized_flight import LinearizedFlight
from lta_discovery.replay.variational_equation import WIDTH
from lta_discovery.unmodeled.generic_terms import TermGroup
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class FitBaseline:
    """A joint fit, as the baseline of generic rivals."""

    linears: tuple[LinearizedFlight, ...]  # each about its point
    at: Array  # shared parameters, shape (G,)
    variance: Array  # of per-flight parameters; 0 for shared ones, shape (G,)
    prior: Prior
    # Of the latent wrench, and its noise floor, shape (6,) [N, N m]
    deviations: Array
    floor: Array
    evidence: float  # log evidence, including the prior of the deviations [nats]

    @classmethod
    def from_joint(cls, joint: JointFit, floor: Array) -> 'FitBaseline':
        """Return the baseline of a joint fit."""
        group = joint.group
        return cls(
            group.linears, group.at, group.variance, joint.prior, joint.deviations, floor,
            joint.evidence,
        )  # fmt: skip

    @classmethod
    def from_part(cls, joint: JointFit, which: slice, floor: Array) -> 'FitBaseline':
        """Return the baseline of some flights of a joint fit, with their own evidence."""
        every = cls.from_joint(joint, floor)
        some = replace(every, linears=every.linears[which])
        # No groups: only the evidence of these flights is needed
        base = TermColumns(some, [()] * len(some.linears)).reduce_groups(some.deviations, ()).base
        return replace(some, evidence=base + log_prior(some.deviations, floor))


@final
class GroupProducts(NamedTuple):
    """Marginal products of groups: log evidence without them, and products of each."""

    base: float
    inner: Mapping[str, Array]
    right: Mapping[str, Array]


@final
class _GroupColumns(NamedTuple):
    """Products of a group's columns with the pieces' unknowns, the rest, and themselves."""

    along: Array
    aside: Array
    own: Array


@final
class _FlightColumns:
    """Columns of all groups on one flight."""

    def __init__(
        self, linear: LinearizedFlight, baseline: FitBaseline, groups: Sequence[TermGroup]
    ) -> None:
        grams, random = linear.grams, linear.unknown_count
        latent = slice(WIDTH, random - 1)
        self._point = linear.point
        self._rows = -0.5 * np.log(2.0 * np.pi) * float(linear.rows.sum())
        self._random, self._cross = grams[:, :random, :random], grams[:, :random, random:]
        self._rest = grams[:, random:, random:].sum(axis=0)
        self._columns: dict[str, _GroupColumns] = {}
        for group in groups:
            # Each term is a fixed combination of the latent knots, so its products follow
            weights = np.swapaxes(group.values.reshape(*group.values.shape[:2], -1), 1, 2)
            along = grams[:, :, latent] @ weights
            own = (np.swapaxes(weights, 1, 2) @ along[:, latent]).sum(axis=0)
            # Weights are shared by all pieces, so their products add up
            aside = along[:, random:].sum(axis=0)
            self._columns[group.name] = _GroupColumns(along[:, :random], aside, own)
        self._own = np.flatnonzero(baseline.variance)
        self._variance = baseline.variance[self._own]
        off = baseline.at - linear.point.values
        self._mean = off[self._own]
        self._shift = np.eye(len(off) + 1)
        # Moves the residual to the common shared parameters
        self._shift[:-1, -1] = -np.where(baseline.variance > 0.0, 0.0, off)

    def reduce_groups(
        self, deviations: Array, names: Sequence[str]
    ) -> tuple[float, Array, dict[str, tuple[Array, Array]]]:
        """Return constant, products of parameters and residual, and those of each group."""
        precision = unknown_precision(deviations, self._point.knots)
        mean = -self._point.random
        pull = mean @ precision
        root = np.linalg.cholesky(self._random + precision)
        cross = self._cross.copy()
        cross[:, :, -1] += pull
        # Invert once: each of dozens of groups then needs a product only.
        back = invert_lower(root)
        # Triangular solve by a product with the inverse Cholesky factor
        half = back @ cross
        products = self._rest - np.einsum('skg,skh->gh', half, half, optimize=True)
        products[-1, -1] += float(np.sum(pull * mean))
        constant = self._rows + 0.5 * float(np.linalg.slogdet(precision)[1]) * len(root)
        constant -= float(np.log(np.diagonal(root, axis1=1, axis2=2)).sum())
        products = self._shift.T @ products @ self._shift
        reduced = {}
        for name in names:
            columns = self._columns[name]
            mine = back @ columns.along
            aside = columns.aside - np.einsum('skg,skj->gj', half, mine, optimize=True)
            # Schur complement of the pieces' unknowns
            alone = columns.own - np.einsum('ski,skj->ij', mine, mine, optimize=True)
            reduced[name] = self._shift.T @ aside, alone
        return self._eliminate_own_parameters(constant, products, reduced)

    def _eliminate_own_parameters(
        self, constant: float, products: Array, group_products: dict[str, tuple[Array, Array]]
    ) -> tuple[float, Array, dict[str, tuple[Array, Array]]]:
        """Eliminate the flight's own parameters."""
        own = self._own
        if not len(own):
            return constant, products, group_products
        root = np.linalg.cholesky(products[np.ix_(own, own)] + np.diag(1.0 / self._variance))
        cross = products[own].copy()
        cross[:, -1] += self._mean / self._variance
        half = solve_triangular(root, cross, lower=True)
        left = products - half.T @ half
        left[-1, -1] += float(np.sum(self._mean**2 / self._variance))
        constant -= 0.5 * float(np.log(self._variance).sum())
        constant -= float(np.log(np.diag(root)).sum())
        then = {}
        for name, (aside, alone) in group_products.items():
            mine = solve_triangular(root, aside[own], lower=True)
            then[name] = aside - half.T @ mine, alone - mine.T @ mine
        return constant, left, then


@final
class TermColumns:
    """
    Columns of all groups on jointly fitted flights.

    `groups`: all groups, in the same order for each flight.
    """

    def __init__(self, baseline: FitBaseline, groups: Sequence[Sequence[TermGroup]]) -> None:
        self.standing, self.known = baseline, groups
        self._flights = [
            _FlightColumns(linear, baseline, each)
            for linear, each in zip(baseline.linears, groups, strict=True)
        ]

    def reduce_groups(self, deviations: Array, names: Sequence[str]) -> GroupProducts:
        """Return marginal products of some groups, for some deviations of the latent wrench."""
        parts = map_parallel(lambda one: one.reduce_groups(deviations, names), self._flights)
        products = np.sum([part[1] for part in parts], axis=0)
        prior = self.standing.prior
        free = np.flatnonzero(prior.free)
        wide = prior.covariance[np.ix_(free, free)]
        inverse, offset = np.linalg.inv(wide), (prior.mean - self.standing.at)[free]
        lower = np.linalg.cholesky(products[np.ix_(free, free)] + inverse)
        right = products[free, -1] + inverse @ offset
        seen = solve_triangular(lower, right, lower=True)
        base = sum(part[0] for part in parts) - 0.5 * float(np.linalg.slogdet(wide)[1])
        base -= float(np.log(np.diag(lower)).sum())
        base -= 0.5 * float(products[-1, -1] + offset @ inverse @ offset - seen @ seen)
        inners, rights = {}, {}
        for name in names:
            aside = np.sum([part[2][name][0] for part in parts], axis=0)
            alone = np.sum([part[2][name][1] for part in parts], axis=0)
            left = solve_triangular(lower, aside[free], lower=True)
            # Shared parameters are eliminated last
            inners[name], rights[name] = alone - left.T @ left, aside[-1] - left.T @ seen
        return GroupProducts(base, inners, rights)
