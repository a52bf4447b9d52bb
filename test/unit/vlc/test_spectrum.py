# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The spectrum against a sum over sines written out here; its statistics and faults."""

import math

from lta_vlc.demodulation import (
    detect_sample_faults,
    detect_tone_faults,
    DiodeFault,
    FAULTS_BY_VALUE,
    UNUSABLE_FAULTS,
)
from lta_vlc.spectral.spectrum import (
    amplitude_spectrum,
    SampleStatistics,
    scan_spectrum,
    SpectrumScan,
    target_bin,
)
import numpy as np
import pytest


def goertzel(samples, k: int) -> float:
    """Return the magnitude of bin k of a discrete Fourier transform by Goertzel's recursion."""
    coefficient = 2.0 * math.cos(2.0 * math.pi * k / len(samples))
    last, before = 0.0, 0.0
    for sample in samples:
        last, before = float(sample) + coefficient * last - before, last
    return math.sqrt(last**2 + before**2 - coefficient * last * before)


@pytest.mark.parametrize(
    ('frequency', 'sample_rate', 'samples', 'k'),
    [
        (150.0, 10_000.0, 1000, 15),
        (150.0, 10_000.0, 1024, 15),  # 15.36
        (150.0, 9_000.0, 250, 4),  # 4.17
        (25.0, 10.0, 1, 3),  # 2.5: a half goes up
        (15.0, 10.0, 1, 2),  # 1.5
    ],
)
def test_target_bin_is_the_papers(frequency, sample_rate, samples, k):
    assert target_bin(frequency, sample_rate, samples) == k


def test_every_bin_is_a_sum_over_the_samples():
    generator = np.random.default_rng(3)
    block = generator.integers(0, 4096, size=(200, 3), dtype=np.uint16)
    spectrum = amplitude_spectrum(block)
    for diode in range(3):
        for k in range(1, 100):
            hand = goertzel(block[:, diode], k) * 2.0 / 200.0
            assert spectrum[k, diode] == pytest.approx(hand, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize('level', [0, 1, 4095, 65535])
@pytest.mark.parametrize('samples', [1000, 997])
def test_flat_line_reads_exactly_zero(level, samples):
    block = np.full((samples, 2), level, dtype=np.uint16)
    assert not amplitude_spectrum(block).any()


def test_block_is_left_as_it_was():
    block = np.random.default_rng(6).normal(size=(50, 2))
    before = block.copy()
    amplitude_spectrum(block)
    assert np.array_equal(block, before)


def surveyed(weight=(1.0, 1.0)):
    """Return the survey of eight bins of two diodes, with beacons in bins 1 to 3 and 5 to 6."""
    size = np.array(
        [[9.0, 1.0, 4.0, 1.0, 0.5, 2.0, 3.0, 0.7], [9.0, 5.0, 1.0, 2.0, 1.5, 0.0, 1.0, 0.1]]
    )
    ranges = np.array([[1, 3], [5, 6]])
    return scan_spectrum(size, ranges, np.array([4, 7]), np.array([7]), np.array(weight))


def test_the_highest_bin_is_chosen_by_the_diodes_of_weight_one():
    assert surveyed((1.0, 0.0)).highest.tolist() == [2, 6]
    assert surveyed((0.0, 1.0)).highest.tolist() == [1, 6]
    assert surveyed((0.0, 0.0)).highest.tolist() == [1, 5]


def test_more_than_a_hundredth_of_the_samples_at_full_scale_is_saturation():
    level, span = np.array([1.0, 1.0, 2.0, math.nan]), np.array([5.0, 5.0, 0.0, 0.0])
    looked = SampleStatistics(level, span, np.array([0.01, 0.0101, 1.0, 1.0]))
    assert [FAULTS_BY_VALUE[k] for k in detect_sample_faults(looked).tolist()] == [
        DiodeFault.NONE, DiodeFault.SATURATED, DiodeFault.SATURATED | DiodeFault.FLAT,
        DiodeFault.NOT_A_NUMBER,
    ]  # fmt: skip
    assert [FAULTS_BY_VALUE[fault.value] for fault in DiodeFault] == list(DiodeFault)
    assert DiodeFault.ALIASED not in UNUSABLE_FAULTS  # beacons can be read beside an unknown tone


def test_a_tone_above_all_beacons_and_six_times_the_noise_is_an_alias():
    loudest = np.array([6.0, 6.01, 9.0, 9.01])
    peak = np.array([[1.0, 1.0, 2.0, 9.0], [2.0, 2.0, 9.0, 1.0]])
    found = SpectrumScan(np.zeros(2, np.int64), peak, np.ones(4), loudest)
    assert detect_tone_faults(found).tolist() == [
        0,
        DiodeFault.ALIASED.value,
        0,
        DiodeFault.ALIASED.value,
    ]
