# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The INA219: steps of 4 mV and 0.1 mA, errors of the data sheet, clipping."""

from hypothesis import given
from hypothesis import strategies as st
from lta_sim import supply
import numpy as np
import pytest
from scipy.stats import chi2, kstest

SETTINGS = supply.PowerMeterSettings()
SILENT = supply.PowerMeterSettings(voltage_noise=0.0, current_noise=0.0)
EXACT = supply.PowerMeterErrors(voltage_gain=1.0, current_gain=1.0, current_offset=0.0)


def read(voltage, current, settings=SILENT, errors=EXACT):
    return supply.measure_voltage_and_current(
        settings, errors, voltage, current, np.random.default_rng(1)
    )


def test_steps_are_the_data_sheets():
    assert read(3.7031, -0.40026) == pytest.approx((3.704, -0.4003), abs=1e-12)
    assert read(3.7019, -0.40024) == pytest.approx((3.700, -0.4002), abs=1e-12)


@pytest.mark.parametrize(('true', 'expected'), [(-4.4, -3.2), (4.4, 3.2), (-3.19, -3.19)])
def test_the_current_is_clipped_at_320_millivolts_over_the_shunt(true, expected):
    assert read(3.7, true)[1] == pytest.approx(expected, abs=1e-12)


def test_a_dead_cell_reads_zero_and_never_less():
    readings = {
        supply.measure_voltage_and_current(SETTINGS, EXACT, 0.0, 0.0, np.random.default_rng(seed))[
            0
        ]
        for seed in range(200)
    }
    assert min(readings) == 0.0
    assert max(readings) > 0.0


def test_gain_and_offset():
    errors = supply.PowerMeterErrors(voltage_gain=1.002, current_gain=0.998, current_offset=4e-4)
    assert read(4.0, -1.0, errors=errors) == pytest.approx((4.008, -0.9976), abs=1e-12)


def test_noise_is_half_a_step_before_rounding():
    rng = np.random.default_rng(2)
    size = 20000
    # Away from a step's middle the rounding is not uniform noise: spread the truth over steps.
    truth = rng.uniform(3.0, 4.2, size), rng.uniform(-1.0, 0.0, size)
    sample = np.array(
        [
            supply.measure_voltage_and_current(SETTINGS, EXACT, v, i, rng)
            for v, i in zip(*truth, strict=True)
        ]
    )
    low, high = chi2.ppf([1e-6, 1 - 1e-6], size - 1) / (size - 1)
    assert 0.95**2 < low < high < 1.05**2
    for error, step in zip((sample - np.array(truth).T).T, (4e-3, 1e-4), strict=True):
        assert low < np.var(error, ddof=1) / (step**2 / 4 + step**2 / 12) < high


def test_errors_are_drawn_uniformly():
    rng = np.random.default_rng(3)
    drawn = [supply.draw_meter_errors(SETTINGS, rng) for _ in range(3000)]
    assert kstest([e.voltage_gain for e in drawn], 'uniform', (0.998, 0.004)).pvalue > 1e-4
    assert kstest([e.current_gain for e in drawn], 'uniform', (0.998, 0.004)).pvalue > 1e-4
    assert kstest([e.current_offset for e in drawn], 'uniform', (-4e-4, 8e-4)).pvalue > 1e-4


@given(st.floats(0.0, 5.0), st.floats(-3.0, 3.0))
def test_a_silent_meter_is_right_to_half_a_step(voltage, current):
    volts, amperes = read(voltage, current)
    assert abs(volts - voltage) <= 2e-3 + 1e-12
    assert abs(amperes - current) <= 5e-5 + 1e-12
