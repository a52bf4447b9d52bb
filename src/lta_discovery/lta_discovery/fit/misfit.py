"""
Compute the misfit of a point by simulation, and as predicted by a linearization.

The misfit is -2 times the log density of data and unknowns, up to a constant. Gauss-Newton steps
have to reduce it. Simulating a point is much cheaper than linearizing about it.
"""

from collections.abc import Sequence
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.fit.evidence import Prior, unknowns_penalty
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint
from lta_discovery.replay.replay import STEPS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

AHEAD: Final = 3.0  # s; length of a forecast


def compute_misfit(
    flights: Sequence[FlightLinearizer],
    deviations: Array,
    prior: Prior,
    variance: Array,
    at: Array,
    points: Sequence[LinearizationPoint],
) -> float:
    """Return the misfit of flights at a point; infinite for divergence or impossible vehicles."""
    flight_misfits = map_parallel(_readings_misfit, list(zip(flights, points, strict=True)))
    return _unknowns_misfit(deviations, prior, variance, at, points) + sum(flight_misfits)


def _readings_misfit(one: tuple[FlightLinearizer, LinearizationPoint]) -> float:
    flight, point = one
    with np.errstate(over='ignore', invalid='ignore'):
        try:
            # The integrator has STEPS steps in each period of the readings
            grid = flight.simulate_trajectory(point)[:, ::STEPS]
        except BadInput:
            return np.inf  # impossible vehicle
        if not np.isfinite(grid).all():
            return np.inf
        left = flight.compute_residual(grid, point, flight.replay.build_replay_rows(point.nominal))
        # NaN marks readings that were not measured
        return float(np.nansum((left / flight.replay.flight.noise) ** 2))


def forecast_error(
    flights: Sequence[FlightLinearizer], points: Sequence[LinearizationPoint]
) -> float:
    """
    Return the typical error of forecasts without a latent wrench, by the tracker noise.

    The median over pieces of the RMS position error until AHEAD, robust to a few diverging pieces.
    Infinite for an impossible vehicle.
    """
    error_lists = map_parallel(_forecast_errors, list(zip(flights, points, strict=True)))
    if any(errors is None for errors in error_lists):
        return np.inf
    return float(
        np.nanmedian(np.concatenate([errors for errors in error_lists if errors is not None]))
    )


def _forecast_errors(one: tuple[FlightLinearizer, LinearizationPoint]) -> Array | None:
    """Return the forecast error of each piece of a flight; None for an impossible vehicle."""
    flight, point = one
    here, measured = (slice(None), slice(round(AHEAD / PERIOD))), flight.replay.flight
    with np.errstate(over='ignore', invalid='ignore'):
        try:
            grid = flight.simulate_forecast(point)[:, ::STEPS]
        except BadInput:
            return None
        # Compare predicted readings: tracker frame and clock may be among the fitted parameters.
        left = flight.compute_residual(
            grid, point, flight.replay.build_replay_rows(point.nominal)
        )[here]
        off = left[..., :3] / measured.noise[:3]
        valid = np.isfinite(measured.position[flight.index[here]])
        valid &= flight.replay.cut.inside[here][..., None]
        # A diverged forecast counts as the worst, not as unmeasured
        off[valid & ~np.isfinite(off)] = np.inf
        errors: Array = np.sqrt(np.nanmean(off**2, axis=(1, 2)))
        return errors


def predict_linear_misfit(
    group: LinearizedGroup,
    deviations: Array,
    prior: Prior,
    at: Array,
    points: Sequence[LinearizationPoint],
) -> float:
    """Return the misfit at points as predicted by flights linearized elsewhere."""
    total = _unknowns_misfit(deviations, prior, group.variance, at, points)
    for linear, point in zip(group.linears, points, strict=True):
        moved = np.tile(point.values - linear.point.values, (len(linear.grams), 1))
        # The residual is the last column; -1 makes the product |C change - r|^2
        none = np.full((len(linear.grams), 1), -1.0)
        change = np.hstack([point.random - linear.point.random, moved, none])
        total += float(np.einsum('si,sij,sj->', change, linear.grams, change))
    return total


def _unknowns_misfit(
    deviations: Array,
    prior: Prior,
    variance: Array,
    at: Array,
    points: Sequence[LinearizationPoint],
) -> float:
    """Return the misfit of the unknowns: shared parameters, each flight, its pieces."""
    free, own = prior.free, variance > 0.0
    off = (at - prior.mean)[free]
    total = float(off @ np.linalg.solve(prior.covariance[np.ix_(free, free)], off))
    for point in points:
        total += unknowns_penalty(point, deviations)
        total += float(np.sum((point.values - at)[own] ** 2 / variance[own]))
    return total
