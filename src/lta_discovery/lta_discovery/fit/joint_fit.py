"""
Fit parameters and latent forces to flights by Gauss-Newton.

Each iteration linearizes, finds the deviations of the latent wrench with maximum evidence, and
moves parameters, states and knots to their most probable values, until the evidence converges.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_discovery.fit.bounds import apply_parameters, bound_mean, parameter_bounds
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
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint, LinearizedFlight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REST: Final = 0.7  # nats; convergence criterion of the evidence
ROUNDS: Final = 12  # most linearisations
# Weights on the distance of parameters from the present point, by their prior precision, which
# damp a step; tried in turn until one lowers the misfit
HOLDS: Final = (0.0, 1.0, 10.0, 100.0, 1e3, 1e4)
NEARLY: Final = 1.0  # largest of these weights with which a step counts as full
GAIN: Final = 0.1  # of the predicted gain in misfit; a step with less is damped more
BROKEN: Final = 2.0  # of the predicted misfit; above it unknowns of pieces are solved for again
SETTLED: Final = 3  # most times that these are solved for
LEAP: Final = 1e3  # nats; a step with a larger gain does not count as a round
RAN_AWAY: Final = (
    'The simulation of the recorded flights with this vehicle file diverges; correct the vehicle '
    'file first.'
)
WORSE: Final = 1.0  # in -2 log density; tolerated increase of a step
ASTRAY: Final = 3.0  # times the error of unaided forecasts; a step above it is rejected


@final
@dataclass(frozen=True, slots=True)
class FlightFit:
    """Fit of one flight, alone or with others."""

    # About the last point
    linear: LinearizedFlight
    pieces: PieceReducer
    reduced: ReducedFlight  # for the fitted deviations
    deviations: Array  # of the latent force [N] and moment, shape (6,) [N m]
    fitted: ParameterPosterior
    # Log evidence of all jointly fitted flights, including the prior of the deviations [nats]
    evidence: float
    rounds: int


@final
@dataclass(frozen=True, slots=True)
class JointFit:
    """Joint fit of flights of one vehicle."""

    group: LinearizedGroup  # about the last point
    prior: Prior
    reduced: ReducedFlight  # of the shared parameters, for the fitted deviations
    # As for `FlightFit`; fitted are the shared parameters
    deviations: Array
    fitted: ParameterPosterior
    evidence: float
    rounds: int
    # Whether it ended where the linearization holds, not because no step improved it
    is_converged: bool = False

    @property
    def members(self) -> tuple[FlightFit, ...]:
        """Each flight, with its own sensor errors."""
        out = []
        for each in self.group.pieces:
            # Reduced again, because the fit stores only the sum of all flights
            own = each.eliminate_unknowns(self.deviations)
            knobs = self.group.flight_posterior(each, own, self.fitted)
            rest = (self.deviations, knobs, self.evidence, self.rounds)
            out.append(FlightFit(each.linear, each, own, *rest))
        return tuple(out)

    def reduce_sides(self, teach: int) -> tuple[ReducedFlight, ReducedFlight]:
        """Return the reduced products of the first `teach` flights, and of the others."""
        pieces = self.group.pieces
        first, second = (
            replace(self.group, pieces=part).reduce_flights(self.deviations)
            for part in (pieces[:teach], pieces[teach:])
        )
        return first, second


@final
class FitStep(NamedTuple):
    """Next linearization point."""

    at: Array  # shared parameters, shape (G,)
    points: list[LinearizationPoint]  # of each flight
    misfit_gap: float  # difference between actual and predicted misfit
    whole: bool  # whether it is the full step, or nearly


@final
@dataclass(frozen=True, slots=True)
class JointFitter:
    """Fit flights jointly."""

    nominal: NominalVehicle  # the vehicle of the file, where all parameters are 0
    flights: Sequence[FlightLinearizer]
    variance: Array  # of per-flight parameters, shape (G,)
    floor: Array  # noise floor of the latent wrench, shape (6,)

    def linearize_flights(
        self, at: Array, points: Sequence[LinearizationPoint], prior: Prior | None = None
    ) -> LinearizedGroup:
        """
        Linearize the flights about points; raise `BadInput` for impossible vehicles.

        With a prior, only the columns of its free parameters are computed, which is faster.
        """
        # Per-flight parameters are free even where the shared prior fixes them
        free = None if prior is None else prior.free | (self.variance > 0.0)

        def reduce_flight(one: tuple[FlightLinearizer, LinearizationPoint]) -> PieceReducer:
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
        return LinearizedGroup(tuple(map_parallel(reduce_flight, both)), at, self.variance)

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
        Fit the flights.

        Parameters
        ----------
        rounds, rest : int, float
            Most linearizations; change of the evidence at convergence. [nats]
        narrow : bool
            Whether to compute only the columns of free parameters, as in `begin`.

        Returns
        -------
        JointFit
            About the last point, or the one before if the last step met its prediction.

        """
        last, count, converged = self.fit_deviations(begin, prior, deviations), 1, False
        while count < rounds and not converged:
            step = self._choose_step(last)
            if step is None:
                break
            # Misfit is -2 log density, so 2 units of it are 1 nat
            if step.misfit_gap < 2.0 * rest:
                converged = True
                break
            try:
                there = self.linearize_flights(step.at, step.points, prior if narrow else None)
                now = self.fit_deviations(there, prior, last.deviations, last.rounds + 1)
            except BadInput:
                break  # the point can be simulated, but not linearized
            converged = (
                last.group.is_aligned and step.whole and abs(now.evidence - last.evidence) < rest
            )
            # Large gains mean that the start was far away; they do not use up the rounds
            count += now.evidence - last.evidence < LEAP or last.rounds > 3 * ROUNDS
            last = now
        return replace(last, is_converged=converged)

    def propose_step(self, last: JointFit) -> tuple[Array, list[LinearizationPoint]]:
        """Return the most probable shared parameters and points after a fit."""
        return self._propose_held_step(last, 0.0)

    def fit_deviations(
        self, group: LinearizedGroup, prior: Prior, start: Array, count: int = 1
    ) -> JointFit:
        """Fit the deviations of the latent wrench, at the points of the flights."""
        try:
            deviations, evidence = fit_deviations(group, prior, start, self.floor)
            reduced = group.reduce_flights(deviations)
            posterior = compute_posterior(reduced, group.at, prior)
        except np.linalg.LinAlgError:
            raise BadInput(RAN_AWAY) from None
        return JointFit(group, prior, reduced, deviations, posterior, evidence, count)

    def _choose_step(self, last: JointFit) -> FitStep | None:
        """
        Return the next point: the full step, a damped one that is better, or None.

        Flights with different shared parameters are brought to common ones if nothing is better.
        """
        group = last.group
        here = self._gather_points(group, last.deviations)
        # Baseline: the simulated misfit at the present point
        bound, error = self._point_misfit(last, group.at, here), forecast_error(self.flights, here)
        best, least = None, bound + WORSE
        for hold in HOLDS:
            try:
                at, points = self._propose_held_step(last, hold)
            except np.linalg.LinAlgError:
                continue  # the flights determine no such step
            linear = predict_linear_misfit(group, last.deviations, last.prior, at, points)
            # A latent wrench can hide a wrong vehicle; unaided forecasts cannot
            if forecast_error(self.flights, points) > ASTRAY * error:
                continue
            misfit = self._point_misfit(last, at, points)
            if not (misfit < least and misfit < BROKEN * linear):
                misfit, points = self._settle_points(last, at, points, min(bound, linear) + WORSE)
            if misfit < least:
                gap = np.inf if hold else abs(misfit - linear)
                best, least = FitStep(at, points, gap, hold <= NEARLY), misfit
            # It predicts well here, and gains: stop before smaller steps
            if misfit < min(bound + WORSE - GAIN * max(bound - linear, 0.0), BROKEN * linear):
                break
        if best is not None:
            return best
        # Aligning the flights is worth a linearization even without a better point
        return None if group.is_aligned else FitStep(group.at, here, np.inf, False)

    def compute_misfit(self, prior: Prior, group: LinearizedGroup, deviations: Array) -> float:
        """Return the simulated misfit of flights with common shared parameters."""
        points = self._gather_points(group, deviations)
        return compute_misfit(self.flights, deviations, prior, self.variance, group.at, points)

    def _gather_points(
        self, group: LinearizedGroup, deviations: Array
    ) -> list[LinearizationPoint]:
        """Return the points of flights with common shared parameters."""
        if group.is_aligned:
            return [each.point for each in group.linears]
        return self._solve_points(group, deviations, group.at)

    def _settle_points(
        self, last: JointFit, at: Array, points: list[LinearizationPoint], goal: float
    ) -> tuple[float, list[LinearizationPoint]]:
        """
        Solve again for what each flight and piece has of its own, with the shared parameters held.

        A trajectory is far more nonlinear in parameters than in its own unknowns: where the linear
        prediction of these is off by much, the parameters may still be better. Return the misfit
        and the points; the search ends below `goal`.
        """
        misfit = self._point_misfit(last, at, points)
        held = Prior(last.prior.mean, np.zeros_like(last.prior.covariance))
        for _ in range(SETTLED):
            if misfit < goal:
                break
            try:
                group = self.linearize_flights(at, points, held)
                moved = self._solve_points(group, last.deviations, at)
            except (BadInput, np.linalg.LinAlgError):
                break
            now = self._point_misfit(last, at, moved)
            if not now < misfit:
                break
            is_slow = now > 0.5 * misfit  # it has settled, or will not get there
            misfit, points = now, moved
            if is_slow:
                break
        return misfit, points

    def _propose_held_step(
        self, last: JointFit, hold: float
    ) -> tuple[Array, list[LinearizationPoint]]:
        """
        Return the step whose parameters are held at the present point, and the points of flights.

        `hold`: by this many times the precision of the prior of each; 0 for the full step.
        """
        mean, covariance = last.fitted.mean, last.fitted.covariance
        if hold:
            prior, free = last.prior, last.prior.free
            inner = np.ix_(free, free)
            before = np.linalg.inv(prior.covariance[inner])
            weight = np.diag(hold / np.diag(prior.covariance)[free])
            middle, spread = last.group.at.copy(), np.zeros_like(prior.covariance)
            spread[inner] = np.linalg.inv(before + weight)
            pull = before @ prior.mean[free] + weight @ last.group.at[free]
            middle[free] = spread[inner] @ pull
            near = Prior(middle, spread)
            _, mean, covariance = compute_posterior(last.reduced, last.group.at, near)
        low, high = parameter_bounds(self.flights[0].knobs, last.prior)
        at = bound_mean(mean, covariance, low, high)
        return at, self._solve_points(last.group, last.deviations, at)

    def _solve_points(
        self, group: LinearizedGroup, deviations: Array, at: Array
    ) -> list[LinearizationPoint]:
        """Return the points of flights for shared parameters."""
        points = []
        for move in group.solve_flights(deviations, at):
            vehicle, values = apply_parameters(self.nominal, self.flights[0].knobs, move.values)
            points.append(LinearizationPoint(vehicle, values, move.random))
        return points

    def _point_misfit(
        self, last: JointFit, at: Array, points: Sequence[LinearizationPoint]
    ) -> float:
        """Return the simulated misfit at a point."""
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
    Fit one flight alone.

    `prior`: of all parameters, including per-flight ones: `build_prior`.
    """
    alone = JointFitter(nominal, [flight], np.zeros(len(begin.values)), FLOOR)
    group = alone.linearize_flights(begin.values, [begin])
    return alone.fit(prior, group, deviations, rounds).members[0]
