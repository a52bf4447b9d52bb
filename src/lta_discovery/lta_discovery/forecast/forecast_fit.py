"""
Fit parameters to forecasts over several seconds, for many flights at once.

Where the model error exceeds the tracker noise (smoothed data, long glides), a likelihood over
every reading rewards following the smoothing. Here all horizons have equal weight, by the error of
the vehicle file. Flights share all parameters except net lift, which each flight has of its own.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.forecast.horizon_errors import (
    compute_horizon_errors,
    find_measured_poses,
    HorizonErrors,
    HORIZONS,
)
from lta_discovery.forecast.levenberg_marquardt import (
    next_damping,
    solve_bounded_step,
    START,
    TRIES,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, NET_LIFT
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint, SENSORS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PLACE: Final = 2.0  # weight of position errors relative to attitude errors
ALIKE: Final = 0.1  # share of independent readings: the horizons of a piece are correlated
ROUNDS: Final = 4  # most linearisations
ROBUST: Final = 4.5  # usual sizes; larger errors have a linear cost instead of a quadratic one
LEFT_OUT: Final = 2  # most steps without some flights, from the fit to all
SETTLED: Final = 1e-3  # of the cost; the fit ends with a step that gains less
DIVERGED: Final = 10.0  # usual sizes; error of a forecast that diverges


@final
@dataclass(frozen=True, slots=True)
class ForecastNormalEquations:
    """Normal equations of one flight about a point, with its own lift eliminated."""

    products: Array  # of the columns, shape (K, K)
    pull: Array  # products of the columns with the residuals, shape (K,)
    # Information of the lift, its pull, and its products with the columns
    own: tuple[float, float, Array]
    cost: float  # squared residuals; linear beyond `ROBUST`


@final
@dataclass(frozen=True, slots=True)
class ForecastFit:
    """Parameters and lifts that forecast the flights best, and how well they are known."""

    values: Array  # shared parameters, relative to the vehicle file; 0 if not fitted, shape (G,)
    # Of the fitted parameters, about `values`, without the prior, shape (K, K)
    precision: Array
    pull: Array
    equations: tuple[ForecastNormalEquations, ...]  # by flight
    lifts: Array  # net lift of each flight of the fitter, besides the shared one, shape (F,) [N]


@final
class ForecastFitter:
    """
    Fit parameters to the forecasts of some flights of one vehicle.

    Parameters
    ----------
    flights : sequence of FlightLinearizer
        In pieces longer than the last horizon, with the same parameters.
    lift : float
        Standard deviation of a flight's lift. [N]
    place : float
        Weight of position errors relative to attitude errors.
    horizons : sequence of float
        Of the forecasts. [s]

    """

    def __init__(
        self,
        nominal: NominalVehicle,
        flights: Sequence[FlightLinearizer],
        lift: float,
        place: float = PLACE,
        horizons: Sequence[float] = HORIZONS,
    ) -> None:
        self.nominal, self.flights, self.lift = nominal, flights, lift
        self.place, self.horizons = place, horizons
        self.knobs: list[FreeParameter] = flights[0].knobs
        self._lift = next(k for k, knob in enumerate(self.knobs) if knob.name == NET_LIFT)
        zero = np.zeros(len(self.knobs))
        first = [
            compute_horizon_errors(
                one, self.build_linearization_point(zero, 0.0, one), horizons=horizons
            ).errors
            for one in flights
        ]
        self.weights = _error_weights(np.concatenate(first), place)
        # Number of readings, to detect forecasts that diverge
        self._known = [int(np.isfinite(left).sum()) for left in first]
        self._measured = [find_measured_poses(one, horizons) for one in flights]

    def build_linearization_point(
        self, values: Array, lift: float, flight: FlightLinearizer
    ) -> LinearizationPoint:
        """Return the linearization point of a flight with shared values and its own lift."""
        own = values.copy()
        # Shared lift plus the flight's own
        own[self._lift] += lift
        nominal, own = apply_parameters(self.nominal, self.knobs, own)
        # Forecasts have no unknowns per piece
        none = np.zeros((len(flight.replay.first), 0))
        return LinearizationPoint(nominal, np.append(own, np.zeros(len(SENSORS))), none)

    def compute_flight_errors(
        self, values: Array, f: int, which: Sequence[int] = (), lift: float = 0.0
    ) -> HorizonErrors:
        """Return one flight's horizon errors, and their sensitivities to parameters and lift."""
        flight = self.flights[f]
        return compute_horizon_errors(
            flight,
            self.build_linearization_point(values, lift, flight),
            [*which, self._lift],
            self.horizons,
        )

    def fit(
        self,
        which: Sequence[int],
        spread: Array,
        flights: Sequence[int],
        begin: Array | None = None,
        rounds: int = ROUNDS,
        relinearize: bool = True,
        start: ForecastFit | None = None,
    ) -> ForecastFit:
        """
        Fit some parameters to some flights.

        `spread`, shape (K,): prior standard deviations, about the vehicle file. `relinearize`:
        whether to linearize at the result; otherwise the information is that of one step before.
        `start`: a fit to all flights to begin at, with its lifts and equations.
        """
        picked = np.asarray(which, dtype=np.int64)
        values = np.zeros(len(self.knobs)) if begin is None else begin.copy()
        lifts = np.zeros(len(self.flights))
        equations: dict[int, ForecastNormalEquations] = {}
        if start is not None:
            values, lifts = start.values.copy(), start.lifts.copy()
            equations = {f: start.equations[f] for f in flights}
        # Inverse prior covariance; the vehicle file is at 0
        wall, damping = np.diag(spread**-2.0), START
        for number in range(rounds):
            if number or not equations:
                equations = {
                    f: self._build_normal_equations(values, lifts, f, picked) for f in flights
                }
            inner = wall + np.sum([one.products for one in equations.values()], axis=0)
            right = (
                np.sum([one.pull for one in equations.values()], axis=0) - wall @ values[picked]
            )
            before = sum(one.cost for one in equations.values()) + _prior_penalty(
                values[picked], spread
            )
            trial = self._try_step(
                values, lifts, picked, spread, (inner, right), equations, (before, damping)
            )
            if trial is None:
                break
            values, lifts, after, damping = trial
            # Converged.
            if before - after < SETTLED * before:
                break
        if relinearize or not equations:
            equations = {
                f: self._build_normal_equations(values, lifts, f, picked) for f in flights
            }
        return ForecastFit(
            values,
            np.sum([one.products for one in equations.values()], axis=0),
            np.sum([one.pull for one in equations.values()], axis=0),
            tuple(equations.values()),
            lifts,
        )

    def leave_out_flights(
        self,
        fit: ForecastFit,
        which: Sequence[int],
        spread: Array,
        flights: Sequence[int],
        is_quick: bool = False,
    ) -> Array:
        """
        Return the values without some flights, by damped steps from a fit to all.

        One undamped step is too long where the flights left out hold parameters that the others
        hardly identify: forecasts with its values can be many times worse than those of a fit.

        `is_quick`: whether to take one step, with the equations of the fit to all.
        """
        others = [f for f in range(len(self.flights)) if f not in set(flights)]
        if is_quick:
            return self.fit(which, spread, others, None, 1, False, fit).values
        return self.fit(which, spread, others, fit.values, LEFT_OUT, False).values

    def _parameter_bounds(self, picked: NDArray[np.int64]) -> tuple[Array, Array]:
        """Return the lower and upper bounds of some parameters."""
        low, high = (
            np.array([getattr(self.knobs[k], side) for k in picked]) for side in ('low', 'high')
        )
        return low, high

    def rms_error(
        self,
        values: Array,
        flights: Sequence[int],
        columns: slice = slice(None),
        diverged: float = DIVERGED,
    ) -> float:
        """
        Return the RMS of weighted horizon errors, with the lift fitted to each flight.

        `diverged`: error of a forecast that diverges; left out, it would count for the values.
        """
        total, count = 0.0, 0
        for f in flights:
            with np.errstate(over='ignore', invalid='ignore'):
                seen = self.compute_flight_errors(values, f)
            good = np.isfinite(seen.errors)
            lost = self._measured[f] & ~good
            left = (seen.errors * self.weights)[good]
            column = (seen.columns[..., 0] * self.weights)[good]
            # Ridge estimate of the flight's lift, with its prior deviation
            lift = ALIKE * float(column @ left) / (ALIKE * float(column @ column) + self.lift**-2)
            rest = np.where(good, (seen.errors - lift * seen.columns[..., 0]) * self.weights, 0.0)
            total += float(np.sum(np.minimum(rest[..., columns] ** 2, diverged**2)))
            if lost[..., columns].any():
                total += diverged**2 * int(lost[..., columns].sum())
            count += int((good | lost)[..., columns].sum())
        return float(np.sqrt(total / max(count, 1)))

    def _try_step(
        self,
        values: Array,
        lifts: Array,
        picked: NDArray[np.int64],
        spread: Array,
        normal: tuple[Array, Array],
        flight_terms: dict[int, ForecastNormalEquations],
        began: tuple[float, float],
    ) -> tuple[Array, Array, float, float] | None:
        """Return a better point, its cost and the next damping; None if no step improves it."""
        inner, right = normal
        before, damping = began
        for _ in range(TRIES):
            there, own = values.copy(), lifts.copy()
            # Marquardt damping: scale the diagonal.
            stiff = inner + damping * np.diag(np.diag(inner))
            there[picked] = solve_bounded_step(
                stiff, right, values[picked], *self._parameter_bounds(picked)
            )
            for f, one in flight_terms.items():
                information, pull, across = one.own
                # The eliminated lift follows from the step of the shared values
                own[f] += (pull - across @ (there - values)[picked]) / information
            try:
                cost = sum(self._forecast_cost(there, own, f) for f in flight_terms)
            except BadInput:
                cost = np.inf
            cost += _prior_penalty(there[picked], spread)
            if cost < before:
                return there, own, cost, next_damping(damping, True)
            damping = next_damping(damping, False)
        return None

    def _forecast_cost(self, values: Array, lifts: Array, f: int) -> float:
        """Return the cost of a flight; infinite if the prediction diverges."""
        flight = self.flights[f]
        with np.errstate(all='ignore'):
            left = compute_horizon_errors(
                flight,
                self.build_linearization_point(values, float(lifts[f]), flight),
                horizons=self.horizons,
            ).errors
        # Compare costs only over the same readings.
        if np.isfinite(left).sum() < self._known[f]:
            return np.inf  # the prediction diverged
        cost, _ = _huber_cost(left * self.weights)
        return ALIKE * cost + float(lifts[f] / self.lift) ** 2

    def _build_normal_equations(
        self, values: Array, lifts: Array, f: int, picked: NDArray[np.int64]
    ) -> ForecastNormalEquations:
        """Return the normal equations of a flight about a point."""
        seen = self.compute_flight_errors(values, f, picked.tolist(), float(lifts[f]))
        good = np.isfinite(seen.errors)
        cost, share = _huber_cost(seen.errors * self.weights)
        weights = self.weights * np.sqrt(share)[..., None]
        left = np.where(good, seen.errors * weights, 0.0).ravel()
        table = seen.columns * weights[..., None] * good[..., None]
        table = table.reshape(len(left), -1)
        a, b = table[:, :-1], table[:, -1]
        information = ALIKE * float(b @ b) + self.lift**-2.0
        pull = ALIKE * float(b @ left) - float(lifts[f]) / self.lift**2
        across = ALIKE * (b @ a)
        # Eliminate the flight's lift by its Schur complement.
        return ForecastNormalEquations(
            ALIKE * (a.T @ a) - np.outer(across, across) / information,
            ALIKE * (a.T @ left) - across * (pull / information),
            (information, pull, across),
            ALIKE * cost + float(lifts[f] / self.lift) ** 2,
        )


def _huber_cost(left: Array) -> tuple[float, Array]:
    """Return the Huber (1964) cost of errors, shape (S, H, 6), and the weight of each."""
    size = np.sqrt(np.nansum(left**2, axis=-1) / left.shape[-1])
    # Weight of iteratively reweighted least squares
    share = ROBUST / np.maximum(size, ROBUST)
    cost = np.where(size > ROBUST, 2.0 * ROBUST * size - ROBUST**2, size**2)
    return left.shape[-1] * float(cost.sum()), share


def _error_weights(left: Array, more: float) -> Array:
    """Return the inverse RMS of errors, shape (H, 6), from (n, H, 6)."""
    size = np.sqrt(np.nanmean(left**2, axis=0))
    place = np.sqrt(np.mean(size[:, :3] ** 2, axis=1, keepdims=True))
    turn = np.sqrt(np.mean(size[:, 3:] ** 2, axis=1, keepdims=True))
    return np.hstack([np.repeat(more / place, 3, axis=1), np.repeat(1.0 / turn, 3, axis=1)])


def _prior_penalty(values: Array, spread: Array) -> float:
    """Return the squared distance of parameters from the vehicle file, in prior deviations."""
    return float(np.sum((values / spread) ** 2))
