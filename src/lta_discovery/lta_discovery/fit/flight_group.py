"""
Combine flights of one vehicle: shared parameters, and those of each flight.

Sensor errors and lift of a flight (`per_flight_variance`) are drawn for each flight, about the
shared value if they are candidates too. They are eliminated flight by flight, so that the cost is
linear in the number of flights.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final, NamedTuple

from lta_discovery.fit.evidence import (
    eliminate_columns,
    ParameterPosterior,
    PieceReducer,
    ReducedFlight,
)
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.linearized_flight import LinearizationPoint, LinearizedFlight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class FlightSolution(NamedTuple):
    """A flight's parameters, and the unknowns of its pieces."""

    values: Array
    random: Array


@final
@dataclass(frozen=True, slots=True)
class LinearizedGroup:
    """Flights, linearized about a common point."""

    pieces: tuple[PieceReducer, ...]
    # Shared parameters. If a flight was linearized at others, its linearization is extrapolated.
    # Shape (G,)
    at: Array
    variance: Array  # of each flight's own parameters; 0 for shared ones, shape (G,)

    @property
    def linears(self) -> tuple[LinearizedFlight, ...]:
        """Each flight about its point."""
        return tuple(each.linear for each in self.pieces)

    @property
    def is_aligned(self) -> bool:
        """Whether all flights were linearized at the shared parameters of the group."""
        same = self.variance == 0.0
        return all(
            np.allclose(each.point.values[same], self.at[same], rtol=1e-9, atol=1e-12)
            for each in self.linears
        )

    def combine_groups(self, other: 'LinearizedGroup') -> 'LinearizedGroup':
        """Return the flights of both, about the point of this one."""
        return replace(self, pieces=(*self.pieces, *other.pieces))

    def select(self, free: NDArray[np.bool_]) -> tuple['LinearizedGroup', NDArray[np.int64]]:
        """Return the flights with the free columns only, and the indices of these."""
        # Columns of extrapolated parameters stay: `_align_products` needs them
        apart = np.any([each.point.values != self.at for each in self.linears], axis=0)
        indices = np.flatnonzero(free | (self.variance > 0.0) | apart)
        pieces = tuple(each.select(indices) for each in self.pieces)
        return LinearizedGroup(pieces, self.at[indices], self.variance[indices]), indices

    def reduce_flights(self, deviations: Array) -> ReducedFlight:
        """Return the combined products of the flights for the shared parameters."""
        return self.sum_flights(
            map_parallel(lambda each: each.eliminate_unknowns(deviations), self.pieces)
        )

    def sum_flights(self, reduced: Sequence[ReducedFlight]) -> ReducedFlight:
        """Sum flights with eliminated piece unknowns, eliminating their own parameters."""
        both = zip(self.pieces, reduced, strict=True)
        parts = [self._eliminate_own_parameters(each, alone) for each, alone in both]
        products = np.sum([part.products for part in parts], axis=0)
        return ReducedFlight(products, sum(part.constant for part in parts))

    def _align_products(self, point: LinearizationPoint, reduced: ReducedFlight) -> Array:
        """Return a flight's products about the point of the group."""
        # Per-flight parameters stay at the flight's point; only shared ones move
        off = np.where(self.variance > 0.0, 0.0, self.at - point.values)
        if not off.any():
            return reduced.products
        shift = np.eye(len(reduced.products))
        # Moves the residual to the shared parameters: r - C (at - point)
        shift[:-1, -1] = -off
        there: Array = shift.T @ reduced.products @ shift
        return there

    def _own_parameter_indices(self) -> NDArray[np.int64]:
        """Return the indices of per-flight parameters."""
        return np.flatnonzero(self.variance)

    def _eliminate_own_parameters(
        self, pieces: PieceReducer, reduced: ReducedFlight
    ) -> ReducedFlight:
        """Eliminate a flight's own parameters."""
        own, point = self._own_parameter_indices(), pieces.linear.point
        products = self._align_products(point, reduced)
        if not len(own):
            return ReducedFlight(products, reduced.constant)
        # A stack of one, because `eliminate_columns` works on stacks of pieces
        left, constant = eliminate_columns(
            products[None],
            np.arange(len(products)),
            own,
            np.diag(1.0 / self.variance[own]),
            (self.at - point.values)[None, own],
        )
        return ReducedFlight(left[0], reduced.constant + float(constant[0]))

    def solve_flights(self, deviations: Array, target: Array) -> list[FlightSolution]:
        """Return the most probable parameters and unknowns of each flight, for shared values."""
        out, own = [], self._own_parameter_indices()
        for each in self.pieces:
            values = target.copy()
            if len(own):
                answer, left = self._own_response(each, each.eliminate_unknowns(deviations))
                values[own] += left - answer @ (target - self.at)
            random = each.solve_unknowns(deviations, values - each.linear.point.values)
            out.append(FlightSolution(values, random))
        return out

    def _own_response(self, pieces: PieceReducer, reduced: ReducedFlight) -> tuple[Array, Array]:
        """Return the response of own to shared parameters, and their own change."""
        own, point = self._own_parameter_indices(), pieces.linear.point
        products = self._align_products(point, reduced)
        inner = products[np.ix_(own, own)] + np.diag(1.0 / self.variance[own])
        before = (point.values - self.at)[own]
        right = products[own, -1] - before / self.variance[own]
        # Shared and own part of a parameter have the same column.
        inverse = np.asarray(np.linalg.inv(inner), dtype=np.float64)
        return inverse @ products[own, :-1], before + inverse @ right

    def flight_posterior(
        self, pieces: PieceReducer, reduced: ReducedFlight, posterior: ParameterPosterior
    ) -> ParameterPosterior:
        """Return the posterior of one flight: shared plus own parameters."""
        own = self._own_parameter_indices()
        if not len(own):
            return posterior
        answer, left = self._own_response(pieces, reduced)
        mean, through = posterior.mean.copy(), np.eye(len(self.at))
        # The flight's value is the shared value plus its own deviation from it
        mean[own] += left - answer @ (posterior.mean - self.at)
        # Uncertainty of the shared values, as passed on through the own ones
        through[own] -= answer
        covariance: Array = through @ posterior.covariance @ through.T
        inner = reduced.products[np.ix_(own, own)] + np.diag(1.0 / self.variance[own])
        covariance[np.ix_(own, own)] += np.linalg.inv(inner)
        return ParameterPosterior(posterior.log_evidence, mean, covariance)
