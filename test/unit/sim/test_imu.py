# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The BMI088: specific force against analysis, errors and noise against the data sheet."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_model.sensors import imu
import numpy as np
import pytest
from scipy.stats import chi2, kstest

G = 9.81
number = st.floats(-5.0, 5.0)
vector = st.tuples(number, number, number)


def read(errors, force, rates, rng):
    """Return one sample from the true values, by plain Python."""
    chance = rng.standard_normal(6)
    imu.apply_errors((*force, *rates), imu.pack_errors(errors), chance)
    x, y, z, a, b, c = chance.tolist()
    return (x, y, z), (a, b, c)


def within_five_percent(sample, sigma):
    """Assert a standard deviation by chi square; a sigma off by 5 % fails, let alone by 10 %."""
    size = len(sample)
    ratio = (size - 1) * np.var(sample, ddof=1) / sigma**2
    assert chi2.ppf(1e-6, size - 1) < ratio < chi2.ppf(1 - 1e-6, size - 1)
    assert chi2.ppf(1 - 1e-6, size - 1) / (size - 1) < 1.05**2


@given(vector, vector, vector, vector, vector, vector)
def test_specific_force_is_the_textbook_sum(v, w, dv, dw, up, r):
    expected = (
        np.array(dv)
        + np.cross(w, v)
        + np.cross(dw, r)
        + np.cross(w, np.cross(w, r))
        + G * np.array(up)
    )
    got = imu.imu_specific_force(v, w, dv, dw, up, r, G)
    assert got == pytest.approx(tuple(expected), abs=1e-11)


def test_noise_is_the_data_sheets_density_times_the_root_of_the_bandwidth():
    rng = np.random.default_rng(1)
    errors = imu.draw_errors(imu.ImuSettings(), rng)
    samples = [read(errors, (0.0, 0.0, G), (0.1, 0.0, 0.0), rng) for _ in range(40000)]
    force = np.array([sample[0] for sample in samples])
    rates = np.array([sample[1] for sample in samples])
    # 160 ug/sqrt(Hz) * sqrt(40 Hz) = 1.0119 mg = 9.924 mm/s^2; 190 ug: 11.784 mm/s^2.
    # The rounding to a count of 6 g / 2^15 adds step^2 / 12, one part in three hundred.
    for axis, sigma in enumerate((9.924e-3, 9.924e-3, 11.784e-3)):
        within_five_percent(force[:, axis], math.hypot(sigma, 6 * 9.80665 / 2**15 / 12**0.5))
    # 0.014 deg/s/sqrt(Hz) * sqrt(32 Hz) = 0.0792 deg/s = 1.3822 mrad/s.
    for axis in range(3):
        within_five_percent(
            rates[:, axis], math.hypot(1.3822e-3, math.radians(500) / 2**15 / 12**0.5)
        )
    correlation = np.corrcoef(np.hstack([force, rates]).T) - np.eye(6)
    assert np.abs(correlation).max() < 5 / math.sqrt(40000)


def test_offsets_and_scales_are_uniform_within_the_data_sheets_bounds():
    rng = np.random.default_rng(2)
    drawn = [imu.draw_errors(imu.ImuSettings(), rng) for _ in range(3000)]
    bounds = [0.020 * 9.80665] * 3 + [math.radians(1.0)] * 3
    for axis, bound in enumerate(bounds):
        offsets = [errors.offset[axis] for errors in drawn]
        assert kstest(offsets, 'uniform', (-bound, 2 * bound)).pvalue > 1e-4
        gains = [errors.gain[axis] for errors in drawn]
        assert kstest(gains, 'uniform', (0.99, 0.02)).pvalue > 1e-4


def silent(**settings):
    """Return the errors of a sensor without noise."""
    quiet = imu.ImuSettings(acceleration_noise=(0.0, 0.0, 0.0), rate_noise=0.0, **settings)
    return imu.draw_errors(quiet, np.random.default_rng(3))


def test_a_reading_is_gain_times_truth_plus_offset_to_half_a_count():
    errors, truth = silent(), (1.0, -2.0, 9.0, 0.3, -0.2, 0.1)
    force, rates = read(errors, truth[:3], truth[3:], np.random.default_rng(4))
    for axis, reading in enumerate((*force, *rates)):
        expected = errors.gain[axis] * truth[axis] + errors.offset[axis]
        assert abs(reading - expected) <= errors.step[axis] / 2 * (1 + 1e-9)
        assert reading / errors.step[axis] == pytest.approx(
            round(reading / errors.step[axis]), abs=1e-6
        )


def test_a_crash_reads_full_scale():
    errors = silent(acceleration_range=3.0, rate_range=250.0)
    force, rates = read(errors, (1e3, -1e3, 0.0), (1e2, -1e2, 0.0), np.random.default_rng(5))
    assert force[:2] == pytest.approx((3 * 9.80665, -3 * 9.80665))
    assert rates[:2] == pytest.approx((math.radians(250), -math.radians(250)))
