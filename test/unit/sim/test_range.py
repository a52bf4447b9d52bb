# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The VL53L1x: limits, tilt, rounding, and noise against the firmware's formula."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_model.sensors import range as tof
import numpy as np
import pytest
from scipy.stats import chi2, kstest

NO_OFFSET = tof.RangeErrors(offset=0.0)
SETTINGS = tof.RangeSettings()
SILENT = tof.RangeSettings(noise=0.0)


def read(height, up=1.0, settings=SILENT, errors=NO_OFFSET, seed=1):
    return tof.measure_range(settings, errors, height, up, np.random.default_rng(seed))


@pytest.mark.parametrize(
    ('distance', 'deviation'),
    # 2.5 mm (1 + 80^((d - 2.5) / 1.5)): at 2.5 m twice 2.5 mm, at 4 m 81 times.
    [
        (2.5, 0.005),
        (4.0, 0.2025),
        (1.0, 0.0025 * (1 + 1 / 80)),
        (0.5, 0.0025 * (1 + 80 ** (-4 / 3))),
    ],
)
def test_deviation_is_the_firmwares(distance, deviation):
    assert tof.noise_deviation(0.0025, distance) == pytest.approx(deviation, rel=1e-12)


@pytest.mark.parametrize('height', [0.5, 2.5, 3.2])
def test_noise_has_the_deviation(height):
    rng = np.random.default_rng(2)
    size = 20000
    sample = [tof.measure_range(SETTINGS, NO_OFFSET, height, 1.0, rng) for _ in range(size)]
    sigma = 0.0025 * (1 + 80 ** ((height - 2.5) / 1.5))
    ratio = np.var(sample, ddof=1) / (sigma**2 + 1e-6 / 12)  # rounding to 1 mm
    low, high = chi2.ppf([1e-6, 1 - 1e-6], size - 1) / (size - 1)
    assert low < ratio < high
    assert 0.9**2 < low < high < 1.1**2
    assert np.mean(sample) == pytest.approx(height, abs=5 * sigma / math.sqrt(size))


def test_readings_are_whole_millimetres():
    assert read(0.12345) == pytest.approx(0.123, abs=1e-12)
    assert read(0.12351) == pytest.approx(0.124, abs=1e-12)


@pytest.mark.parametrize(
    ('height', 'up', 'told'),
    [
        (0.5, math.cos(math.radians(60.0)), pytest.approx(1.0, abs=1e-12)),  # the slant
        (4.0, 1.0, 4.0),
        *((height, 1.0, -math.inf) for height in (0.039, 0.0, -0.01)),
        *((*lost, math.inf) for lost in ((4.01, 1.0), (2.1, 0.5), (0.5, 0.0), (0.5, -1.0))),
        (0.5, 1e-300, math.inf),
    ],
)
def test_a_reading_is_the_slant_or_infinite_beyond_the_reach(height, up, told):
    assert read(height, up) == told


def test_bright_light_shortens_the_reach():
    bright = tof.RangeSettings(maximum=0.7, noise=0.0)
    assert read(0.71, settings=bright) == math.inf
    assert read(0.69, settings=bright) == pytest.approx(0.69)


def test_the_offset_is_uniform_within_20_mm_and_added():
    rng = np.random.default_rng(3)
    offsets = [tof.draw_errors(SETTINGS, rng).offset for _ in range(3000)]
    assert kstest(offsets, 'uniform', (-0.02, 0.04)).pvalue > 1e-4
    assert read(1.0, errors=tof.RangeErrors(offset=0.013)) == pytest.approx(1.013)


@given(st.floats(0.0, 10.0), st.floats(-1.0, 1.0))
def test_a_reading_is_in_range_or_infinite_and_takes_one_number_of_chance(height, up):
    rng = np.random.default_rng(4)
    value = tof.measure_range(SETTINGS, NO_OFFSET, height, up, rng)
    assert math.isinf(value) or SETTINGS.minimum <= value <= SETTINGS.maximum
    other = np.random.default_rng(4)
    other.standard_normal()
    assert rng.standard_normal() == other.standard_normal()
