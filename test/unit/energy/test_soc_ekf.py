# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The filter of one cell: by hand where one number decides, against numpy's algebra elsewhere."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_energy.monitoring import soc_ekf
from lta_energy.monitoring.soc_ekf import (
    correct_state,
    initial_state,
    initialize_from_reading,
    predict_state,
    SocFilterSettings,
)
from lta_model.electrical.battery import BatteryModel, open_circuit_voltage
import numpy as np
import pytest

SETTINGS = SocFilterSettings()
CELL = BatteryModel(
    capacity=900.0, resistance=0.15, relaxation_resistance=0.094, relaxation_time=33.0
)


def spread(state):
    return np.array(state.spread)


@pytest.mark.parametrize('charge', [0.07, 0.3, 0.62, 0.97])
def test_a_first_reading_at_rest_finds_the_charge_and_how_sure_it_is(charge):
    state = initialize_from_reading(SETTINGS, CELL, open_circuit_voltage(charge), 0.0)
    slope = soc_ekf.chord_slope(charge, soc_ekf.NARROWEST_CHORD)
    # The chart, the noise and what may still relax from 0.2 A, over the slope; beside 0.29.
    voltage = math.sqrt(0.010**2 + 0.010**2 + (0.094 * 0.2) ** 2)
    alone = voltage / slope
    assert state.deviation == pytest.approx(1.0 / math.hypot(1.0 / alone, math.sqrt(12.0)))
    assert state.charge == pytest.approx(charge, abs=0.5 * state.deviation)


readings = st.lists(
    st.tuples(st.floats(-2.0, 1.0), st.floats(3.3, 4.2), st.floats(0.05, 30.0)),
    min_size=1, max_size=12,
)  # fmt: skip


@given(readings)
def test_it_is_a_kalman_filter(series):
    """The same steps by matrices, as in any book."""
    state = initialize_from_reading(SETTINGS, CELL, 3.8, -0.1)
    for current, voltage, dt in series:
        step, kept = current * dt / CELL.capacity, math.exp(-dt / CELL.relaxation_time)
        faded = math.exp(-abs(step) / soc_ekf.CHART_CORRELATION)
        f = np.diag([1.0, kept, 1.0, 1.0, faded])
        f[0, 3] = step
        f[1, 2] = (1.0 - kept) * CELL.relaxation_resistance * current
        q = np.diag(
            [
                (0.01 * dt / CELL.capacity) ** 2 + soc_ekf.CHARGE_DRIFT**2 * dt,
                ((1.0 - kept) * CELL.relaxation_resistance * 0.01) ** 2,
                0.0,
                0.0,
                SETTINGS.chart_error**2 * (1.0 - faded**2),
            ]
        )
        ahead = predict_state(SETTINGS, CELL, state, current, 0.01, dt)
        np.testing.assert_allclose(spread(ahead), f @ spread(state) @ f.T + q, atol=1e-12)

        half = min(max(ahead.deviation, soc_ekf.NARROWEST_CHORD), soc_ekf.WIDEST_CHORD)
        h = np.array(
            [soc_ekf.chord_slope(ahead.charge, half), 1.0, CELL.resistance * current, 0.0, 1.0]
        )
        p, mean = spread(ahead), np.array(ahead.mean)
        s = h @ p @ h + SETTINGS.voltage_noise**2
        expected = open_circuit_voltage(ahead.charge) + h[1:] @ mean[1:]
        state, surprise = correct_state(SETTINGS, CELL, ahead, voltage, current)
        assert surprise.innovation == pytest.approx(voltage - expected, abs=1e-12)
        assert surprise.deviation == pytest.approx(math.sqrt(s))
        after = mean + p @ h / s * (voltage - expected)
        after[0] = min(max(after[0], 0.0), 1.0)
        np.testing.assert_allclose(state.mean, after, atol=1e-9)
        np.testing.assert_allclose(spread(state), p - np.outer(p @ h, h @ p) / s, atol=1e-12)


def test_what_is_not_known_at_first_by_hand():
    """The prior: any charge, 0.2 A over 94 mohm, 30 % and 5 %, and 10 mV of curve error."""
    state = initial_state(SETTINGS, CELL)
    assert state.mean == (0.5, 0.0, 1.0, 1.0, 0.0)
    variances = [1.0 / 12.0, 0.0188**2, 0.09, 0.0025, 1e-4]
    np.testing.assert_allclose(spread(state), np.diag(variances), rtol=1e-12)


@pytest.mark.parametrize('current', [-1.5, 0.4])
def test_a_first_reading_under_load_is_looked_at_where_it_points_to(current):
    """The expected values follow from one Kalman update, linearised over +- 1 % of charge."""
    told = open_circuit_voltage(0.62) + 0.15 * current
    state = initialize_from_reading(SETTINGS, CELL, told, current)
    slope = (open_circuit_voltage(0.63) - open_circuit_voltage(0.61)) / 0.02
    h = np.array([slope, 1.0, 0.15 * current, 0.0, 1.0])
    start = initial_state(SETTINGS, CELL)
    p = spread(start)
    expected = open_circuit_voltage(0.62) + slope * (0.5 - 0.62) + 0.15 * current
    gain = p @ h / (h @ p @ h + 0.01**2)
    np.testing.assert_allclose(state.mean, np.array(start.mean) + gain * (told - expected))
    np.testing.assert_allclose(spread(state), p - np.outer(gain, h @ p), atol=1e-15)


def sure(charge, deviation, chart=0.0):
    """Return a belief in which only the charge has a variance."""
    rows = [[0.0] * 5 for _ in range(5)]
    rows[0][0] = deviation**2
    return soc_ekf.CellState((charge, 0.0, 1.0, 1.0, chart), tuple(map(tuple, rows)))


@pytest.mark.parametrize(
    ('deviation', 'half'), [(0.001, 0.01), (0.05, 0.05), (0.2, 0.2), (0.4, 0.2)]
)
def test_the_slope_is_that_of_a_chord_as_wide_as_the_belief_from_1_to_20_percent(deviation, half):
    rise = open_circuit_voltage(0.5 + half) - open_circuit_voltage(0.5 - half)
    _, surprise = correct_state(SETTINGS, CELL, sure(0.5, deviation), 3.85, 0.0)
    assert surprise.innovation == pytest.approx(0.01)
    assert surprise.deviation == pytest.approx(math.hypot(rise / (2 * half) * deviation, 0.01))


def test_a_chord_ends_where_the_cell_is_empty_or_full():
    assert soc_ekf.chord_slope(0.0, 0.05) == pytest.approx((3.61 - 3.27) / 0.05)
    assert soc_ekf.chord_slope(1.0, 0.05) == pytest.approx((4.20 - 4.15) / 0.05)


def test_a_charge_ends_at_empty_and_full():
    for current, end in ((-3.0, 0.0), (3.0, 1.0)):
        after = predict_state(SETTINGS, CELL, sure(0.5, 0.1), current, 0.0, 600.0)
        assert after.charge == end
    for voltage, end in ((2.0, 0.0), (6.0, 1.0)):
        assert correct_state(SETTINGS, CELL, sure(0.5, 0.2), voltage, 0.0)[0].charge == end
