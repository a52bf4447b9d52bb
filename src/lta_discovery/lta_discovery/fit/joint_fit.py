"""
Fit parameters and latent forces to flights by Gauss-Newton.

Each iteration linearizes, finds the deviations of the latent wrench with maximum evidence, and
moves parameters, states and knots to their most probable values, until the evidence converges.
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
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint, LinearizedFlight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REST: Final = 0.7  # nats; convergence criterion of the evidence
ROUNDS: Final = 12  # most linearisations
# Factors on the noise variance for damped steps, if the full Gauss-Newton step fails.
DOUBTS: Final = (4.0, 30.0, 300.0, 3e3, 3e4, 3e5, 3e6)
# Parts of the full step, which are tried as well. Damped steps lead towards the prior, which
# does not help at a point where a large latent wrench dominates.
PARTS: Final = (0.5, 0.2, 0.08, 0.03)
BROKEN: Final = 2.0  # of the predicted misfit; above it shorter steps are tried too
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
    whole: bool  # whether it is the full step


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
        return self._move_to_mean(last, last.group, last.fitted.mean)

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
        Return the next point: the full step, a shorter one that is better, or None.

        Flights with different shared parameters are brought to common ones if nothing is better.
        """
        group = last.group
        here = self._gather_points(group, last.deviations)
        # Baseline: the simulated misfit at the present point
        bound, error = self._point_misfit(last, group.at, here), forecast_error(self.flights, here)
        try:
            at, points = self.propose_step(last)
        except np.linalg.LinAlgError:
            return None  # the flights determine no step
        misfit = self._screen_misfit(last, at, points, error)
        candidates = []
        if misfit < bound + WORSE:
            linear = predict_linear_misfit(group, last.deviations, last.prior, at, points)
            # The linearization predicts well here: accept without trying shorter steps
            if misfit < BROKEN * linear:
                return FitStep(at, points, abs(misfit - linear), True)
            candidates.append((misfit, at, points))
        # The full step failed or is nonlinear: try shorter ones, and take the best
        for part in PARTS:
            between = self._interpolate_points(part, group.at, here, at, points)
            candidates.append((self._screen_misfit(last, *between, error), *between))
        for doubt in DOUBTS:
            with contextlib.suppress(BadInput, np.linalg.LinAlgError):
                doubted = self._propose_damped_step(last, doubt)
                candidates.append((self._screen_misfit(last, *doubted, error), *doubted))
        misfit, at, points = min(
            candidates, key=lambda one: one[0], default=(np.inf, group.at, [])
        )
        if misfit < bound + WORSE:
            return FitStep(at, points, np.inf, False)
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

    def _interpolate_points(
        self,
        part: float,
        at: Array,
        here: Sequence[LinearizationPoint],
        to: Array,
        there: Sequence[LinearizationPoint],
    ) -> tuple[Array, list[LinearizationPoint]]:
        """Return shared parameters and points on the line from here to there."""
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
        """Return the misfit at a point, infinite if its forecasts get much worse."""
        misfit = self._point_misfit(last, at, points)
        # A latent wrench can hide a wrong vehicle; unaided forecasts cannot
        if np.isfinite(misfit) and forecast_error(self.flights, points) > ASTRAY * error:
            return np.inf
        return misfit

    def _propose_damped_step(
        self, last: JointFit, doubt: float
    ) -> tuple[Array, list[LinearizationPoint]]:
        """Return the step for a larger noise variance, closer to the prior."""
        # Dividing the products by a factor multiplies the noise variance by it
        pieces = [
            PieceReducer(replace(each, grams=each.grams / doubt)) for each in last.group.linears
        ]
        group = replace(last.group, pieces=tuple(pieces))
        posterior = compute_posterior(group.reduce_flights(last.deviations), group.at, last.prior)
        return self._move_to_mean(last, group, posterior.mean)

    def _move_to_mean(
        self, last: JointFit, group: LinearizedGroup, mean: Array
    ) -> tuple[Array, list[LinearizationPoint]]:
        """Return clipped shared parameters for a posterior mean, and the points of the flights."""
        at = np.clip(mean, *parameter_bounds(self.flights[0].knobs, last.prior))
        return at, self._solve_points(group, last.deviations, at)

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
