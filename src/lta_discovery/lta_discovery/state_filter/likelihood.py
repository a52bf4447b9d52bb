# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The likelihood of all readings of some flights, as a quadratic form in the parameters.

Parameters that a flight has of its own, such as its lift and the biases of its sensors, are
eliminated from the products of the filter.
"""

from collections.abc import Sequence
import math
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.parallel import map_parallel
from lta_discovery.state_filter.kalman import filter_flight, FilteredFlight, Indices
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
from lta_discovery.state_filter.noise_model import NoiseModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIMULATION_RAN_AWAY: Final = (
    'The simulation of the recorded flights with this vehicle file diverges; correct the vehicle '
    'file first.'
)


@final
class ParameterPrior(NamedTuple):
    """Assumptions about parameters before a fit, relative to the vehicle file, each (K,)."""

    deviation: Array
    low: Array
    high: Array
    own: NDArray[np.bool_]  # whether each flight has it of its own

    @classmethod
    def of(cls, parameters: Sequence[FreeParameter]) -> 'ParameterPrior':
        """Return the assumptions of parameters, whose tolerances are their deviations."""
        return cls(
            np.array([one.tolerance for one in parameters]),
            np.array([one.low for one in parameters]),
            np.array([one.high for one in parameters]),
            np.array([one.per_flight for one in parameters], dtype=np.bool_),
        )

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which parameters the flights share."""
        free: NDArray[np.bool_] = (self.deviation > 0.0) & ~self.own
        return free

    @property
    def precision(self) -> Array:
        """Inverse variances, 1 of those that are fixed."""
        return np.where(self.deviation > 0.0, self.deviation, 1.0) ** -2.0

    @property
    def of_flight(self) -> 'ParameterPrior':
        """Return the assumptions about what each flight has of its own."""
        own = self.own
        return ParameterPrior(self.deviation[own], self.low[own], self.high[own], own[own])

    def limit(self, values: Array, longest: float) -> 'ParameterPrior':
        """Return the prior with bounds as near to some values as a step may go."""
        most = longest * self.deviation
        low, high = np.maximum(self.low, values - most), np.minimum(self.high, values + most)
        return self._replace(low=low, high=high)

    def step(
        self,
        values: Array,
        inner: Array,
        pull: Array,
        damping: float = 0.0,
        longest: float = math.inf,
    ) -> Array:
        """
        Return the values after a bounded Newton step.

        `damping`: of the method of Levenberg and Marquardt. `longest`: how far a parameter may
        move, in prior deviations.
        """
        free = self.free
        out = values.copy()
        own = inner[np.ix_(free, free)]
        change = np.linalg.solve(own + damping * np.diag(np.diag(own)), pull[free])
        most = longest * self.deviation[free]
        out[free] = np.clip(
            values[free] + np.clip(change, -most, most), self.low[free], self.high[free]
        )
        return out


def linearize_all(
    systems: Sequence[FlightSystem],
    nominal: NominalVehicle,
    values: Array,
    columns: NDArray[np.bool_] | None = None,
) -> list[LinearFlight]:
    """
    Linearize flights with the same parameters about shared values.

    `columns`: as in `FlightSystem.linearize`. Raise `BadInput` for an impossible vehicle.
    """
    point = systems[0].build_point(nominal, values, columns)

    def linearize(system: FlightSystem) -> LinearFlight:
        with np.errstate(over='ignore', invalid='ignore'):
            flight = system.linearize_about(point)
        if not flight.is_finite:
            raise BadInput(SIMULATION_RAN_AWAY)
        return flight

    return map_parallel(linearize, systems)


def filter_all(
    flights: Sequence[LinearFlight],
    noise: Sequence[NoiseModel],
    starts: Sequence[Indices] | None = None,
) -> list[FilteredFlight]:
    """Filter flights, each with its noise; `starts`: as in `filter_flight`, of each flight."""
    every = [None] * len(flights) if starts is None else starts
    return map_parallel(
        lambda one: filter_flight(*one), list(zip(flights, noise, every, strict=True))
    )


def spread_out(inner: NDArray[np.floating], free: NDArray[np.bool_]) -> Array:
    """Return a matrix of the free parameters among all."""
    out = np.zeros((len(free), len(free)))
    out[np.ix_(free, free)] = inner
    return out


@final
class LikelihoodSum(NamedTuple):
    """Likelihood of all readings about some values of the parameters."""

    inner: Array  # precision of the parameters, shape (K, K)
    pull: Array  # shape (K,)
    cost: float  # negative log density at the values themselves [nats]
    evidence: float  # log density whatever the parameters, as far as they are linear [nats]
    near_evidence: float  # the same for parameters near the values [nats]

    def step(self, prior: ParameterPrior, values: Array, damping: float, longest: float) -> Array:
        """Return the best values as far as the flights are linear; see `ParameterPrior.step`."""
        return prior.step(values, self.inner, self.pull, damping, longest)


def sum_likelihoods(
    filtered: Sequence[FilteredFlight], prior: ParameterPrior, values: Array
) -> LikelihoodSum:
    """Return the likelihood of all readings about some values."""
    inner, pull = np.diag(prior.precision), -values * prior.precision
    evidence = 0.5 * float(np.sum((pull * values + np.log(prior.precision))[prior.free]))
    for one in filtered:
        products, more = eliminate_own(one.products, prior)
        evidence += more - 0.5 * one.log_determinant - 0.5 * float(products[-1, -1])
        inner += products[:-1, :-1]
        pull -= products[:-1, -1]
    cost = -evidence
    free = np.ix_(prior.free, prior.free)
    change = np.linalg.solve(inner[free], pull[prior.free])
    evidence -= 0.5 * float(np.linalg.slogdet(inner[free])[1])
    further = 0.5 * float(pull[prior.free] @ change)
    return LikelihoodSum(inner, pull, cost, evidence + further, evidence)


def eliminate_own(products: Array, prior: ParameterPrior) -> tuple[Array, float]:
    """Return products without what the flight has of its own, and the evidence of that."""
    own = np.flatnonzero(prior.own)
    if not len(own):
        return products, 0.0
    inner = products[np.ix_(own, own)] + np.diag(prior.deviation[own] ** -2.0)
    across = products[own]
    left = products - across.T @ np.linalg.solve(inner, across)
    size = np.linalg.slogdet(inner)[1] + 2.0 * np.sum(np.log(prior.deviation[own]))
    return left, -0.5 * float(size)


def list_pulls(filtered: FilteredFlight, prior: ParameterPrior) -> Array:
    """
    Return the pull of each piece of a flight, between the starts of its filter, shape (B, K).

    What the flight has of its own has its most probable values.
    """
    products, own = filtered.products, np.flatnonzero(prior.own)
    parts = np.diff(np.concatenate([filtered.sums, products[None]]), axis=0, prepend=0.0)
    rest = np.eye(len(products))
    inner = products[np.ix_(own, own)] + np.diag(prior.deviation[own] ** -2.0)
    rest[own] = -np.linalg.solve(inner, products[own])
    rest[:, own] = 0.0
    pulls: Array = -(rest.T @ parts @ rest[:, -1])[:, :-1]
    return pulls


def build_moments_root(products: Array, prior: ParameterPrior, mean: Array, root: Array) -> Array:
    """
    Return a square root of the second moments of all parameters of a flight and of 1.

    `mean`: of the shared parameters, shape (K,). `root`: a square root of the covariance of the
    free ones, shape (F, F).
    """
    free, own = np.flatnonzero(prior.free), np.flatnonzero(prior.own)
    out = np.zeros((len(mean) + 1, len(free) + len(own) + 1))
    out[free, : len(free)], out[free, -1], out[-1, -1] = root, mean[free], 1.0
    if len(own):
        inner = products[np.ix_(own, own)] + np.diag(prior.deviation[own] ** -2.0)
        out[own] = -np.linalg.solve(inner, products[own] @ out)
        out[own, len(free) : -1] = np.linalg.inv(np.linalg.cholesky(inner)).T
    return out


def estimate_own(products: Array, prior: ParameterPrior, covariance: Array) -> tuple[Array, Array]:
    """
    Return what a flight has of its own, and its covariance, 0 for other parameters.

    `covariance`: of the shared parameters, whose error its estimate shares.
    """
    own = np.flatnonzero(prior.own)
    values = np.zeros(len(prior.own))
    inner = products[np.ix_(own, own)] + np.diag(prior.deviation[own] ** -2.0)
    values[own] = -np.linalg.solve(inner, products[own, -1])
    slopes = np.linalg.solve(inner, products[own, :-1] * prior.free)
    spread = np.linalg.inv(inner) + slopes @ covariance @ slopes.T
    return values, spread_out(spread, prior.own)
