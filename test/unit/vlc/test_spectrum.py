"""The spectrum against a sum over sines written out here, and amplitudes by hand."""

import math

from lta_vlc.spectral.spectrum import amplitude_spectrum, target_bin
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


@pytest.mark.parametrize('samples', [100, 101])
@pytest.mark.parametrize('k', [1, 15, 49])
def test_sine_in_a_bin_reads_its_amplitude(samples, k):
    time = np.arange(samples)
    sine = 3.0 * np.sin(2.0 * math.pi * k * time / samples + 0.7) + 40.0
    spectrum = amplitude_spectrum(sine[:, None])[:, 0]
    assert spectrum.shape == (samples // 2 + 1,)
    assert spectrum[k] == pytest.approx(3.0, rel=1e-12)
    assert np.delete(spectrum, k).max() < 1e-12


def test_highest_bin_of_an_odd_block_is_a_bin_like_others():
    sine = 2.5 * np.sin(2.0 * math.pi * 50.0 * np.arange(101) / 101.0)
    assert amplitude_spectrum(sine[:, None])[50, 0] == pytest.approx(2.5, rel=1e-12)


def test_sine_between_bins_reads_two_over_pi():
    time = np.arange(1000)
    sine = np.sin(2.0 * math.pi * 100.5 * time / 1000.0)
    spectrum = amplitude_spectrum(sine[:, None])[:, 0]
    # 1/(n sin(pi/2n)) = 0.6366; the mirror image adds up to its own leak, 1/(200 pi).
    assert spectrum[100:102] == pytest.approx([2.0 / math.pi] * 2, abs=0.0017)


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


def test_power_is_that_of_the_samples():
    block = np.random.default_rng(5).normal(size=(500, 1))
    spectrum = amplitude_spectrum(block)[:, 0]
    # Parseval: half the square of each amplitude, the whole square of the highest.
    power = 0.5 * (spectrum[1:-1] ** 2).sum() + spectrum[-1] ** 2
    assert power == pytest.approx(block.var(), rel=1e-12)


def test_block_is_left_as_it_was():
    block = np.random.default_rng(6).normal(size=(50, 2))
    before = block.copy()
    amplitude_spectrum(block)
    assert np.array_equal(block, before)
