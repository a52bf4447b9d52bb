# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Frequency and amplitude between the bins, against exact tones and against other ways.

Run as a script, it prints the table of `lta_vlc.spectral.tone`.
"""

import math
import sys

from lta_vlc.spectral.spectrum import fourier_transform
from lta_vlc.spectral.tone import dirichlet_kernel, estimate_tones
import numpy as np
import pytest

from .tones import RATE, SAMPLES, square, tone

TRIALS = 300


def read(waves, bins, samples=SAMPLES):
    """Return what is read of waves, shape (d, n), around some bins."""
    waves = np.atleast_2d(waves)
    weight = np.ones(len(waves))
    spectrum = fourier_transform(waves - waves.mean(axis=1, keepdims=True))
    return estimate_tones(spectrum, np.array(bins), weight, samples)


@pytest.mark.parametrize('offset', [0.0, 0.3, 0.5, -0.77, 13.25, -40.0])
def test_kernel_is_a_sum_over_the_samples(offset):
    n = np.arange(SAMPLES)
    hand = np.exp(2j * math.pi * offset * n / SAMPLES).mean()
    assert dirichlet_kernel(offset, SAMPLES) == pytest.approx(hand, abs=1e-13)


@pytest.mark.parametrize('phase', [0.0, 1.0, 2.5, -1.2])
@pytest.mark.parametrize('off', [-0.5, -0.31, -0.01, 0.0, 0.2, 0.49])
@pytest.mark.parametrize('k', [3, 15, 250, 480])
def test_a_lone_tone_reads_itself_anywhere_between_bins(k, off, phase):
    frequency = (k + off) * RATE / SAMPLES
    found = read(tone(frequency, phase, 7.0), [k])
    # In the lowest bins the mirror image is near: what second harmonics seem to be is less exact.
    near = 2e-5 if k > 3 else 2e-3
    assert found.frequency[0] == pytest.approx(k + off, abs=near)
    assert found.amplitude[0, 0] == pytest.approx(7.0, rel=2.0 * near)


def test_own_harmonics_do_not_leak_into_a_square_wave():
    """A square wave between bins has its fundamental, to the harmonics above the ninth."""
    found = [
        (read(square(place * 10.0, 0.37 * step), [round(place)]), place)
        for step, place in enumerate(np.linspace(14.5, 15.5, 50).tolist())
    ]
    assert rms(np.array([each.frequency[0] - place for each, place in found])) < 3e-4
    assert rms(np.array([each.amplitude[0, 0] - 1.0 for each, _ in found])) < 2e-4


@pytest.mark.parametrize(('k', 'read_at'), [(17.6, 16.0), (13.2, 14.0), (15.9, 15.9)])
def test_a_tone_is_sought_within_one_bin_of_the_highest(k, read_at):
    assert read(tone(10.0 * k), [15]).frequency[0] == pytest.approx(read_at, abs=1e-4)


def test_a_harmonic_beyond_the_last_bin_is_not_subtracted():
    """The second harmonic of 7.3 bins is at 14.6, but 16 samples have bins up to 8 only."""
    wave = 3.0 * np.cos(2.0 * math.pi * 7.3 * np.arange(16) / 16 + 0.4)
    assert read(wave, [7], 16).amplitude[0, 0] == pytest.approx(3.0, abs=0.3)


def test_a_diode_is_read_the_same_however_many_others_there_are():
    """Fifty diodes, more than the 33 bins, see two tones; only the first one has a weight."""
    chance, time = np.random.default_rng(3), np.arange(64)
    tones = [np.cos(2.0 * math.pi * k * time / 64 + p) for k, p in ((9.2, 0.3), (20.7, 1.0))]
    waves = chance.uniform(1.0, 5.0, (50, 2)) @ np.array(tones)
    spectrum, highest = (
        fourier_transform(waves - waves.mean(axis=1, keepdims=True)),
        np.array([9, 21]),
    )
    whole = estimate_tones(spectrum, highest, np.eye(50)[0], 64)
    for diode in (1, 20, 40, 49):
        pair = estimate_tones(spectrum[[0, diode]], highest, np.array([1.0, 0.0]), 64)
        assert whole.frequency == pytest.approx(pair.frequency, rel=1e-12)
        assert whole.amplitude[:, diode] == pytest.approx(pair.amplitude[:, 1], rel=1e-9)
        assert whole.own[:, diode] == pytest.approx(pair.own[:, 1], rel=1e-9)


def errors(snr: float, seed: int = 4) -> dict[str, np.ndarray]:
    """Return errors of frequency [bins] and amplitude by way, over tones anywhere in a bin."""
    chance = np.random.default_rng(seed)
    deviation = 1.0 / snr / math.sqrt(math.pi / SAMPLES) if snr else 0.0
    told: dict[str, list[float]] = {}
    for _ in range(TRIALS):
        place, phase = chance.uniform(14.5, 15.5), chance.uniform(0.0, 2.0 * math.pi)
        wave = tone(place * 10.0, phase) + deviation * chance.normal(size=SAMPLES)
        wave = wave - wave.mean()
        spectrum = np.fft.rfft(wave) * 2.0 / SAMPLES
        k = 13 + int(np.abs(spectrum[13:18]).argmax())
        ours = read(wave, [k])
        left, middle, right = spectrum[k - 1 : k + 2]
        candan = ((left - right) / (2.0 * middle - left - right)).real
        hann = np.abs(
            spectrum[k - 1 : k + 2] / 2.0 - (spectrum[k - 2 : k + 1] + spectrum[k : k + 3]) / 4.0
        )
        side = 1 if hann[2] > hann[0] else -1
        ratio = hann[1 + side] / hann[1]
        for way, value in {
            'frequency: this fit': ours.frequency[0] - place,
            "frequency: Candan's of three bins": k
            + math.tan(math.pi * candan / SAMPLES) * SAMPLES / math.pi
            - place,
            "frequency: Hann window, Grandke's": k
            + side * (2.0 * ratio - 1.0) / (ratio + 1.0)
            - place,
            'amplitude: this fit': ours.amplitude[0, 0] - 1.0,
            'amplitude: highest bin': abs(middle) - 1.0,
        }.items():
            told.setdefault(way, []).append(value)
    return {way: np.array(values) for way, values in told.items()}


def rms(values: np.ndarray) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def test_the_fit_has_the_least_error_in_noise():
    told = {way: rms(values) for way, values in errors(10.0).items()}
    ways = [way for way in told if way.startswith('frequency')]
    assert min(ways, key=told.get) == 'frequency: this fit'
    # The bound of noise alone, sqrt(6) / pi deviations over amplitude and root of samples [bins].
    bound = math.sqrt(6.0) / math.pi / (10.0 * math.sqrt(math.pi))
    assert told['frequency: this fit'] < 1.35 * bound
    # Of an amplitude: sqrt(2 / pi) over the SNR, and what three bins leave of the power.
    assert told['amplitude: this fit'] < 1.12 * math.sqrt(2.0 / math.pi) / 10.0
    assert told['amplitude: highest bin'] > 2.0 * told['amplitude: this fit']


if __name__ == '__main__':
    for snr in (0.0, 10.0, 100.0):
        for way, values in errors(snr).items():
            sys.stdout.write(f'SNR {snr or math.inf:5.0f}  {way:36} {rms(values):.1e}\n')
