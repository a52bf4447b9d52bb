"""
Flights of one vehicle together: what they share, and what is each one's own.

Knobs are shared; the errors of a flight's sensors and its lift (`own_variance`) are drawn anew for
each, about what is shared where they are candidates themselves. They are eliminated flight by
flight, so that the cost grows with the flights and not with its square.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final, NamedTuple

from lta_discovery.fit.evidence import eliminated, Fitted, Pieces, Reduced
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.linear import Linear, Point
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Moved(NamedTuple):
    """Where a flight goes when the shared knobs move: its values, and its pieces' unknowns."""

    values: Array
    random: Array


@final
@dataclass(frozen=True, slots=True)
class Group:
    """
    Flights about a point.

    Attributes
    ----------
    pieces : tuple of Pieces
        Of each flight.
    at : ndarray, shape (G,)
        What the flights share of the knobs. A flight's point may have other values; it is then
        taken to be as linear as about its own.
    variance : ndarray, shape (G,)
        Of what is a flight's own; 0 where it has nothing of its own.

    """

    pieces: tuple[Pieces, ...]
    at: Array
    variance: Array

    @property
    def linears(self) -> tuple[Linear, ...]:
        """Each flight about its point."""
        return tuple(each.linear for each in self.pieces)

    @property
    def aligned(self) -> bool:
        """Whether all flights stand where the group does, but for what is their own."""
        same = self.variance == 0.0
        return all(
            np.allclose(each.point.values[same], self.at[same], rtol=1e-9, atol=1e-12)
            for each in self.linears
        )

    def joined(self, other: 'Group') -> 'Group':
        """Return the flights of both, about the point of this one."""
        return replace(self, pieces=(*self.pieces, *other.pieces))

    def narrowed(self, free: NDArray[np.bool_]) -> tuple['Group', NDArray[np.int64]]:
        """Return the flights with only such columns as move, and which these are."""
        apart = np.any([each.point.values != self.at for each in self.linears], axis=0)
        kept = np.flatnonzero(free | (self.variance > 0.0) | apart)
        pieces = tuple(each.narrowed(kept) for each in self.pieces)
        return Group(pieces, self.at[kept], self.variance[kept]), kept

    def reduced(self, deviations: Array) -> Reduced:
        """
        Return what the flights say of what they share.

        Parameters
        ----------
        deviations : ndarray, shape (6,)
            Of the latent force [N] and moment [N m].

        """
        return self.together(map_parallel(lambda each: each.reduced(deviations), self.pieces))

    def together(self, reduced: Sequence[Reduced]) -> Reduced:
        """Return what flights say of what they share, each without its pieces' unknowns."""
        both = zip(self.pieces, reduced, strict=True)
        parts = [self._without_own(each, alone) for each, alone in both]
        products = np.sum([part.products for part in parts], axis=0)
        return Reduced(products, sum(part.constant for part in parts))

    def _aligned(self, point: Point, reduced: Reduced) -> Array:
        """Return a flight's products about where the group stands."""
        off = np.where(self.variance > 0.0, 0.0, self.at - point.values)
        if not off.any():
            return reduced.products
        shift = np.eye(len(reduced.products))
        shift[:-1, -1] = -off
        there: Array = shift.T @ reduced.products @ shift
        return there

    def _own(self) -> NDArray[np.int64]:
        """Return the places of what is a flight's own."""
        return np.flatnonzero(self.variance)

    def _without_own(self, pieces: Pieces, reduced: Reduced) -> Reduced:
        """Return a flight's products without what is its own."""
        own, point = self._own(), pieces.linear.point
        products = self._aligned(point, reduced)
        if not len(own):
            return Reduced(products, reduced.constant)
        left, constant = eliminated(
            products[None],
            np.arange(len(products)),
            own,
            np.diag(1.0 / self.variance[own]),
            (self.at - point.values)[None, own],
        )
        return Reduced(left[0], reduced.constant + float(constant[0]))

    def moved(self, deviations: Array, target: Array) -> list[Moved]:
        """
        Return where each flight is most probable, given what is shared.

        Parameters
        ----------
        deviations : ndarray, shape (6,)
            Of the latent wrench.
        target : ndarray, shape (G,)
            What is shared.

        """
        out, own = [], self._own()
        for each in self.pieces:
            values = target.copy()
            if len(own):
                answer, left = self._answer(each, each.reduced(deviations))
                values[own] += left - answer @ (target - self.at)
            random = each.solved(deviations, values - each.linear.point.values)
            out.append(Moved(values, random))
        return out

    def _answer(self, pieces: Pieces, reduced: Reduced) -> tuple[Array, Array]:
        """Return how a flight's own answers to what is shared, and itself where that stays."""
        own, point = self._own(), pieces.linear.point
        products = self._aligned(point, reduced)
        inner = products[np.ix_(own, own)] + np.diag(1.0 / self.variance[own])
        before = (point.values - self.at)[own]
        right = products[own, -1] - before / self.variance[own]
        # The column of what is shared is that of what is own.
        inverse = np.asarray(np.linalg.inv(inner), dtype=np.float64)
        return inverse @ products[own, :-1], before + inverse @ right

    def of_flight(self, pieces: Pieces, reduced: Reduced, fitted: Fitted) -> Fitted:
        """Return the knobs of one flight: what is shared, and what is its own."""
        own = self._own()
        if not len(own):
            return fitted
        answer, left = self._answer(pieces, reduced)
        mean, through = fitted.mean.copy(), np.eye(len(self.at))
        mean[own] += left - answer @ (fitted.mean - self.at)
        through[own] -= answer
        covariance: Array = through @ fitted.covariance @ through.T
        inner = reduced.products[np.ix_(own, own)] + np.diag(1.0 / self.variance[own])
        covariance[np.ix_(own, own)] += np.linalg.inv(inner)
        return Fitted(fitted.log_evidence, mean, covariance)
