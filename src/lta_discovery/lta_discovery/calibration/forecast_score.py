"""Score a calibration by its forecasts, beside the vehicle file and coasting."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.calibration.coarse_fit import (
    APART,
    build_forecast_fitter,
    build_longest_fitter,
)
from lta_discovery.calibration.result import AxisScore, ForecastScore
from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.quaternions import rotation_matrix
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.sensing import transform_to_map
from lta_discovery.transfer.forecast_errors import coast_errors
from lta_discovery.transfer.online_lift import piece_start_times, subtract_online_lift
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FAR: Final = 8.0  # s; horizon of a step
WORSE: Final = 1.05  # relative error on confirming flights that contradicts a calibration


def score_forecasts(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    values: Array,
    own: Sequence[Array] | None,
) -> tuple[ForecastScore, ...]:
    """
    Score the forecasts of the flights that are long enough; nothing if none is.

    They look 3 s ahead, or 1.2 s if all flights are shorter.

    `values`, shape (K,): the calibration, relative to the vehicle file. `own`: the same of each
    flight, with its own net lift and trend; by default `values`. Without it, both the file's lift
    and the calibration's are corrected by the earlier pieces of the flight.
    """
    built = build_longest_fitter(nominal, flights)
    if built is None:
        return ()
    fitter, picked = built
    parts = _compute_errors(fitter, picked, values, own)
    errors = {kind: np.concatenate(each) for kind, each in parts.items()}
    out = []
    for h, horizon in enumerate(fitter.horizons):
        measured = np.isfinite(errors['coast'][:, h]).all(axis=-1)
        if measured.any():
            coast, before, after = (_rms_pair(errors[kind][measured, h]) for kind in errors)
            out.append(ForecastScore(horizon, coast, before, after, int(measured.sum())))
    return tuple(out)


def score_axes(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    values: Array,
    own: Sequence[Array] | None,
) -> tuple[AxisScore, ...]:
    """
    Score the forecasts by direction, at the last horizon and `FAR` ahead.

    Arguments as for `score_forecasts`.
    """
    out = []
    for built in (
        build_longest_fitter(nominal, flights),
        build_forecast_fitter(nominal, flights, (FAR,), APART[1]),
    ):
        if built is None:
            continue
        fitter, picked = built
        parts = _compute_errors(fitter, picked, values, own)
        ways: dict[str, list[Array]] = {kind: [] for kind in parts}
        for f, flight in enumerate(fitter.flights):
            vehicle = fitter.build_linearization_point(values, 0.0, flight).nominal
            for kind, each in parts.items():
                ways[kind].append(split_by_direction(flight, vehicle, each[f][:, -1, :3]))
        errors = {kind: np.concatenate(each) for kind, each in ways.items()}
        measured = np.isfinite(errors['coast']).all(axis=-1)
        if measured.any():
            sizes = (
                np.where(np.isfinite(one[measured]), one[measured], np.inf)
                for one in errors.values()
            )
            with np.errstate(over='ignore'):
                coast, before, after = (
                    tuple(np.sqrt(np.mean(one**2, axis=0)).tolist()) for one in sizes
                )
            horizon = fitter.horizons[-1]
            out.append(AxisScore(horizon, coast, before, after, int(measured.sum())))
    return tuple(out)


def split_by_direction(flight: FlightLinearizer, vehicle: NominalVehicle, error: Array) -> Array:
    """Return position errors, shape (S, 3), by the directions of `AxisScore`, shape (S, 4)."""
    begun = flight.replay.cut.start
    # The nose of the vehicle, not that of its markers
    acting = flight.replay.build_replay_rows(vehicle).acting
    nose = rotation_matrix(transform_to_map(begun, acting)[:, 3:7])[:, :2, 0]
    nose /= np.linalg.norm(nose, axis=1, keepdims=True)
    side = np.stack([-nose[:, 1], nose[:, 0]], axis=1)
    last = flight.index[:, flight.replay.cut.length - 1]
    moved = (flight.replay.flight.position[last] - begun[:, :3])[:, :2]
    with np.errstate(over='ignore', invalid='ignore'):
        length = np.linalg.norm(moved, axis=1) - np.linalg.norm(moved - error[:, :2], axis=1)
        along, across = (np.sum(error[:, :2] * axis, axis=1) for axis in (nose, side))
        return np.stack([along, across, error[:, 2], length], axis=1)


def _compute_errors(
    fitter: ForecastFitter, picked: Sequence[int], values: Array, own: Sequence[Array] | None
) -> dict[str, list[Array]]:
    """Return the errors of each flight by coasting, by the file, and by the calibration."""
    none, online, every = np.zeros(len(values)), own is None, range(len(picked))
    return {
        'coast': [coast_errors(one, fitter.horizons) for one in fitter.flights],
        'before': [_file_errors(fitter, none, f, online) for f in every],
        'after': [
            _calibrated_errors(fitter, values if own is None else own[picked[f]], f, online)
            for f in every
        ],
    }


def _file_errors(fitter: ForecastFitter, none: Array, f: int, online: bool) -> Array:
    """Return the errors of the vehicle file in one flight."""
    if online:
        # As the calibration, so that its gain is not that of a lift learned in flight
        return _correct_lift(fitter, none, f)
    return fitter.compute_flight_errors(none, f).errors


def _calibrated_errors(fitter: ForecastFitter, values: Array, f: int, online: bool) -> Array:
    """Return the errors of a calibration in one flight, infinite where it cannot be flown."""
    try:
        if online:
            return _correct_lift(fitter, values, f)
        return fitter.compute_flight_errors(values, f).errors
    except BadInput:
        return np.full((len(fitter.flights[f].replay.first), len(fitter.horizons), 6), np.inf)


def _correct_lift(fitter: ForecastFitter, values: Array, f: int) -> Array:
    """Return the errors of one flight whose lift is corrected by its earlier pieces."""
    seen = fitter.compute_flight_errors(values, f)
    begins = piece_start_times(fitter.flights[f])
    return subtract_online_lift(seen, begins, fitter.lift, fitter.horizons)


def _rms_pair(left: Array) -> tuple[float, float]:
    """Return the RMS errors of position and attitude; infinite where a forecast diverged."""
    left = np.where(np.isfinite(left), left, np.inf)
    with np.errstate(over='ignore', invalid='ignore'):
        return (
            float(np.sqrt(np.mean(np.sum(left[:, :3] ** 2, axis=-1)))),
            float(np.sqrt(np.mean(np.sum(left[:, 3:] ** 2, axis=-1)))),
        )


def relative_error(scores: Sequence[ForecastScore]) -> float:
    """Return the error of a calibration relative to the file's: below 1 is better."""
    if not scores:
        return 1.0
    ratios = [
        after / max(before, 1e-9)
        for one in scores
        for after, before in zip(one.after, one.before, strict=True)
    ]
    return float(np.sqrt(np.mean(np.square(ratios))))


def is_contradicted(scores: Mapping[str, Sequence[ForecastScore]]) -> bool:
    """Return whether the vehicle file forecasts positions of the confirming flights better."""
    return relative_position_error(scores.get('confirm', ())) > WORSE


def relative_position_error(scores: Sequence[ForecastScore]) -> float:
    """Return the error of the positions relative to the file's: below 1 is better."""
    if not scores:
        return 1.0
    ratios = [one.after[0] / max(one.before[0], 1e-9) for one in scores]
    return float(np.sqrt(np.mean(np.square(ratios))))
