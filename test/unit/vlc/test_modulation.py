# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The square wave against exact fractions, its Fourier series and numbers by hand."""

from fractions import Fraction
import math

from lta_model.light.lamp import phase_in_cycles, SquareWave
import numpy as np
import pytest
from square_waves import sample_wave

EPOCH = 1_763_000_000_123_456_789  # ns, a date in 2025


def exact_cycles(time: int, frequency: float, phase: float) -> float:
    """Return the position in the period by rational arithmetic alone."""
    position = Fraction(time, 10**9) * Fraction(frequency) + Fraction(phase)
    return float(position - math.floor(position))


@pytest.mark.parametrize('frequency', [150.0, 149.9973, 100.0 / 3.0, 4999.0])
@pytest.mark.parametrize('hours', [0, 1, 1000])
def test_phase_is_exact_after_any_time(frequency, hours):
    start = EPOCH + hours * 3_600_000_000_000
    times = start + np.arange(0, 100_000_000, 100_000, dtype=np.int64)
    exact = [exact_cycles(int(time), frequency, 0.25) for time in times]
    # 500 cycles at 4999 Hz times the rounding of a product: a few 1e-13.
    distance = np.abs(phase_in_cycles(times, frequency, 0.25) - exact)
    assert np.minimum(distance, 1.0 - distance).max() < 5e-13


def test_phase_stays_below_one():
    assert phase_in_cycles(np.array([0], dtype=np.int64), 1.0, -1e-20)[0] == 0.0


def test_values_of_a_quarter_wave():
    wave = SquareWave(10.0, duty=0.25, phase=0.0)
    times = np.array([0, 24_999_999, 25_000_000, 99_999_999, 100_000_000], dtype=np.int64)
    assert sample_wave(wave, times).tolist() == [1.0, 1.0, 0.0, 0.0, 1.0]


def test_phase_shifts_the_wave_ahead():
    wave = SquareWave(10.0, duty=0.5, phase=0.5)
    assert sample_wave(wave, np.array([0, 49_999_999, 50_000_000])).tolist() == [0.0, 0.0, 1.0]


def test_lagged_wave_is_its_filtered_fourier_series():
    frequency, duty, time_constant = 150.0, 0.3, 4e-4
    times = np.arange(20_000, 20_000_000, 40_000, dtype=np.int64)
    order = np.arange(1, 20_001)
    # Series of a wave on from 0 to d: c_n = (1 - exp(-2 pi i n d)) / (2 pi i n).
    rotation = 2j * math.pi * order
    coefficient = (1.0 - np.exp(-rotation * duty)) / rotation
    coefficient = coefficient / (1.0 + rotation * frequency * time_constant)
    series = duty + 2.0 * np.real(
        np.exp(np.outer(times * (frequency * 1e-9), rotation)) @ coefficient
    )
    lagged = SquareWave(frequency, duty).sample_filtered(times, time_constant)
    # No time falls on an edge, where alone the rest of the series would add up (to 4e-5).
    assert np.abs(lagged - series).max() < 1e-8


def test_fast_lag_follows_and_slow_lag_averages():
    wave = SquareWave(150.0, duty=0.3)
    times = np.arange(1_000, 20_000_000, 99_991, dtype=np.int64)
    assert wave.sample_filtered(times, 1e-9) == pytest.approx(sample_wave(wave, times), abs=1e-9)
    # A triangle of 0.3 x 0.7 / (f tau) from end to end around the duty.
    slow = wave.sample_filtered(times, 10.0)
    assert np.abs(slow - 0.3).max() < 0.3 * 0.7 / 1500.0


def test_by_default_a_wave_is_on_for_the_first_half_of_each_cycle():
    times = np.array([0, 49_999_999, 50_000_000, 99_999_999])
    assert sample_wave(SquareWave(10.0), times).tolist() == [1.0, 1.0, 0.0, 0.0]
    assert phase_in_cycles(times, 10.0)[:3] == pytest.approx([0.0, 0.5, 0.5], abs=1e-7)
