"""
A few knobs fitted to what is predicted seconds ahead, over many flights at once.

Where a model's own error is what counts and not the tracker's noise (smoothed data, long glides),
a likelihood over every reading is about the wrong thing: it rewards what follows the smoothing.
Here the error at each horizon counts alike, by how large it is for the vehicle file. Shared knobs
move together; lift, which differs from flight to flight, is each flight's own.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.forecast.horizon_errors import compute_horizon_errors, HorizonErrors
from lta_discovery.forecast.levenberg_marquardt import (
    next_damping,
    solve_bounded_step,
    START,
    TRIES,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.linearized_flight import LinearizationPoint, SENSORS
from lta_discovery.replay.linearizer import FlightLinearizer
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PLACE: Final = 2.0  # how much more a place counts than an attitude
ALIKE: Final = 0.1  # of the readings that say something new: horizons of a piece go together
ROUNDS: Final = 4  # linearisations, at most
ROBUST: Final = 4.5  # usual sizes; a larger error at a horizon counts by its size, not its square
SETTLED: Final = 1e-3  # of the cost; a step that gains less is the last


@final
@dataclass(frozen=True, slots=True)
class ForecastInformation:
    """
    What one flight says of the knobs about a point, its own lift eliminated.

    Attributes
    ----------
    products : ndarray, shape (K, K)
        Of the columns.
    pull : ndarray, shape (K,)
        Of the columns with what is left over.
    own : tuple of float, float, ndarray
        Information of the lift, its pull, and its products with the columns.
    cost : float
        What is left over, squared; beyond `ROBUST` by its size.

    """

    products: Array
    pull: Array
    own: tuple[float, float, Array]
    cost: float


@final
@dataclass(frozen=True, slots=True)
class ForecastFit:
    """
    Where the knobs stand.

    Attributes
    ----------
    values : ndarray, shape (G,)
        What flights share, from the vehicle file; 0 for what was not asked for.
    precision, pull : ndarray, shape (K, K) and (K,)
        Of those asked for, about `values`, from the flights alone.
    said : tuple of Said
        By flight.

    """

    values: Array
    precision: Array
    pull: Array
    said: tuple[ForecastInformation, ...]


@final
class ForecastFitter:
    """
    Flights of one vehicle, for what they say of forecasts.

    Parameters
    ----------
    nominal : Nominal
        The vehicle as its file has it.
    flights : sequence of Linearised
        In pieces longer than the last horizon, with the same knobs.
    lift : float
        Standard deviation of a flight's lift. [N]
    place : float
        How much more a place counts than an attitude.

    """

    def __init__(
        self,
        nominal: NominalVehicle,
        flights: Sequence[FlightLinearizer],
        lift: float,
        place: float = PLACE,
    ) -> None:
        self.nominal, self.flights, self.lift = nominal, flights, lift
        self.knobs: list[FreeParameter] = flights[0].knobs
        self._lift = next(k for k, knob in enumerate(self.knobs) if knob.name == 'net_lift.force')
        zero = np.zeros(len(self.knobs))
        first = [
            compute_horizon_errors(one, self.build_point(zero, 0.0, one)).left for one in flights
        ]
        self.weights = _error_weights(np.concatenate(first), place)
        self._known = [int(np.isfinite(left).sum()) for left in first]

    def build_point(
        self, values: Array, lift: float, flight: FlightLinearizer
    ) -> LinearizationPoint:
        """Return where a flight stands with shared values and a lift of its own."""
        own = values.copy()
        own[self._lift] += lift
        nominal, own = apply_parameters(self.nominal, self.knobs, own)
        none = np.zeros((len(flight.replay.first), 0))
        return LinearizationPoint(nominal, np.append(own, np.zeros(len(SENSORS))), none)

    def compute_errors(
        self, values: Array, f: int, which: Sequence[int] = (), lift: float = 0.0
    ) -> HorizonErrors:
        """Return the errors ahead of one flight, and how they answer to some knobs and lift."""
        flight = self.flights[f]
        return compute_horizon_errors(
            flight, self.build_point(values, lift, flight), [*which, self._lift]
        )

    def fit(
        self,
        which: Sequence[int],
        spread: Array,
        flights: Sequence[int],
        begin: Array | None = None,
        rounds: int = ROUNDS,
        relinearize: bool = True,
    ) -> ForecastFit:
        """
        Fit some knobs to some flights.

        Parameters
        ----------
        which : sequence of int
            Of the knobs.
        spread : ndarray, shape (K,)
            Standard deviation beforehand of each, about the vehicle file.
        flights : sequence of int
            To be fitted to.
        begin : ndarray, shape (G,), optional
            Where to begin; the vehicle file by default.
        rounds : int
            Steps of Levenberg and Marquardt at most, each damped until it helps.
        told : bool
            Whether to say at the end what the flights say there; else what they said one step
            before.

        """
        picked = np.asarray(which, dtype=np.int64)
        values = np.zeros(len(self.knobs)) if begin is None else begin.copy()
        lifts = np.zeros(len(self.flights))
        wall, damping = np.diag(spread**-2.0), START
        for _ in range(rounds):
            said = {f: self._summarize_flight(values, lifts, f, picked) for f in flights}
            inner = wall + np.sum([one.products for one in said.values()], axis=0)
            right = np.sum([one.pull for one in said.values()], axis=0) - wall @ values[picked]
            before = sum(one.cost for one in said.values()) + _prior_penalty(
                values[picked], spread
            )
            found = self._try_step(
                values, lifts, picked, spread, (inner, right), said, (before, damping)
            )
            if found is None:
                break
            values, lifts, after, damping = found
            if before - after < SETTLED * before:
                break
        if relinearize or not rounds:
            said = {f: self._summarize_flight(values, lifts, f, picked) for f in flights}
        return ForecastFit(
            values,
            np.sum([one.products for one in said.values()], axis=0),
            np.sum([one.pull for one in said.values()], axis=0),
            tuple(said.values()),
        )

    def leave_out(
        self, fit: ForecastFit, which: Sequence[int], spread: Array, flights: Sequence[int]
    ) -> Array:
        """Return the values that all but some flights say, one step away from a fit to all."""
        picked, out = np.asarray(which, dtype=np.int64), fit.values.copy()
        gone = [one for f, one in enumerate(fit.said) if f in set(flights)]
        inner = fit.precision + np.diag(spread**-2.0)
        inner = inner - np.sum([one.products for one in gone], axis=0)
        # Where all of them rest, what these pulled is what the others pull the other way.
        right = -np.sum([one.pull for one in gone], axis=0)
        out[picked] = solve_bounded_step(
            inner, right, out[picked], *self._parameter_bounds(picked)
        )
        return out

    def _parameter_bounds(self, picked: NDArray[np.int64]) -> tuple[Array, Array]:
        """Return the least and the most of some knobs."""
        low, high = (
            np.array([getattr(self.knobs[k], side) for k in picked]) for side in ('low', 'high')
        )
        return low, high

    def rms_error(self, values: Array, flights: Sequence[int]) -> float:
        """Return the root mean square of the errors ahead, each flight's lift fitted to it."""
        total, count = 0.0, 0
        for f in flights:
            seen = self.compute_errors(values, f)
            good = np.isfinite(seen.left)
            left = (seen.left * self.weights)[good]
            column = (seen.columns[..., 0] * self.weights)[good]
            lift = ALIKE * float(column @ left) / (ALIKE * float(column @ column) + self.lift**-2)
            total += float(np.sum((left - lift * column) ** 2))
            count += self._known[f]
        return float(np.sqrt(total / max(count, 1)))

    def _try_step(
        self,
        values: Array,
        lifts: Array,
        picked: NDArray[np.int64],
        spread: Array,
        normal: tuple[Array, Array],
        flight_terms: dict[int, ForecastInformation],
        began: tuple[float, float],
    ) -> tuple[Array, Array, float, float] | None:
        """Return a better point, its cost and the damping that led there, eased; None without."""
        inner, right = normal
        before, damping = began
        for _ in range(TRIES):
            there, own = values.copy(), lifts.copy()
            stiff = inner + damping * np.diag(np.diag(inner))
            there[picked] = solve_bounded_step(
                stiff, right, values[picked], *self._parameter_bounds(picked)
            )
            for f, one in flight_terms.items():
                information, pull, across = one.own
                own[f] += (pull - across @ (there - values)[picked]) / information
            try:
                cost = sum(self._compute_cost(there, own, f) for f in flight_terms)
            except BadInput:
                cost = np.inf
            cost += _prior_penalty(there[picked], spread)
            if cost < before:
                return there, own, cost, next_damping(damping, True)
            damping = next_damping(damping, False)
        return None

    def _compute_cost(self, values: Array, lifts: Array, f: int) -> float:
        """Return what is left over of a flight, squared."""
        flight = self.flights[f]
        with np.errstate(all='ignore'):
            left = compute_horizon_errors(
                flight, self.build_point(values, float(lifts[f]), flight)
            ).left
        if np.isfinite(left).sum() < self._known[f]:
            return np.inf  # it ran away
        cost, _ = _huber_cost(left * self.weights)
        return ALIKE * cost + float(lifts[f] / self.lift) ** 2

    def _summarize_flight(
        self, values: Array, lifts: Array, f: int, picked: NDArray[np.int64]
    ) -> ForecastInformation:
        """Return what a flight says about a point."""
        seen = self.compute_errors(values, f, picked.tolist(), float(lifts[f]))
        good = np.isfinite(seen.left)
        cost, share = _huber_cost(seen.left * self.weights)
        weights = self.weights * np.sqrt(share)[..., None]
        left = np.where(good, seen.left * weights, 0.0).ravel()
        table = seen.columns * weights[..., None] * good[..., None]
        table = table.reshape(len(left), -1)
        a, b = table[:, :-1], table[:, -1]
        information = ALIKE * float(b @ b) + self.lift**-2.0
        pull = ALIKE * float(b @ left) - float(lifts[f]) / self.lift**2
        across = ALIKE * (b @ a)
        return ForecastInformation(
            ALIKE * (a.T @ a) - np.outer(across, across) / information,
            ALIKE * (a.T @ left) - across * (pull / information),
            (information, pull, across),
            ALIKE * cost + float(lifts[f] / self.lift) ** 2,
        )


def _huber_cost(left: Array) -> tuple[float, Array]:
    """Return what errors cost (Huber 1964), shape (S, H, 6), and the share of each that pulls."""
    size = np.sqrt(np.nansum(left**2, axis=-1) / left.shape[-1])
    share = ROBUST / np.maximum(size, ROBUST)
    cost = np.where(size > ROBUST, 2.0 * ROBUST * size - ROBUST**2, size**2)
    return left.shape[-1] * float(cost.sum()), share


def _error_weights(left: Array, more: float) -> Array:
    """Return one over the usual size of errors, shape (H, 6), from (n, H, 6)."""
    size = np.sqrt(np.nanmean(left**2, axis=0))
    place = np.sqrt(np.mean(size[:, :3] ** 2, axis=1, keepdims=True))
    turn = np.sqrt(np.mean(size[:, 3:] ** 2, axis=1, keepdims=True))
    return np.hstack([np.repeat(more / place, 3, axis=1), np.repeat(1.0 / turn, 3, axis=1)])


def _prior_penalty(values: Array, spread: Array) -> float:
    """Return how far knobs are from the vehicle file, squared."""
    return float(np.sum((values / spread) ** 2))
