"""
Find a calibration near the best one, from a vehicle file that may be far off.

Forecasts over a second are nearly linear in gains, lift and the markers' frame, also where a gain
has the wrong sign. The delay of the commands is not, so a grid of delays is tried there. Inertia,
balance and drag are added then, and forecasts over three seconds last.

A model lacks something of every real flight. A drag or an exponent that is fitted to one short
test then stands for it, and misleads in the next one. Those that do not help to forecast flights
outside of the fit keep the values of the file.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.forecast.forecast_fit import ForecastFit, ForecastFitter
from lta_discovery.model.calibration_parameters import FLOWS
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, NET_LIFT
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.transfer.other_kind import select_pieces
from lta_discovery.transfer.overlapping_pieces import cut_overlapping_pieces
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHORT: Final = (0.4, 0.8, 1.2)  # s; horizons of the first fit
LONG: Final = (1.0, 2.0, 3.0)  # s; horizons of the second
APART: Final = (1.2, 1.5)  # s; least time between the beginnings of pieces in each
MOST: Final = 100  # pieces of all flights, to limit the time
DELAYS: Final = (0.0, 0.1, 0.2, 0.3, 0.4)  # s; tried
QUICK: Final = (0.0, 0.2)  # s; tried by a short fit
FIRST: Final = ('wrench_gain', 'marker_offset', 'rotor_')  # fitted at each delay
DELAY: Final = 'command_delay.delay'
ROUNDS: Final = 6  # most linearisations of a fit
REPEATS: Final = 6  # most fits to the longest forecasts, each with new weights
STILL: Final = 0.1  # tolerances; they end when no value moves further
# What shapes the forces, by the beginnings of the names, in the order in which it is left out:
# drag and added mass, then exponents and reverses of the commands
SHAPES: Final = (tuple(FLOWS), ('wrench_gain.exponent', 'wrench_gain.reverse'))
LEFT_OUT_ROUNDS: Final = 3  # most linearisations of a fit from which flights are left out
PARTS: Final = 4  # left out in turn of one or two flights
NEEDED: Final = 1.05  # of the error outside of a fit; what raises it by less is left out ...
# ... but not what raises that of any flight in the fit by more: where one flight alone has a
# command, a fit to the others tells nothing of its axis
MISSED: Final = 1.5


@final
@dataclass(frozen=True, slots=True)
class CoarseCalibration:
    """Result of the coarse fit."""

    values: Array  # relative to the vehicle file, shape (K,)
    lifts: Array  # net lift of each flight, shape (F,) [N]
    # Of the values; that of the prior where no forecast was fitted, shape (K, K)
    covariance: Array
    held: tuple[int, ...] = ()  # shared parameters that were left out


@final
@dataclass(frozen=True, slots=True)
class QuickFit:
    """Result of a short fit of gains, markers' frame and lift."""

    # Relative to the vehicle file, and their standard deviations; 0 where not fitted, shape (K,)
    values: Array
    deviations: Array
    lifts: Array  # net lift of each flight, shape (F,) [N]


def build_forecast_fitter(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    horizons: Sequence[float],
    apart: float,
) -> tuple[ForecastFitter, list[int]] | None:
    """Return a fitter to forecasts of the flights that are long enough, and which these are."""
    knobs = flights[0].knobs
    seconds = PERIOD * sum(int(one.replay.flight.usable.sum()) for one in flights)
    apart = max(apart, seconds / MOST)
    cut = [cut_overlapping_pieces(one, knobs, apart, horizons[-1]) for one in flights]
    long = {f: one for f, one in enumerate(cut) if one is not None}
    if not long:
        return None
    lift = next(knob.tolerance for knob in knobs if knob.name == NET_LIFT)
    return ForecastFitter(nominal, list(long.values()), lift, horizons=horizons), list(long)


def build_longest_fitter(
    nominal: NominalVehicle, flights: Sequence[FlightLinearizer]
) -> tuple[ForecastFitter, list[int]] | None:
    """Return the fitter to long forecasts; to short ones if no flight is long enough."""
    return build_forecast_fitter(nominal, flights, LONG, APART[1]) or build_forecast_fitter(
        nominal, flights, SHORT, APART[0]
    )


def find_calibration_start(
    nominal: NominalVehicle, flights: Sequence[FlightLinearizer]
) -> QuickFit | None:
    """Return a short fit near the best delay; None if no flight is long enough."""
    built = build_forecast_fitter(nominal, flights, SHORT, APART[0])
    if built is None:
        return None
    fitter = built[0]
    first = _list_first(fitter.knobs)
    starts = _fit_at_delays(fitter, fitter.knobs, first, QUICK)
    if not starts:
        return None
    every = range(len(fitter.flights))
    best = min(starts, key=lambda fit: fitter.rms_error(fit.values, every))
    spread = np.array([fitter.knobs[k].tolerance for k in first])
    deviations = np.zeros(len(fitter.knobs))
    covariance = np.linalg.inv(best.precision + np.diag(spread**-2.0))
    deviations[first] = np.sqrt(np.diag(covariance))
    return QuickFit(best.values, deviations, best.lifts)


def _list_first(knobs: Sequence[FreeParameter]) -> list[int]:
    """Return the parameters that are fitted at each delay."""
    return [k for k, knob in enumerate(knobs) if knob.name.startswith(FIRST)]


def fit_coarse_calibration(
    nominal: NominalVehicle, flights: Sequence[FlightLinearizer]
) -> CoarseCalibration:
    """Return a calibration that forecasts the flights well; that of the file at worst."""
    knobs = flights[0].knobs
    shared = [k for k, knob in enumerate(knobs) if not knob.per_flight]
    first = _list_first(knobs)
    unknown = np.diag([knob.tolerance**2 for knob in knobs])
    best = CoarseCalibration(np.zeros(len(knobs)), np.zeros(len(flights)), unknown)
    short = build_forecast_fitter(nominal, flights, SHORT, APART[0])
    if short is not None:
        fitter, picked = short
        starts = _fit_at_delays(fitter, knobs, first, DELAYS)
        if starts:
            every = range(len(picked))
            start = min(starts, key=lambda fit: fitter.rms_error(fit.values, every))
            late = [k for k in shared if knobs[k].name == DELAY]
            best = _improve(fitter, picked, best, start.values, [*first, *late])
    # In longer forecasts, a fast oscillation is out of phase unless the short ones corrected it.
    # The second time, errors are weighed by what a swing of the right period leaves.
    long = build_forecast_fitter(nominal, flights, LONG, APART[1])
    for fitter, picked in filter(None, (short, long, long)):
        fitter.weigh_errors(best.values, best.lifts[picked].tolist())
        best = _improve(fitter, picked, best, best.values, shared)
    if short is not None:
        # A flight that is too short for forecasts has the mean lift of the others
        rest = [f for f in range(len(flights)) if f not in short[1]]
        best.lifts[rest] = best.lifts[short[1]].mean()
    return best


def settle_calibration(
    nominal: NominalVehicle, flights: Sequence[FlightLinearizer], coarse: CoarseCalibration
) -> CoarseCalibration:
    """
    Return the calibration to which repeated fits to the longest forecasts settle.

    Each time, errors are weighed by what the fit before left: those of a swing whose period is
    nearly right are small, and tell the rest of it. Of flights that the model explains, it would
    follow the noise.
    """
    built = build_longest_fitter(nominal, flights)
    if built is None:
        return coarse
    fitter, picked = built
    shared = [k for k, knob in enumerate(fitter.knobs) if not knob.per_flight]
    limits = STILL * np.array([knob.tolerance for knob in fitter.knobs])
    for _ in range(REPEATS):
        before = coarse.values
        fitter.weigh_errors(before, coarse.lifts[picked].tolist())
        coarse = _improve(fitter, picked, coarse, before, shared)
        if np.all(np.abs(coarse.values - before) < limits):
            break
    return coarse


def leave_out_shapes(
    nominal: NominalVehicle, flights: Sequence[FlightLinearizer], coarse: CoarseCalibration
) -> CoarseCalibration:
    """
    Return the calibration without drags and exponents that no flight outside of the fit needs.

    Each flight, or part of one or two flights, is forecast by a fit to the others, with and
    without the parameters. Without them, a fit to all has to explain each flight nearly as well,
    too. Flights too short to be divided change nothing.
    """
    built = build_longest_fitter(nominal, flights)
    if built is None:
        return coarse
    fitter, picked = built
    knobs, best = fitter.knobs, coarse
    fitter.weigh_errors(coarse.values, coarse.lifts[picked].tolist())
    count = 1 if len(picked) > 2 else PARTS // len(picked)
    parts = [part for one in fitter.flights for part in _divide_flight(one, count)]
    if len(parts) < 2:
        return coarse
    divided = ForecastFitter(nominal, parts, fitter.lift, horizons=fitter.horizons)
    divided.weights = fitter.weights
    which = [k for k, knob in enumerate(knobs) if not knob.per_flight]
    try:
        _, inside, errors = _forecast_left_out(divided, which, coarse.values)
        for names in SHAPES:
            held = [k for k in which if knobs[k].name.startswith(names)]
            if not held:
                continue
            fewer = [k for k in which if k not in held]
            begin = best.values.copy()
            begin[held] = 0.0
            values, within, now = _forecast_left_out(divided, fewer, begin)
            if not np.sqrt(np.mean((now / errors) ** 2)) < NEEDED:
                continue
            if not np.all(within < MISSED * inside):
                continue
            unknown = np.diag([knob.tolerance**2 for knob in knobs])
            start = CoarseCalibration(values, best.lifts, unknown, (*best.held, *held))
            best, which = _improve(fitter, picked, start, values, fewer), fewer
    except (BadInput, np.linalg.LinAlgError):
        return best
    return best


def _divide_flight(flight: FlightLinearizer, count: int) -> list[FlightLinearizer]:
    """Return a flight in up to `count` parts of equal length, each of several pieces."""
    if count == 1:
        return [flight]
    cut = flight.replay.cut
    begins, ends = cut.first, cut.first + cut.length
    edges = np.linspace(begins[0], ends[-1], count + 1)
    out = []
    for low, high in pairwise(edges):
        inside = (begins >= low) & (ends <= high)
        if inside.sum() < 2:
            return _divide_flight(flight, count - 1)
        out.append(select_pieces(flight, inside))
    return out


def _forecast_left_out(
    fitter: ForecastFitter, which: Sequence[int], begin: Array
) -> tuple[Array, Array, Array]:
    """Return a fit of some parameters, and each flight's errors by it and by a fit to the rest."""
    spread = np.array([fitter.knobs[k].tolerance for k in which])
    every = range(len(fitter.flights))
    fit = fitter.fit(which, spread, every, begin, LEFT_OUT_ROUNDS)
    inside = [fitter.rms_error(fit.values, [f]) for f in every]
    outside = [
        fitter.rms_error(fitter.leave_out_flights(fit, which, spread, [f]), [f]) for f in every
    ]
    return fit.values, np.array(inside), np.array(outside)


def _fit_at_delays(
    fitter: ForecastFitter,
    knobs: Sequence[FreeParameter],
    which: Sequence[int],
    delays: Sequence[float],
) -> list[ForecastFit]:
    """Return a fit of some parameters at each delay that the model accepts."""
    late = next((k for k, knob in enumerate(knobs) if knob.name == DELAY), None)
    out = []
    for delay in delays if late is not None else delays[:1]:
        begin = np.zeros(len(knobs))
        if late is not None:
            begin[late] = min(max(delay, knobs[late].low), knobs[late].high)
        try:
            out.append(_fit(fitter, which, begin, 2))
        except (BadInput, np.linalg.LinAlgError):
            continue
    return out


def _fit(
    fitter: ForecastFitter,
    which: Sequence[int],
    begin: Array,
    rounds: int,
) -> ForecastFit:
    """Fit some parameters to all flights."""
    spread = np.array([fitter.knobs[k].tolerance for k in which])
    every = range(len(fitter.flights))
    return fitter.fit(which, spread, every, begin, rounds, relinearize=False)


def _improve(
    fitter: ForecastFitter,
    picked: Sequence[int],
    before: CoarseCalibration,
    begin: Array,
    which: Sequence[int],
) -> CoarseCalibration:
    """Return the fit to the picked flights from a start, or what was before if no better."""
    every = range(len(picked))
    try:
        fit = _fit(fitter, which, begin, ROUNDS)
    except (BadInput, np.linalg.LinAlgError):
        return before
    if not fitter.rms_error(fit.values, every) < fitter.rms_error(before.values, every):
        return before
    spread = np.array([fitter.knobs[k].tolerance for k in which])
    covariance = before.covariance.copy()
    covariance[np.ix_(which, which)] = np.linalg.inv(fit.precision + np.diag(spread**-2.0))
    lifts = before.lifts.copy()
    lifts[list(picked)] = fit.lifts
    return CoarseCalibration(fit.values, lifts, covariance, before.held)
