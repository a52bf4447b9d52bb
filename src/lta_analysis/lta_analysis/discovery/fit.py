"""
The most probable parameters of flights, and how much force they leave unexplained.

Gauss-Newton: linearise, find the deviations of the latent wrench that make the data most probable,
move knobs, states and knots to where they are most probable then, and again, until the evidence
rests.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_analysis.discovery.deviations import weighed
from lta_analysis.discovery.evidence import (
    Fitted,
    fitted,
    FLOOR,
    Pieces,
    Prior,
    Reduced,
    strain,
)
from lta_analysis.discovery.group import Group, Moved, own_pull, pull_of
from lta_analysis.discovery.knobs import Knob
from lta_analysis.discovery.linear import Linear, Point
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.nominal import Nominal
from lta_analysis.discovery.replay import STEPS
from lta_config.errors import BadInput
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REST: Final = 0.7  # nats; below it the evidence has come to rest
ROUNDS: Final = 6
SHARES: Final = (1.0, 0.5, 0.2, 0.05)  # of a step of Gauss-Newton
WORSE: Final = 1.0  # in minus twice the log density; by which a step may be


@final
@dataclass(frozen=True, slots=True)
class Fit:
    """
    One flight, fitted, by itself or with others.

    Attributes
    ----------
    linear : Linear
        About the last point.
    pieces : Pieces
        Of it.
    reduced : Reduced
        Of them, with the deviations.
    deviations : ndarray, shape (6,)
        Of the latent force [N] and moment [N m].
    fitted : Fitted
        The knobs.
    evidence : float
        Log evidence of all flights that were fitted with it, with that of the deviations. [nats]
    rounds : int
        Linearisations.

    """

    linear: Linear
    pieces: Pieces
    reduced: Reduced
    deviations: Array
    fitted: Fitted
    evidence: float
    rounds: int


@final
@dataclass(frozen=True, slots=True)
class Joint:
    """
    Flights that share a vehicle, fitted together.

    Attributes
    ----------
    group : Group
        About the last point.
    prior : Prior
        Of what they share.
    reduced : Reduced
        What they say of that, with the deviations.
    deviations, fitted, evidence, rounds
        As for `Fit`; what is fitted is what they share.

    """

    group: Group
    prior: Prior
    reduced: Reduced
    deviations: Array
    fitted: Fitted
    evidence: float
    rounds: int

    @property
    def members(self) -> tuple[Fit, ...]:
        """Each flight, with the errors of its own sensors."""
        out = []
        for each in self.group.pieces:
            own = each.reduced(self.deviations)
            knobs = self.group.of_flight(each, own, self.fitted)
            rest = (self.deviations, knobs, self.evidence, self.rounds)
            out.append(Fit(each.linear, each, own, *rest))
        return tuple(out)


def turned(nominal: Nominal, knobs: Sequence[Knob], values: Array) -> tuple[Nominal, Array]:
    """Return the vehicle with its knobs at values, and those values within their bounds."""
    out = within(knobs, values)
    for k, knob in enumerate(knobs):
        if out[k] != 0.0:
            nominal = knob.turned(nominal, float(out[k]))
    return nominal, out


def within(knobs: Sequence[Knob], values: Array) -> Array:
    """Return values within their bounds; the last, of SENSORS, have none."""
    out = values.copy()
    for k, knob in enumerate(knobs):
        out[k] = min(max(values[k], knob.low), knob.high)
    return out


@final
@dataclass(frozen=True, slots=True)
class Fitter:
    """
    Flights to be fitted together.

    Attributes
    ----------
    nominal : Nominal
        The vehicle as its file has it: where all knobs are at 0.
    flights : sequence of Linearised
        Of it.
    variance : ndarray, shape (G,)
        Of what is each flight's own.
    floor : ndarray, shape (6,)
        Deviations of the latent wrench that are not worth speaking of.

    """

    nominal: Nominal
    flights: Sequence[Linearised]
    variance: Array
    floor: Array

    def about(self, at: Array, points: Sequence[Point]) -> Group:
        """Return the flights about points; `BadInput` where no such vehicle can be."""
        pieces = [Pieces(each.at(point)) for each, point in zip(self.flights, points, strict=True)]
        return Group(tuple(pieces), at, self.variance)

    def fit(self, prior: Prior, begin: Group, deviations: Array, rounds: int = ROUNDS) -> Joint:
        """
        Fit them.

        Parameters
        ----------
        prior : Prior
            Of what they share: which knobs are free, and how far.
        begin : Group
            The flights about where to begin.
        deviations : ndarray, shape (6,)
            Of the latent wrench, to begin with.
        rounds : int
            Linearisations at most.

        Returns
        -------
        Joint
            About the last point: what a linearisation promises counts only once it has been flown.

        """
        last = self.settled(begin, prior, deviations)
        for count in range(2, rounds + 1):
            group = self._onward(last)
            if group is last.group:
                break
            now = self.settled(group, prior, last.deviations, count)
            rests = last.group.aligned and abs(now.evidence - last.evidence) < REST
            last = now
            if rests:
                break
        return last

    def settled(self, group: Group, prior: Prior, start: Array, count: int = 1) -> Joint:
        """Return flights with the deviations most probable, about where they are."""
        deviations, evidence = weighed(group, prior, start, self.floor)
        reduced = group.reduced(deviations)
        found = fitted(reduced, group.at, prior)
        return Joint(group, prior, reduced, deviations, found, evidence, count)

    def _onward(self, last: Joint) -> Group:
        """Return the flights about the next point: the whole step, or a part that is better."""
        group, knobs = last.group, self.flights[0].knobs
        target = within(knobs, last.fitted.mean)
        moves = group.moved(last.deviations, target)
        # Flights that do not stand together yet have no common misfit to begin with.
        bound = self._misfit(last, group.at, [each.point for each in group.linears]) + WORSE
        found = []
        for share in SHARES:
            at = group.at + share * (target - group.at)
            try:
                points = self._between(group, moves, share)
                misfit = self._misfit(last, at, points)
            except BadInput:
                continue
            if share == 1.0 and (misfit < bound or not group.aligned) and np.isfinite(misfit):
                return self.about(at, points)
            found.append((misfit, at, points))
        misfit, at, points = min(found, key=lambda one: one[0], default=(np.inf, group.at, []))
        return self.about(at, points) if misfit < bound else group

    def _between(self, group: Group, moves: Sequence[Moved], share: float) -> list[Point]:
        """Return the points a part of the way to where the flights should go."""
        points = []
        for linear, move in zip(group.linears, moves, strict=True):
            was = linear.point
            values = was.values + share * (move.values - was.values)
            vehicle, values = turned(self.nominal, self.flights[0].knobs, values)
            random = was.random + share * (move.random - was.random)
            points.append(Point(vehicle, values, random))
        return points

    def _misfit(self, last: Joint, at: Array, points: Sequence[Point]) -> float:
        """
        Return minus twice the log density of the data and of all unknowns at a point.

        Less what does not depend on the point; inf where a flight ran away. What a step of
        Gauss-Newton has to make smaller.
        """
        total = pull_of(at, last.prior)
        for flight, point in zip(self.flights, points, strict=True):
            with np.errstate(over='ignore', invalid='ignore'):
                grid = flight.trajectory(point)[:, ::STEPS]
                if not np.isfinite(grid).all():
                    return np.inf
                left = flight.left(grid, point, point.nominal.rows()) / flight.replay.flight.noise
                total += float(np.nansum(left**2)) + strain(point, last.deviations)
            total += own_pull(point.values, at, self.variance)
        return total


def fit(
    flight: Linearised,
    nominal: Nominal,
    prior: Prior,
    begin: Point,
    deviations: Array = FLOOR,
    rounds: int = ROUNDS,
) -> Fit:
    """
    Fit one flight by itself.

    Parameters
    ----------
    flight, nominal, deviations, rounds
        As for `Fitter`.
    prior : Prior
        Of all knobs, its own and others: `tolerances`.
    begin : Point
        Where to begin.

    """
    alone = Fitter(nominal, [flight], np.zeros(len(begin.values)), FLOOR)
    group = alone.about(begin.values, [begin])
    return alone.fit(prior, group, deviations, rounds).members[0]
