"""
Compute the prediction errors of each model on held-out flights.

All models start each piece at the state estimated from the poses. Sensor errors and lift of the
flight (`per_flight_variance`) are estimated from its first pieces, which are not scored. Nothing
else of the flight is known to any model.
"""

from collections.abc import Callable, Mapping, Sequence
import math
from typing import Final, NamedTuple

from lta_discovery.finding import ChannelErrors
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.fit.evidence import per_flight_variance, PieceReducer
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.flights.measured_flight import CHANNELS, PERIOD
from lta_discovery.forecast.prediction_errors import extrapolate_coast, HORIZONS
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_logarithm,
    quaternion_product,
)
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import (
    LinearizationPoint,
    LinearizedFlight,
    SENSORS,
    zero_unknowns,
)
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import predict_readings, transform_to_map
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# States of a forecast at each step, shape (S, span + 1, 13)
Simulate = Callable[[FlightLinearizer, LinearizationPoint], Array]

LEARNED: Final = 0.25  # share of a flight's pieces, to estimate its own errors
LEARNED_MOST: Final = 4  # pieces; the most for that estimate
DRAWS: Final = 2000  # of the bootstrap
_UNITS = (*['m'] * 3, *['rad'] * 3, *['rad/s'] * 3, *['m/s2'] * 3, 'm', 'Pa')
UNITS: Final = dict(zip(CHANNELS, _UNITS, strict=True))
WHOLE: Final = {'position': ('m', slice(0, 3)), 'attitude': ('rad', slice(3, 6))}


class FlightUnderModels(NamedTuple):
    """One flight under the vehicle file; tolerances fitted; and with the named effects."""

    before: LinearizationPoint
    tuned: LinearizationPoint
    after: LinearizationPoint


def count_learning_pieces(flight: FlightLinearizer) -> int:
    """Return the number of first pieces that serve to estimate a flight's own errors."""
    return min(LEARNED_MOST, int(LEARNED * len(flight.replay.first)))


def build_model_points(
    flight: FlightLinearizer, nominal: NominalVehicle, bare: JointFit, full: JointFit
) -> FlightUnderModels:
    """
    Return a held-out flight under each model, with the flight's own errors.

    `bare`, `full`: of other flights: without effects, and with those named.
    """
    zero, knobs = np.zeros_like(full.group.at), flight.knobs
    count, models = count_learning_pieces(flight), []
    # The columns serve all three models: they differ little, and the errors are small.
    columns = None
    for at, deviations in (
        (zero, bare.deviations),
        (bare.fitted.mean, bare.deviations),
        (full.fitted.mean, full.deviations),
    ):
        vehicle, values = apply_parameters(nominal, knobs, at)
        point = LinearizationPoint(vehicle, values, zero_unknowns(flight.replay.cut))
        if count:
            if columns is None:
                columns = compute_own_columns(flight, point, count)
            own = estimate_own_errors(flight, point, columns, deviations, count)
            vehicle, values = apply_parameters(nominal, knobs, values + own)
            point = LinearizationPoint(vehicle, values, point.random)
        models.append(point)
    return FlightUnderModels(*models)


def build_vehicle_point(
    flight: FlightLinearizer, vehicle: NominalVehicle, deviations: Array
) -> LinearizationPoint:
    """Return a held-out flight under a vehicle, with the flight's own errors."""
    none = zero_unknowns(flight.replay.cut)
    zero = np.zeros(len(flight.knobs) + len(SENSORS))
    point, count = LinearizationPoint(vehicle, zero, none), count_learning_pieces(flight)
    if not count:
        return point
    columns = compute_own_columns(flight, point, count)
    own = estimate_own_errors(flight, point, columns, deviations, count)
    return LinearizationPoint(*apply_parameters(vehicle, flight.knobs, own), none)


def compute_own_columns(flight: FlightLinearizer, point: LinearizationPoint, count: int) -> Array:
    """
    Return the columns of the first pieces for `estimate_own_errors`, shape (count, n, 14, N).

    Those of shared parameters are 0: they are not needed, and a vehicle at a limit of one, such as
    a file with fitted values, allows no step beyond it.
    """
    own = per_flight_variance(flight.knobs)[: len(flight.knobs)] > 0.0
    return flight.compute_whitened_columns(point, slice(0, count), own)[0]


def estimate_own_errors(
    flight: FlightLinearizer,
    point: LinearizationPoint,
    columns: Array,
    deviations: Array,
    count: int,
    simulate: Simulate = FlightLinearizer.simulate_forecast,
) -> Array:
    """Estimate a flight's own errors from its first pieces (maximum a posteriori)."""
    grid = simulate(flight, point)[:, ::STEPS]
    left = flight.compute_residual(grid, point, flight.replay.build_replay_rows(point.nominal))[
        :count
    ]
    left /= flight.replay.flight.noise
    finite = np.isfinite(left)
    table = np.concatenate([columns, left[..., None]], axis=-1)
    table[~finite] = 0.0
    flat = table.reshape(count, -1, table.shape[-1])
    grams = np.swapaxes(flat, 1, 2) @ flat
    first = LinearizationPoint(point.nominal, point.values, point.random[:count])
    rows = finite.sum(axis=(1, 2))
    reduced = PieceReducer(LinearizedFlight((), grams, rows, first, left)).eliminate_unknowns(
        deviations
    )
    variance = per_flight_variance(flight.knobs)
    # Only the flight's own errors are free; shared values are fixed
    own = np.flatnonzero(variance)
    inner = reduced.products[np.ix_(own, own)] + np.diag(1.0 / variance[own])
    out = np.zeros(len(variance))
    out[own] = np.linalg.solve(inner, reduced.products[own, -1])
    return out


def compute_forecast_residuals(
    flight: FlightLinearizer,
    point: LinearizationPoint,
    coast: bool = False,
    simulate: Simulate = FlightLinearizer.simulate_forecast,
    learned: int | None = None,
) -> Array:
    """
    Return measured minus predicted at each horizon, shape (S, H, 14); NaN where unknown.

    Parameters
    ----------
    learned : int, optional
        Number of first pieces that are left out; `count_learning_pieces` by default.

    """
    rows, replay = flight.replay.build_replay_rows(point.nominal), flight.replay
    if coast:
        grid = extrapolate_coast(
            transform_to_map(replay.cut.start, rows.acting), replay.cut.length
        )
        predicted = predict_readings(grid, flight.time, rows.acting, flight.places)
        turn = quaternion_logarithm(
            quaternion_product(
                quaternion_conjugate(predicted.quaternion), replay.flight.quaternion[flight.index]
            )
        )
        way = replay.flight.position[flight.index] - predicted.position
        readings = replay.flight.readings[flight.index] - predicted.readings
        left = np.concatenate([way, turn, readings], axis=-1)
        left[~replay.cut.inside] = np.nan
        # The flight has no such sensor
        left[..., ~np.isfinite(replay.flight.noise)] = np.nan
    else:
        with np.errstate(over='ignore', invalid='ignore'):
            left = flight.compute_residual(simulate(flight, point)[:, ::STEPS], point, rows)
    at = [round(horizon / PERIOD) for horizon in HORIZONS]
    first = count_learning_pieces(flight) if learned is None else learned
    return left[first:, [min(k, left.shape[1] - 1) for k in at]]


def bootstrap_shrinkage(
    before: Array, after: Array, rng: np.random.Generator, confidence: float = 0.95
) -> tuple[float, float]:
    """Return the interval of the shrinkage, by bootstrap over pieces; 95 % by default."""
    # Resample whole pieces: errors within a piece are correlated
    picked = rng.integers(0, len(before), (DRAWS, len(before)))
    if not (np.isfinite(before).all() and np.isfinite(after).all()):
        return math.nan, math.nan
    ratio = np.sqrt(after[picked].sum(axis=1) / np.maximum(before[picked].sum(axis=1), 1e-300))
    tail = 50.0 * (1.0 - confidence)
    low, high = np.percentile(1.0 - ratio, (tail, 100.0 - tail))
    return float(low), float(high)


def _shrinkage(before: float, after: float) -> float:
    """Return the shrinkage of an error; NaN if both forecasts diverge."""
    if math.isinf(before):
        return math.nan if math.isinf(after) else 1.0
    return 1.0 - after / before


@np.errstate(over='ignore')
def compute_model_errors(
    flights: Sequence[FlightLinearizer],
    models: Sequence[FlightUnderModels],
    seed: int,
    channels: Sequence[str] = (*WHOLE, *CHANNELS),
    refitted: Sequence[LinearizationPoint] = (),
) -> list[ChannelErrors]:
    """
    Return the errors of each model: position and attitude, then by channel, at each horizon.

    `refitted`: the flights with all numbers fitted to forecasts, if that was done. The error of a
    model whose forecast diverges is infinite.
    """
    kinds = ('before', 'tuned', 'after', 'coast')
    offs: dict[str, Array] = {
        kind: np.concatenate(
            [
                compute_forecast_residuals(
                    flight, getattr(each, kind, each.before), kind == 'coast'
                )
                for flight, each in zip(flights, models, strict=True)
            ]
        )
        for kind in kinds
    }
    if refitted:
        both = zip(flights, refitted, strict=True)
        offs['refitted'] = np.concatenate([compute_forecast_residuals(*each) for each in both])
    return summarize_residuals(flights, offs, seed, channels)


@np.errstate(over='ignore')
def summarize_residuals(
    flights: Sequence[FlightLinearizer],
    offs: Mapping[str, Array],
    seed: int,
    channels: Sequence[str] = (*WHOLE, *CHANNELS),
    blocks: NDArray[np.int64] | None = None,
    confidence: float = 0.95,
) -> list[ChannelErrors]:
    """
    Return the errors of `before`, `tuned`, `after`, `coast` and the like from their residuals.

    Parameters
    ----------
    offs : mapping of str to ndarray, shape (S, H, C)
        Of all flights, at `HORIZONS`, with the first C of `CHANNELS`.
    blocks : ndarray of int, shape (S,), optional
        Numbers of the blocks that the bootstrap resamples, from 0; the pieces by default.
    confidence : float
        Of the intervals.

    """
    noise = np.sqrt(np.mean([each.replay.flight.reading_deviation**2 for each in flights], axis=0))
    rng, added_rng, out = np.random.default_rng(seed), np.random.default_rng([seed, 1]), []
    which = {**WHOLE, **{c: (UNITS[c], slice(k, k + 1)) for k, c in enumerate(CHANNELS)}}
    for name, (unit, columns) in which.items():
        if name not in channels:
            continue
        for h, horizon in enumerate(HORIZONS):
            square = {kind: np.sum(off[:, h, columns] ** 2, axis=-1) for kind, off in offs.items()}
            finite = np.all([np.isfinite(each) for each in square.values()], axis=0)
            if name in WHOLE:
                # The pose was measured where coasting has an error; other forecasts diverge
                finite = np.isfinite(square['coast'])
                square = {
                    kind: np.where(np.isfinite(each), each, np.inf)
                    for kind, each in square.items()
                }
            if not finite.any():
                continue
            mean = {kind: float(np.sqrt(np.mean(each[finite]))) for kind, each in square.items()}
            # A pose error is a distance: the noises of its axes add in quadrature.
            floor = float(np.sqrt(np.sum(noise[columns] ** 2)))
            index = np.arange(len(finite)) if blocks is None else blocks
            rows = index[finite]
            sums = {
                kind: np.asarray(np.bincount(rows, each[finite])[np.unique(rows)], np.float64)
                for kind, each in square.items()
            }
            out.append(
                ChannelErrors(
                    name, unit, horizon, **mean, noise_floor=floor,
                    shrink=_shrinkage(mean['before'], mean['after']),
                    shrink_ci95=bootstrap_shrinkage(
                        sums['before'], sums['after'], rng, confidence,
                    ),
                    pieces=int(finite.sum()),
                    added_ci95=bootstrap_shrinkage(
                        sums['tuned'], sums['after'], added_rng, confidence,
                    ),
                )
            )  # fmt: skip
    return out
