"""Replay flights with the model before and after a study, for the figures of the page."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_discovery.fit.joint_fit import FlightFit
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.forecast.flight_prediction import (
    best_start_residual,
    heading_from_quaternion,
    ModelPrediction,
    predict_flight,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint, unchanged_vehicle_point
from lta_discovery.study import DiscoveryStudy, StudyFlight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SAMPLES = 750  # of all overlays together; limits the file size of the page


@final
class StudyFlightView(NamedTuple):
    """One flight, replayed before and after."""

    study_flight: StudyFlight
    # Predictions of the two models
    before: ModelPrediction
    after: ModelPrediction
    # Residuals by the noise, each piece from its best-fitting initial state, shape (S, n, 14)
    left: tuple[Array, Array]
    shown: bool  # whether the prediction errors of the finding are of this flight


@final
class FlightOverlay(NamedTuple):
    """Lines of one flight on a common time grid, NaN between pieces."""

    # Of the time grid [s]
    begin: float
    period: float
    # Measured, before, after: x, y, z [m] and heading, shape (m, 4) [deg]
    lines: tuple[Array, Array, Array]


def list_fit_flights(study: DiscoveryStudy) -> list[tuple[StudyFlight, FlightFit]]:
    """Return the training and confirming flights, each with its fit to the named effects."""
    fit_flights = [
        one for role in ('train', 'confirm') for one in study.flights if one.role == role
    ]
    return list(zip(fit_flights, study.full, strict=False))


def build_flight_views(study: DiscoveryStudy) -> list[StudyFlightView]:
    """Replay all flights: shown flights with the models of the finding, the others as fitted."""
    points = {
        id(study_flight.flight): (
            _build_nominal_point(study.nominal, study_flight.flight),
            fit.linear.point,
        )
        for study_flight, fit in list_fit_flights(study)
    }
    points |= {
        id(each.study_flight.flight): (each.before, each.after) for each in study.comparisons
    }
    which = {id(each.study_flight.flight) for each in study.comparisons}
    out = []
    for study_flight in study.flights:
        flight = study_flight.flight
        plain = (
            _build_nominal_point(study.nominal, flight),
            _build_nominal_point(study.learned, flight),
        )
        before, after = points.get(id(flight), plain)
        both = predict_flight(flight, before), predict_flight(flight, after)
        left = best_start_residual(flight, before), best_start_residual(flight, after)
        out.append(StudyFlightView(study_flight, *both, left, id(flight) in which))
    return out


def _build_nominal_point(nominal: NominalVehicle, flight: FlightLinearizer) -> LinearizationPoint:
    """Return the linearization point of a vehicle without parameters fitted to this flight."""
    return unchanged_vehicle_point(nominal, flight.knobs, flight.replay.cut)


def build_overlay(one: StudyFlightView, flights: int = 1) -> FlightOverlay:
    """Return the overlay of one flight, thinned so that all overlays fit into the page."""
    measured = one.study_flight.flight.replay.flight
    count = len(measured.time)
    # At least 5 samples apart, whatever the size: a screen shows no more.
    stride = max(5, int(np.ceil(count * flights / SAMPLES)))
    keep = np.arange(0, count, stride)
    truth = np.column_stack(
        [measured.position, _unwrap_angle(heading_from_quaternion(measured.quaternion))]
    )
    models = (one.before, one.after)
    lines = [
        truth,
        *(_join_pieces(one.study_flight.flight, model, truth, stride) for model in models),
    ]
    a, b, c = (line[keep] * np.array([1.0, 1.0, 1.0, np.degrees(1.0)]) for line in lines)
    return FlightOverlay(float(measured.time[0]), stride * PERIOD, (a, b, c))


def _join_pieces(
    flight: FlightLinearizer, model: ModelPrediction, truth: Array, stride: int
) -> Array:
    """Join the pieces of a prediction; the last sample of each is NaN, to draw a gap."""
    out = np.full_like(truth, np.nan)
    inside = flight.replay.cut.inside
    for k, index in enumerate(flight.index):
        here = index[inside[k]]
        out[here, :3] = model.position[k, inside[k]]
        # The nearest equivalent angle, so that the line stays next to the measured one.
        turn = model.heading[k, inside[k]] - truth[here, 3]
        out[here, 3] = truth[here, 3] + (turn + np.pi) % (2.0 * np.pi) - np.pi
        out[here[-stride:]] = np.nan
    return out


def _unwrap_angle(angle: Array) -> Array:
    """Return an angle without jumps, NaN where it is unknown."""
    out, finite = angle.copy(), np.isfinite(angle)
    out[finite] = np.unwrap(angle[finite])
    return out


def piece_conditions(one: StudyFlightView) -> dict[str, Array]:
    """Return the flight conditions of each piece, shape (S,), by axis title."""
    return {
        'speed [m/s]': one.before.speed,
        'turning [\N{DEGREE SIGN}/s]': np.degrees(one.before.turning),
        'height [m]': _piece_heights(one.before.position),
        'time [s]': one.before.time[:, 0],
    }


def _piece_heights(position: Array) -> Array:
    """Return the mean height of each piece; NaN where no sample is valid."""
    finite = np.isfinite(position[..., 2])
    total = np.where(finite, position[..., 2], 0.0).sum(axis=1)
    return np.where(finite.any(axis=1), total / np.maximum(finite.sum(axis=1), 1), np.nan)


def select_residuals(flights: Sequence[StudyFlightView], after: bool) -> list[Array]:
    """Return the residuals of the shown flights."""
    return [one.left[int(after)] for one in flights if one.shown]
