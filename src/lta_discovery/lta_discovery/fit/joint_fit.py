"""
The most probable parameters of flights, and how much force they leave unexplained.

Gauss-Newton: linearise, find the deviations of the latent wrench that make the data most probable,
move knobs, states and knots to where they are most probable then, and again, until the evidence
rests.
"""

from collections.abc import Sequence
import contextlib
from dataclasses import dataclass, replace
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_discovery.fit.bounds import apply_parameters, parameter_bounds
from lta_discovery.fit.deviations import fit_deviations
from lta_discovery.fit.evidence import (
    compute_posterior,
    FLOOR,
    ParameterPosterior,
    PieceReducer,
    Prior,
    ReducedFlight,
)
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.fit.misfit import compute_misfit, forecast_error, predict_linear_misfit
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.linearized_flight import LinearizationPoint, LinearizedFlight
from lta_discovery.replay.linearizer import FlightLinearizer
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REST: Final = 0.7  # nats; below it the evidence has come to rest
ROUNDS: Final = 12  # linearisations, at most
# Factors on the variance of the noise, where the whole step of Gauss-Newton makes things worse.
DOUBTS: Final = (4.0, 30.0, 300.0, 3e3, 3e4, 3e5, 3e6)
# Parts of the whole step, which are tried then as well: the others lead towards what is known
# beforehand, which is no way back from a point where a large latent wrench flies the flight.
PARTS: Final = (0.5, 0.2, 0.08, 0.03)
BROKEN: Final = 2.0  # of the misfit that was promised; beyond it shorter steps are looked at too
LEAP: Final = 1e3  # nats; a step that wins more has yet to arrive, and counts as no round
RAN_AWAY: Final = 'The model runs away from the flight; begin with a vehicle file nearer to it.'
WORSE: Final = 1.0  # in minus twice the log density; by which a step may be
ASTRAY: Final = 3.0  # times the error of unaided forecasts, beyond which no step may take it


@final
@dataclass(frozen=True, slots=True)
class FlightFit:
    """
    One flight, fitted, by itself or with others.

    Attributes
    ----------
    linear, pieces : Linear, Pieces
        About the last point.
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

    linear: LinearizedFlight
    pieces: PieceReducer
    reduced: ReducedFlight
    deviations: Array
    fitted: ParameterPosterior
    evidence: float
    rounds: int


@final
@dataclass(frozen=True, slots=True)
class JointFit:
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
        As for `FlightFit`; what is fitted is what they share.

    """

    group: LinearizedGroup
    prior: Prior
    reduced: ReducedFlight
    deviations: Array
    fitted: ParameterPosterior
    evidence: float
    rounds: int

    @property
    def members(self) -> tuple[FlightFit, ...]:
        """Each flight, with the errors of its own sensors."""
        out = []
        for each in self.group.pieces:
            own = each.reduce(self.deviations)
            knobs = self.group.flight_posterior(each, own, self.fitted)
            rest = (self.deviations, knobs, self.evidence, self.rounds)
            out.append(FlightFit(each.linear, each, own, *rest))
        return tuple(out)

    def reduce_sides(self, teach: int) -> tuple[ReducedFlight, ReducedFlight]:
        """Return what the first flights, so many of them, say of what all share, and the rest."""
        pieces = self.group.pieces
        first, second = (
            replace(self.group, pieces=part).reduce(self.deviations)
            for part in (pieces[:teach], pieces[teach:])
        )
        return first, second


@final
class FitStep(NamedTuple):
    """
    Where to linearise next.

    Attributes
    ----------
    at : ndarray, shape (G,)
        What the flights share.
    points : list of Point
        Of each flight.
    kept : float
        By how much the misfit there is not what was promised.
    whole : bool
        Whether it is the whole step.

    """

    at: Array
    points: list[LinearizationPoint]
    kept: float
    whole: bool


@final
@dataclass(frozen=True, slots=True)
class JointFitter:
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

    nominal: NominalVehicle
    flights: Sequence[FlightLinearizer]
    variance: Array
    floor: Array

    def linearize_flights(
        self, at: Array, points: Sequence[LinearizationPoint], prior: Prior | None = None
    ) -> LinearizedGroup:
        """
        Return the flights about points; `BadInput` where no such vehicle can be.

        With a prior they know only the columns of what it leaves free, which is faster where
        nobody asks what another knob would bring.
        """
        free = None if prior is None else prior.free | (self.variance > 0.0)

        def build_reducer(one: tuple[FlightLinearizer, LinearizationPoint]) -> PieceReducer:
            flight, point = one
            with np.errstate(over='ignore', invalid='ignore'):
                linear = flight.linearize(point, free)
            if not np.isfinite(linear.grams).all():
                raise BadInput(RAN_AWAY)
            try:
                return PieceReducer(linear)
            except np.linalg.LinAlgError:
                raise BadInput(RAN_AWAY) from None

        both = list(zip(self.flights, points, strict=True))
        return LinearizedGroup(tuple(map_parallel(build_reducer, both)), at, self.variance)

    def fit(
        self,
        prior: Prior,
        begin: LinearizedGroup,
        deviations: Array,
        rounds: int = ROUNDS,
        rest: float = REST,
        narrow: bool = False,
    ) -> JointFit:
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
        rounds, rest : int, float
            Linearisations at most; change of the evidence below which it has come to rest. [nats]
        narrow : bool
            Whether only the columns of what the prior leaves free are wanted, as of `begin`.

        Returns
        -------
        Joint
            About the last point but one, where flying the last kept what was promised there.

        """
        last, count = self.fit_deviations(begin, prior, deviations), 1
        while count < rounds:
            step = self._choose_step(last)
            if step is None or step.kept < 2.0 * rest:
                break
            try:
                there = self.linearize_flights(step.at, step.points, prior if narrow else None)
            except BadInput:
                if not last.group.is_aligned:
                    raise
                break  # flights that can be flown there, and not be said how they answer
            now = self.fit_deviations(there, prior, last.deviations, last.rounds + 1)
            rests = (
                last.group.is_aligned and step.whole and abs(now.evidence - last.evidence) < rest
            )
            count += now.evidence - last.evidence < LEAP or last.rounds > 3 * ROUNDS
            last = now
            if rests:
                break
        return last

    def propose_step(self, last: JointFit) -> tuple[Array, list[LinearizationPoint]]:
        """Return where flights are most probable after a fit: what they share, and points."""
        return self._move_to_mean(last, last.group, last.fitted.mean)

    def fit_deviations(
        self, group: LinearizedGroup, prior: Prior, start: Array, count: int = 1
    ) -> JointFit:
        """Return flights with the deviations most probable, about where they are."""
        try:
            deviations, evidence = fit_deviations(group, prior, start, self.floor)
            reduced = group.reduce(deviations)
            found = compute_posterior(reduced, group.at, prior)
        except np.linalg.LinAlgError:
            raise BadInput(RAN_AWAY) from None
        return JointFit(group, prior, reduced, deviations, found, evidence, count)

    def _choose_step(self, last: JointFit) -> FitStep | None:
        """
        Return the next point: the whole step, or a shorter one that is better, or None.

        Flights that do not stand at one point yet are brought there, if nothing is better.
        """
        group = last.group
        here = self._gather_points(group, last.deviations)
        bound, error = self._point_misfit(last, group.at, here), forecast_error(self.flights, here)
        at, points = self.propose_step(last)
        misfit = self._screen_misfit(last, at, points, error)
        found = []
        if misfit < bound + WORSE:
            linear = predict_linear_misfit(group, last.deviations, last.prior, at, points)
            if misfit < BROKEN * linear:
                return FitStep(at, points, abs(misfit - linear), True)
            found.append((misfit, at, points))
        for part in PARTS:
            between = self._interpolate_points(part, group.at, here, at, points)
            found.append((self._screen_misfit(last, *between, error), *between))
        for doubt in DOUBTS:
            with contextlib.suppress(BadInput, np.linalg.LinAlgError):
                doubted = self._propose_damped_step(last, doubt)
                found.append((self._screen_misfit(last, *doubted, error), *doubted))
        misfit, at, points = min(found, key=lambda one: one[0], default=(np.inf, group.at, []))
        if misfit < bound + WORSE:
            return FitStep(at, points, np.inf, False)
        return None if group.is_aligned else FitStep(group.at, here, np.inf, False)

    def compute_misfit(self, prior: Prior, group: LinearizedGroup, deviations: Array) -> float:
        """Return the misfit of flights where what they share is the same for all, flown."""
        points = self._gather_points(group, deviations)
        return compute_misfit(self.flights, deviations, prior, self.variance, group.at, points)

    def _gather_points(
        self, group: LinearizedGroup, deviations: Array
    ) -> list[LinearizationPoint]:
        """Return the points of flights where what they share is the same for all."""
        if group.is_aligned:
            return [each.point for each in group.linears]
        return self._solve_points(group, deviations, group.at)

    def _interpolate_points(
        self,
        part: float,
        at: Array,
        here: Sequence[LinearizationPoint],
        to: Array,
        there: Sequence[LinearizationPoint],
    ) -> tuple[Array, list[LinearizationPoint]]:
        """Return what is shared, and points, a part of the way from here to there."""
        points = []
        for one, other in zip(here, there, strict=True):
            values = one.values + part * (other.values - one.values)
            vehicle, values = apply_parameters(self.nominal, self.flights[0].knobs, values)
            random = one.random + part * (other.random - one.random)
            points.append(LinearizationPoint(vehicle, values, random))
        return at + part * (to - at), points

    def _screen_misfit(
        self, last: JointFit, at: Array, points: Sequence[LinearizationPoint], error: float
    ) -> float:
        """Return the misfit at a point, inf where its forecasts go astray, by those before."""
        misfit = self._point_misfit(last, at, points)
        if np.isfinite(misfit) and forecast_error(self.flights, points) > ASTRAY * error:
            return np.inf
        return misfit

    def _propose_damped_step(
        self, last: JointFit, doubt: float
    ) -> tuple[Array, list[LinearizationPoint]]:
        """Return where flights would go if their noise were larger: nearer to what is known."""
        pieces = [
            PieceReducer(replace(each, grams=each.grams / doubt)) for each in last.group.linears
        ]
        group = replace(last.group, pieces=tuple(pieces))
        found = compute_posterior(group.reduce(last.deviations), group.at, last.prior)
        return self._move_to_mean(last, group, found.mean)

    def _move_to_mean(
        self, last: JointFit, group: LinearizedGroup, mean: Array
    ) -> tuple[Array, list[LinearizationPoint]]:
        """Return what is shared, and the points of the flights, where that has a given mean."""
        at = np.clip(mean, *parameter_bounds(self.flights[0].knobs, last.prior))
        return at, self._solve_points(group, last.deviations, at)

    def _solve_points(
        self, group: LinearizedGroup, deviations: Array, at: Array
    ) -> list[LinearizationPoint]:
        """Return the points of flights that share some values."""
        points = []
        for move in group.solve_flights(deviations, at):
            vehicle, values = apply_parameters(self.nominal, self.flights[0].knobs, move.values)
            points.append(LinearizationPoint(vehicle, values, move.random))
        return points

    def _point_misfit(
        self, last: JointFit, at: Array, points: Sequence[LinearizationPoint]
    ) -> float:
        """Return the misfit at a point, flown."""
        return compute_misfit(self.flights, last.deviations, last.prior, self.variance, at, points)


def fit_flight(
    flight: FlightLinearizer,
    nominal: NominalVehicle,
    prior: Prior,
    begin: LinearizationPoint,
    deviations: Array = FLOOR,
    rounds: int = ROUNDS,
) -> FlightFit:
    """
    Fit one flight by itself.

    Parameters
    ----------
    flight, nominal, deviations, rounds
        As for `JointFitter`.
    prior : Prior
        Of all knobs, its own and others: `tolerances`.
    begin : Point
        Where to begin.

    """
    alone = JointFitter(nominal, [flight], np.zeros(len(begin.values)), FLOOR)
    group = alone.linearize_flights(begin.values, [begin])
    return alone.fit(prior, group, deviations, rounds).members[0]
