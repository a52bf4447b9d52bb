"""
Find a calibration near the best one, from a vehicle file that may be far off.

Forecasts over a second are nearly linear in gains, lift and the markers' frame, also where a gain
has the wrong sign. The delay of the commands is not, so a grid of delays is tried there. Forecasts
over three seconds then add what shows slowly: inertia, balance, drag.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.forecast.forecast_fit import ForecastFit, ForecastFitter
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.transfer.overlapping_pieces import cut_overlapping_pieces
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHORT: Final = (0.4, 0.8, 1.2)  # s; horizons of the first fit
LONG: Final = (1.0, 2.0, 3.0)  # s; horizons of the second
APART: Final = (0.8, 1.5)  # s; time between the beginnings of pieces in each
DELAYS: Final = (0.0, 0.08, 0.16, 0.24, 0.32, 0.4, 0.5)  # s; tried
FIRST: Final = ('wrench_gain', 'marker_offset', 'rotor_')  # fitted at each delay
LIFT: Final = 'net_lift.force'


@final
@dataclass(frozen=True, slots=True)
class CoarseCalibration:
    """
    Result of the coarse fit.

    Attributes
    ----------
    values : ndarray, shape (K,)
        Relative to the vehicle file.
    lifts : ndarray, shape (F,)
        Net lift of each flight. [N]

    """

    values: Array
    lifts: Array


def build_forecast_fitter(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    horizons: Sequence[float],
    apart: float,
) -> ForecastFitter | None:
    """Return a fitter to the forecasts of some flights; None if one is too short for them."""
    knobs = flights[0].knobs
    cut = [cut_overlapping_pieces(one, knobs, apart, horizons[-1]) for one in flights]
    known = [one for one in cut if one is not None]
    if len(known) < len(flights):
        return None
    lift = next(knob.tolerance for knob in knobs if knob.name == LIFT)
    return ForecastFitter(nominal, known, lift, horizons=horizons)


def fit_coarse_calibration(
    nominal: NominalVehicle, flights: Sequence[FlightLinearizer]
) -> CoarseCalibration:
    """Return a calibration that forecasts the flights well; that of the file at worst."""
    knobs = flights[0].knobs
    shared = [k for k, knob in enumerate(knobs) if not knob.per_flight]
    first = [k for k in shared if knobs[k].name.startswith(FIRST)]
    best = CoarseCalibration(np.zeros(len(knobs)), np.zeros(len(flights)))
    short = build_forecast_fitter(nominal, flights, SHORT, APART[0])
    if short is not None:
        starts = _fit_at_delays(short, knobs, first)
        if starts:
            start = min(starts, key=_fit_cost)
            best = _improve(short, best, start.values, shared)
    long = build_forecast_fitter(nominal, flights, LONG, APART[1])
    return best if long is None else _improve(long, best, best.values, shared)


def _fit_at_delays(
    fitter: ForecastFitter, knobs: Sequence[FreeParameter], which: Sequence[int]
) -> list[ForecastFit]:
    """Return a fit of some parameters at each delay that the model accepts."""
    late = next((k for k, knob in enumerate(knobs) if knob.name == 'command_delay.delay'), None)
    out = []
    for delay in DELAYS if late is not None else DELAYS[:1]:
        begin = np.zeros(len(knobs))
        if late is not None:
            begin[late] = min(max(delay, knobs[late].low), knobs[late].high)
        try:
            out.append(_fit(fitter, which, begin, 3))
        except (BadInput, np.linalg.LinAlgError):
            continue
    return out


def _fit(fitter: ForecastFitter, which: Sequence[int], begin: Array, rounds: int) -> ForecastFit:
    """Fit some parameters to all flights."""
    spread = np.array([fitter.knobs[k].tolerance for k in which])
    return fitter.fit(which, spread, range(len(fitter.flights)), begin, rounds)


def _fit_cost(fit: ForecastFit) -> float:
    """Return the cost of a fit over all flights."""
    return sum(one.cost for one in fit.said)


def _improve(
    fitter: ForecastFitter, before: CoarseCalibration, begin: Array, which: Sequence[int]
) -> CoarseCalibration:
    """Return the fit of all parameters from a start, or what was before if it is not better."""
    every = range(len(fitter.flights))
    try:
        fit = _fit(fitter, which, begin, 8)
    except (BadInput, np.linalg.LinAlgError):
        return before
    if not fitter.rms_error(fit.values, every) < fitter.rms_error(before.values, every):
        return before
    return CoarseCalibration(fit.values, fit.lifts)
