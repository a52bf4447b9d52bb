# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The BMP388: the standard atmosphere's tables, noise, offset, drift and counts."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_model.sensors import pressure
import numpy as np
import pytest
from scipy.stats import chi2, kstest

EXACT = pressure.PressureErrors(offset=0.0, drift=0.0)
SILENT = pressure.PressureSettings(noise=0.0)


@pytest.mark.parametrize(
    ('height', 'expected'),
    [(0.0, 101325.0), (1000.0, 89874.6), (5000.0, 54019.9)],  # ICAO Doc 7488, Pa
)
def test_the_standard_atmosphere(height, expected):
    assert pressure.air_pressure(101325.0, height) == pytest.approx(expected, rel=2e-5)


def test_a_metre_is_twelve_pascals():
    # Hydrostatics: rho g = 1.225 kg/m^3 * 9.80665 m/s^2 = 12.013 Pa/m at the floor.
    drop = pressure.air_pressure(101325.0, -0.5) - pressure.air_pressure(101325.0, 0.5)
    assert drop == pytest.approx(12.013, abs=0.001)


def test_noise_is_1_2_pascals():
    rng = np.random.default_rng(1)
    size = 20000
    settings = pressure.PressureSettings()
    sample = [pressure.measure_pressure(settings, EXACT, 0.5, 0.0, rng) for _ in range(size)]
    ratio = np.var(sample, ddof=1) / (1.2**2 + 0.33**2 / 12)
    low, high = chi2.ppf([1e-6, 1 - 1e-6], size - 1) / (size - 1)
    assert low < ratio < high
    assert 0.95**2 < low < high < 1.05**2
    expected = pressure.air_pressure(101325.0, 0.5)
    assert np.mean(sample) == pytest.approx(expected, abs=5 * 1.2 / math.sqrt(size))


def test_offset_and_drift_add_up():
    errors = pressure.PressureErrors(offset=-5.0, drift=0.01)
    read = pressure.measure_pressure(SILENT, errors, 0.0, 200.0, np.random.default_rng(2))
    assert read == pytest.approx(101325.0 - 5.0 + 2.0, abs=0.165 + 1e-9)


def test_offset_and_drift_are_drawn_uniformly():
    rng = np.random.default_rng(3)
    drawn = [pressure.draw_errors(pressure.PressureSettings(), rng) for _ in range(3000)]
    assert kstest([e.offset for e in drawn], 'uniform', (-8.0, 16.0)).pvalue > 1e-4
    assert kstest([e.drift for e in drawn], 'uniform', (-0.006, 0.012)).pvalue > 1e-4


@given(st.floats(0.0, 100.0))
def test_a_reading_is_a_count_within_half_a_step(height):
    read = pressure.measure_pressure(SILENT, EXACT, height, 0.0, np.random.default_rng(4))
    assert read / 0.33 == pytest.approx(round(read / 0.33), abs=1e-6)
    assert abs(read - pressure.air_pressure(101325.0, height)) <= 0.165 + 1e-9
