# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Waves of lamps, and what a demodulator reads of them."""

from fractions import Fraction
import math

from lta_model.light.lamp import phase_in_cycles, SquareWave
from lta_vlc.demodulation import demodulate_beacon, find_peaks, plan_bins
from lta_vlc.settings import DemodulationSettings
import numpy as np
import pytest
from square_waves import sample_wave

from .square_mean import mean_on

RATE = 10_000.0
TIMES = np.arange(1000, dtype=np.int64) * 100_000


def test_plan_of_the_default_beacon():
    bins = plan_bins(DemodulationSettings(), RATE, 1000)
    assert (bins.first, bins.last, bins.width, bins.samples) == (13, 17, 10.0, 1000)
    # 500 bins above zero; 33 harmonics below Nyquist, bins 15 to 495, five bins each.
    assert bins.quiet.size == 500 - 33 * 5


def test_peak_and_snr_of_a_spectrum_by_hand():
    bins = plan_bins(DemodulationSettings(window=1, harmonics=1), 100.0 * 150.0 / 10.0, 100)
    assert (bins.first, bins.last) == (9, 11)
    spectrum = np.full((51, 2), 0.5)
    spectrum[0] = 1e9
    spectrum[11, 0] = 8.0
    spectrum[9, 1] = 3.0
    spectrum[20, 1] = 0.5 + 47.0  # one of 47 quiet bins: adds 1 to their mean
    peaks = find_peaks(spectrum, bins)
    assert bins.quiet.size == 47
    assert peaks.amplitude == pytest.approx([8.0, 3.0])
    assert peaks.snr == pytest.approx([16.0, 2.0])
    assert peaks.frequency == pytest.approx([165.0, 135.0])


@pytest.mark.parametrize('duty', [0.5, 0.3])
def test_square_wave_reads_its_fundamental(duty):
    wave = SquareWave(150.0, duty, phase=0.123)
    block = 1000.0 * mean_on(wave, TIMES, 100_000)[:, None]
    peaks = demodulate_beacon(block, plan_bins(DemodulationSettings(), RATE, 1000))
    # 2/pi sin(pi d), times the sine cardinal of averaging over 1.5 % of a period.
    loss = math.sin(math.pi * 0.015) / (math.pi * 0.015)
    hand = 1000.0 * 2.0 / math.pi * math.sin(math.pi * duty) * loss
    # What aliases onto the fundamental stands in harmonics 199 and 201: within 1/200^2.
    assert peaks.amplitude[0] == pytest.approx(hand, rel=5e-5)
    assert peaks.frequency[0] == pytest.approx(150.0, abs=1e-3)


@pytest.mark.parametrize('drift', [-20.0, -10.0, -3.3, 4.9, 10.0, 20.0])
def test_drifting_beacon_is_found_within_the_window(drift):
    sine = np.sin(2.0 * math.pi * (150.0 + drift) * TIMES * 1e-9)[:, None]
    peaks = demodulate_beacon(100.0 * sine, plan_bins(DemodulationSettings(), RATE, 1000))
    assert peaks.frequency[0] == pytest.approx(150.0 + drift, abs=1e-4)
    assert peaks.amplitude[0] == pytest.approx(100.0, rel=1e-5)


def test_snr_of_a_sine_in_white_noise():
    generator = np.random.default_rng(11)
    amplitude, deviation = 20.0, 30.0
    sine = amplitude * np.sin(2.0 * math.pi * 150.0 * TIMES * 1e-9)
    block = sine[:, None] + generator.normal(0.0, deviation, size=(1000, 400))
    peaks = demodulate_beacon(block, plan_bins(DemodulationSettings(), RATE, 1000))
    # Rayleigh mean of the quiet bins: deviation sqrt(pi / n).
    hand = amplitude / (deviation * math.sqrt(math.pi / 1000.0))
    # One block in 400 scatters by 6.7 % (peak) and 2.9 % (noise): the mean by 0.4 %; plus the
    # Rician rise of the peak, 1/(2 SNR^2) (2/pi ... 4/pi), 0.5 %.
    assert peaks.snr.mean() == pytest.approx(hand, rel=0.02)


@pytest.mark.parametrize('window', [0, 2, 4])
def test_false_alarms_are_as_rare_as_stated(window):
    block = np.random.default_rng(12).normal(size=(1000, 8000))
    snr = demodulate_beacon(block, plan_bins(DemodulationSettings(window=window), RATE, 1000)).snr
    # One of 2 window + 1 Rayleigh draws above 2.5 means: 0.74, 3.64 and 6.45 %; 8000 such blocks
    # scatter by 0.10, 0.21 and 0.27 %, and the mean of some 300 quiet bins adds a twentieth.
    one = math.exp(-math.pi * 2.5**2 / 4.0)
    hand = 1.0 - (1.0 - one) ** (2 * window + 1)
    assert (snr >= 2.5).mean() == pytest.approx(
        hand, abs=3.0 * math.sqrt(hand / 8000.0) + 0.1 * hand
    )
    assert not (snr >= DemodulationSettings().threshold).any()


def test_flat_and_saturated_blocks_have_no_snr():
    block = np.full((1000, 3), 4095, dtype=np.uint16)
    peaks = demodulate_beacon(block, plan_bins(DemodulationSettings(), RATE, 1000))
    assert peaks.snr.tolist() == [0.0, 0.0, 0.0]
    assert peaks.amplitude.tolist() == [0.0, 0.0, 0.0]


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
