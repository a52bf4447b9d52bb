"""Forecasts as what knobs are fitted to, and what carries over to a regime left out."""

from dataclasses import replace
from itertools import pairwise

from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.forecast.horizon_errors import compute_horizon_errors
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.transfer.cross_validation import (
    cross_validate,
    format_interpolation_warning,
    RegimeForecastErrors,
)
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
OFF = 0.4  # of the drag ahead that a model lacks
DRAG = 'quadratic_drag.surge'


@pytest.fixture(scope='module')
def lacking(gtmab: Known, clean: FlightLinearizer) -> tuple[ForecastFitter, int, float]:
    """A model with too little drag, the knob, and by how much it has to be turned."""
    nominal, known = gtmab
    k = [knob.name for knob in known].index(DRAG)
    off = OFF * nominal.parameter_value('quadratic_drag', 'surge')
    wrong = known[k].apply_to(nominal, -off)
    return ForecastFitter(wrong, [clean, clean], 0.0006), k, off


def test_columns_are_what_small_turns_do(gtmab: Known, clean: FlightLinearizer) -> None:
    """Against differences of whole flights, for knobs of each reach."""
    nominal, known = gtmab
    point = unchanged_vehicle_point(nominal, known, clean.replay.cut)
    names = ('vehicle.mass', 'thrust_scale.factor', 'tracker_misalignment.pitch', DRAG)
    which = [[knob.name for knob in known].index(name) for name in names]
    found = compute_horizon_errors(clean, point, which)
    for column, k in enumerate(which):
        step = 1e-3 * (known[k].typical or known[k].tolerance)
        there = replace(point, nominal=known[k].apply_to(nominal, step))
        slope = -(compute_horizon_errors(clean, there).errors - found.errors) / step
        close = 0.03 * np.nanmax(np.abs(slope))  # attitudes turn with what is left over
        told = np.isfinite(found.errors)
        np.testing.assert_allclose(found.columns[told, column], slope[told], atol=close)


def test_what_a_model_lacks_is_fitted(lacking: tuple[ForecastFitter, int, float]) -> None:
    """Within a tenth, and the forecasts are better for it."""
    sight, k, off = lacking
    found = sight.fit([k], np.array([3.0 * off]), [0, 1], rounds=3)
    assert found.values[k] == pytest.approx(off, rel=0.1)
    assert sight.rms_error(found.values, [0]) < 0.9 * sight.rms_error(
        np.zeros(len(sight.knobs)), [0]
    )


def test_a_fit_from_far_off_never_gets_worse(lacking: tuple[ForecastFitter, int, float]) -> None:
    """Begun at five times what is lacking; each round ends where the last did, or lower."""
    sight, k, off = lacking
    begin = np.zeros(len(sight.knobs))
    begin[k] = 5.0 * off
    spread = np.array([10.0 * off])
    costs = []
    for rounds in range(4):
        found = sight.fit([k], spread, [0, 1], begin, rounds)
        costs.append(sum(one.cost for one in found.equations) + (found.values[k] / spread[0]) ** 2)
    assert all(later <= before + 1e-9 for before, later in pairwise(costs))
    assert costs[-1] < 0.3 * costs[0]


def test_large_errors_count_by_their_size(lacking: tuple[ForecastFitter, int, float]) -> None:
    """Twice as far off costs four times as much while it is usual, and twice beyond."""
    sight, k, _ = lacking
    usual = sight.weights
    costs = []
    try:
        for times in (1e-3, 2e-3, 1e4, 2e4):
            sight.weights = times * usual
            said = sight.fit([k], np.ones(1), [0], rounds=0).equations
            costs.append(said[0].cost)
    finally:
        sight.weights = usual
    assert costs[1] / costs[0] == pytest.approx(4.0, rel=1e-6)
    assert costs[3] / costs[2] == pytest.approx(2.0, rel=1e-2)


def test_a_true_effect_carries_over(lacking: tuple[ForecastFitter, int, float]) -> None:
    """Taught by one flight, better on the other: no warning."""
    sight, k, off = lacking
    spread = np.array([3.0 * off])
    found = sight.fit([k], spread, [0, 1], rounds=3)
    regimes = cross_validate(sight, found, [k], spread, {'slow': [0], 'fast': [1]})
    assert all(regime.ratio < 0.9 for regime in regimes)
    assert format_interpolation_warning([DRAG], regimes) == ''


def test_flights_are_left_out_of_a_fit_that_has_not_converged(
    lacking: tuple[ForecastFitter, int, float],
) -> None:
    """One step opposite to what the flights left out say leads away from the value."""
    sight, k, off = lacking
    spread = np.array([3.0 * off])
    begun = sight.fit([k], spread, [0, 1], rounds=0)
    values = sight.leave_out_flights(begun, [k], spread, [1])
    assert values[k] == pytest.approx(off, rel=0.1)
    assert sight.rms_error(values, [1]) < 0.9 * sight.rms_error(begun.values, [1])
    # One step with the equations of the fit is the first step of a fit to the others
    quick = sight.leave_out_flights(begun, [k], spread, [1], is_quick=True)
    first = sight.fit([k], spread, [0], begun.values, rounds=1, relinearize=False)
    np.testing.assert_allclose(quick, first.values, rtol=1e-9)
    assert sight.rms_error(quick, [1]) < 0.95 * sight.rms_error(begun.values, [1])


def test_what_only_interpolates_is_said_so() -> None:
    """Worse than the vehicle file in a regime left out."""
    regimes = [
        RegimeForecastErrors('fast', 4, 1.0, 1.5),
        RegimeForecastErrors('slow', 4, 1.0, 0.6),
    ]
    told = format_interpolation_warning(['hull_lift'], regimes)
    assert told.startswith('hull_lift: interpolation only')
    assert 'fast (1.50 times its error)' in told
    assert 'slow' not in told
