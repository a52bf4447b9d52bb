"""The flights of a study as its pictures need them: each replayed before and after."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_discovery.fit.joint_fit import FlightFit
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.forecast.flight_prediction import (
    best_start_residual,
    heading_angle,
    ModelPrediction,
    predict_flight,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.replay.linearized_flight import build_origin, LinearizationPoint
from lta_discovery.replay.linearizer import FlightLinearizer
from lta_discovery.study import DiscoveryStudy, StudyFlight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SAMPLES = 750  # of all overlays together, which bounds the size of the page


@final
class StudyFlightView(NamedTuple):
    """
    One flight before and after.

    Attributes
    ----------
    flown : Flown
        The flight.
    before, after : Replayed
        As the models have it.
    left : tuple of two ndarrays, shape (S, n, 14)
        What each leaves over when a piece begins as suits it best, by the noise.
    shown : bool
        Whether it is one of those on which the gap is shown.

    """

    flown: StudyFlight
    before: ModelPrediction
    after: ModelPrediction
    left: tuple[Array, Array]
    shown: bool


@final
class FlightOverlay(NamedTuple):
    """
    Lines of one flight on common instants, NaN between pieces.

    Attributes
    ----------
    begin, period : float
        Of the instants. [s]
    lines : tuple of three ndarrays, shape (m, 4)
        Measured, before, after: x, y, z [m] and heading [deg].

    """

    begin: float
    period: float
    lines: tuple[Array, Array, Array]


def list_fit_flights(study: DiscoveryStudy) -> list[tuple[StudyFlight, FlightFit]]:
    """Return the flights that taught and confirmed, each with its fit to the named effects."""
    flown = [one for role in ('train', 'confirm') for one in study.flights if one.role == role]
    return list(zip(flown, study.full, strict=False))


def build_flight_views(study: DiscoveryStudy) -> list[StudyFlightView]:
    """Return all flights, replayed: those that are shown as they are, the rest as fitted."""
    points = {
        id(flown.flight): (_build_plain_point(study.nominal, flown.flight), fit.linear.point)
        for flown, fit in list_fit_flights(study)
    }
    points |= {id(each.flown.flight): (each.before, each.after) for each in study.shown}
    which = {id(each.flown.flight) for each in study.shown}
    out = []
    for flown in study.flights:
        flight = flown.flight
        plain = (
            _build_plain_point(study.nominal, flight),
            _build_plain_point(study.learned, flight),
        )
        before, after = points.get(id(flight), plain)
        both = predict_flight(flight, before), predict_flight(flight, after)
        left = best_start_residual(flight, before), best_start_residual(flight, after)
        out.append(StudyFlightView(flown, *both, left, id(flight) in which))
    return out


def _build_plain_point(nominal: NominalVehicle, flight: FlightLinearizer) -> LinearizationPoint:
    """Return a vehicle as it is, with nothing turned for this flight."""
    return build_origin(nominal, flight.knobs, flight.replay.cut)


def build_overlay(one: StudyFlightView, flights: int = 1) -> FlightOverlay:
    """Return the lines of one of some flights, few enough points of them."""
    measured = one.flown.flight.replay.flight
    count = len(measured.time)
    stride = max(5, int(np.ceil(count * flights / SAMPLES)))
    keep = np.arange(0, count, stride)
    truth = np.column_stack([measured.position, _unwrap_angle(heading_angle(measured.quaternion))])
    models = (one.before, one.after)
    lines = [truth, *(_join_pieces(one.flown.flight, model, truth, stride) for model in models)]
    a, b, c = (line[keep] * np.array([1.0, 1.0, 1.0, np.degrees(1.0)]) for line in lines)
    return FlightOverlay(float(measured.time[0]), stride * PERIOD, (a, b, c))


def _join_pieces(
    flight: FlightLinearizer, model: ModelPrediction, truth: Array, stride: int
) -> Array:
    """Return the pieces one after the other; the last sample of each is left out, as a gap."""
    out = np.full_like(truth, np.nan)
    inside = flight.replay.cut.inside
    for k, index in enumerate(flight.index):
        here = index[inside[k]]
        out[here, :3] = model.position[k, inside[k]]
        turn = model.heading[k, inside[k]] - truth[here, 3]
        out[here, 3] = truth[here, 3] + (turn + np.pi) % (2.0 * np.pi) - np.pi
        out[here[-stride:]] = np.nan
    return out


def _unwrap_angle(angle: Array) -> Array:
    """Return an angle without jumps, NaN where it is not known."""
    out, known = angle.copy(), np.isfinite(angle)
    out[known] = np.unwrap(angle[known])
    return out


def piece_conditions(one: StudyFlightView) -> dict[str, Array]:
    """Return what each piece flew like, shape (S,): what errors may go with."""
    return {
        'speed [m/s]': one.before.speed,
        'turning [\N{DEGREE SIGN}/s]': np.degrees(one.before.turning),
        'height [m]': _piece_heights(one.before.position),
        'time [s]': one.before.time[:, 0],
    }


def _piece_heights(position: Array) -> Array:
    """Return the mean height of each piece; NaN where nothing counts."""
    known = np.isfinite(position[..., 2])
    total = np.where(known, position[..., 2], 0.0).sum(axis=1)
    return np.where(known.any(axis=1), total / np.maximum(known.sum(axis=1), 1), np.nan)


def select_residuals(flights: Sequence[StudyFlightView], after: bool) -> list[Array]:
    """Return what is left over on the flights that show the gap."""
    return [one.left[int(after)] for one in flights if one.shown]
