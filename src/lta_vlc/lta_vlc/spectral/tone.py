# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
Frequency and amplitude of a tone between the bins of a spectrum.

A tone obeys x[n] - 2 cos(w) x[n-1] + x[n-2] = 0. Transformed over a block of N samples, with
w_k = 2 pi k / N, that leaves at every bin, whatever the phase,

.. math::
    2 X_k (\cos w_k - \cos w) = B_0 e^{i w_k} + B_1

with real B_0 and B_1 for the two ends of the block. Three bins give six real equations for the
three unknowns: a linear least-squares fit, exact for a lone tone anywhere between the bins, its
mirror image at -w included. Taking B_0 and B_1 out by projection leaves a quotient of two sums,
and sums over diodes give the one frequency that they all hear, each with its own weight.

At a known frequency the amplitude follows from the same three bins by least squares, with the
spectra of a cosine and a sine of that frequency as columns.

Chosen by measured error (`python -m vlc.test_tone` in test/unit prints this table): root mean
square over tones anywhere within a bin, in bins and in parts of the amplitude. Noise allows no
less than 0.044 bins and 0.080 at SNR 10.

=====================================  =================  =================
way                                    no noise           SNR 10
=====================================  =================  =================
frequency: this fit                    1.3e-6             0.053
frequency: Candan's of three bins      1.9e-4             0.066
frequency: Hann window, Grandke's      1.0e-5             0.083
amplitude: this fit                    1.0e-6             0.085
amplitude: highest bin                 0.17               0.18
=====================================  =================  =================

A Hann window would keep a strong lamp between bins out of a weak one's, for more noise; here the
leak of every known tone, harmonics included, is taken off instead: what a lamp of ten times the
light leaves falls from 4 % of the weaker one's amplitude to 0.3 %.
"""

import math
from typing import NamedTuple

from lta_config.compilation.compiler import compile_kernel
import numpy as np
from numpy.typing import NDArray

# Harmonics that are taken off; those above leak less than a thousandth of the first
LEAKING_HARMONICS = 9
FARTHEST_TONE = 1.0  # bins from the highest bin to where the tone can be


class Tones(NamedTuple):
    """Frequency and amplitude of each tone."""

    frequency: NDArray[np.float64]  # common to all diodes, shape (b,) [bins]
    own: NDArray[np.float64]  # of each diode alone, shape (b, d) [bins]
    # At the common frequency, in the unit of the spectrum, shape (b, d)
    amplitude: NDArray[np.float64]


@compile_kernel
def dirichlet_kernel(offset: float, samples: int) -> complex:
    """Return a bin's value for a complex tone of amplitude 1, offset from it [bins]."""
    # sin(N h) / (N sin h), with the phase of the block's middle
    half = offset * (math.pi / samples)
    below = samples * math.sin(half)
    size = 1.0 if below == 0.0 else math.sin(samples * half) / below
    angle = (samples - 1) * half
    return complex(size * math.cos(angle), size * math.sin(angle))


@compile_kernel
def _estimate_frequencies(
    around: NDArray[np.complex128],
    centre: int,
    weight: NDArray[np.float64],
    samples: int,
    own: NDArray[np.float64],
) -> float:
    """Write each diode's frequency of one tone, and return the common one [bins]."""
    turn = 2.0 * math.pi / samples
    cosine, sine, off = np.zeros(3), np.zeros(3), np.zeros(3)
    for j in range(3):
        cosine[j], sine[j] = math.cos(turn * (centre - 1 + j)), math.sin(turn * (centre - 1 + j))
        # cos w_k relative to the middle bin, to keep digits
        off[j] = cosine[j] - math.cos(turn * centre)
    # B_1 is in the real parts alone, and B_0 beyond it, orthogonal: both are projected out.
    mean = (cosine[0] + cosine[1] + cosine[2]) / 3.0
    length = 0.0
    for j in range(3):
        cosine[j] -= mean
        length += cosine[j] ** 2 + sine[j] ** 2
    above, below = 0.0, 0.0
    for diode in range(around.shape[1]):
        # Components along B_1 (mean of the real parts) and B_0
        ends = start = 0.0
        for j in range(3):
            x, y = around[j, diode].real, around[j, diode].imag
            ends += x / 3.0
            start += (x * cosine[j] + y * sine[j]) / length
        top, bottom = 0.0, 0.0
        for j in range(3):
            x, y = around[j, diode].real, around[j, diode].imag
            free = (x - ends - start * cosine[j]) * x + (y - start * sine[j]) * y
            top += free * off[j]
            bottom += free
        own[diode] = _solve_frequency(top, bottom, centre, samples)
        above += weight[diode] * top
        below += weight[diode] * bottom
    return _solve_frequency(above, below, centre, samples)


@compile_kernel
def _solve_frequency(above: float, below: float, centre: int, samples: int) -> float:
    """Return the frequency whose cosine differs from that of a bin by a quotient [bins]."""
    if not below > 0.0 or above == 0.0:
        return float(centre)  # silence, or the tone in the middle of the bin
    turn = 2.0 * math.pi / samples
    cosine = math.cos(turn * centre) + above / below
    frequency = math.acos(min(max(cosine, -1.0), 1.0)) / turn
    return min(max(frequency, centre - FARTHEST_TONE), centre + FARTHEST_TONE)


@compile_kernel
def _estimate_amplitudes(
    around: NDArray[np.complex128],
    centre: int,
    frequency: float,
    samples: int,
    amplitude: NDArray[np.float64],
) -> None:
    """Write each diode's amplitude of a tone of known frequency."""
    cosine, sine = np.zeros(3, np.complex128), np.zeros(3, np.complex128)
    for j in range(3):
        # A real tone has lines at +w and -w
        there = dirichlet_kernel(frequency - (centre - 1 + j), samples)
        mirrored = dirichlet_kernel(-frequency - (centre - 1 + j), samples)
        cosine[j] = there + mirrored
        sine[j] = -1j * (there - mirrored)
    # Normal equations of the two columns, 2 x 2
    a, b, c = 0.0, 0.0, 0.0
    for j in range(3):
        a += (cosine[j] * cosine[j].conjugate()).real
        b += (cosine[j] * sine[j].conjugate()).real
        c += (sine[j] * sine[j].conjugate()).real
    for diode in range(around.shape[1]):
        u, v = 0.0, 0.0
        for j in range(3):
            u += (around[j, diode] * cosine[j].conjugate()).real
            v += (around[j, diode] * sine[j].conjugate()).real
        # Cramer's rule; the determinant is divided out below
        x, y = c * u - b * v, a * v - b * u
        amplitude[diode] = math.hypot(x, y) / (a * c - b * b)


@compile_kernel
def _subtract_tone(
    numbers: NDArray[np.complex128],
    place: float,
    read: NDArray[np.complex128],
    k: int,
    samples: int,
) -> None:
    """Subtract the leakage of a tone from the values of a bin."""
    there, mirrored = dirichlet_kernel(place - k, samples), dirichlet_kernel(-place - k, samples)
    for diode in range(len(read)):
        numbers[diode] -= there * read[diode] + mirrored * read[diode].conjugate()


@compile_kernel
def _divide_by_kernel(numbers: NDArray[np.complex128], place: float, k: int, samples: int) -> None:
    """Convert the values of a bin to the complex amplitude of the tone in it."""
    whole = dirichlet_kernel(place - k, samples)
    for diode in range(len(numbers)):
        numbers[diode] /= whole


@compile_kernel
def _remove_leakage(
    around: NDArray[np.complex128],
    spectrum: NDArray[np.complex128],
    frequency: NDArray[np.float64],
    centres: NDArray[np.int64],
    samples: int,
) -> None:
    """Subtract the leakage of all other tones and of harmonics from the bins around each tone."""
    tones = len(frequency)
    first = np.zeros((tones, spectrum.shape[0]), np.complex128)
    read = np.zeros(spectrum.shape[0], np.complex128)
    for source in range(tones):
        # The complex amplitude of each tone from its nearest bin
        nearest = round(frequency[source])
        for diode in range(len(read)):
            first[source, diode] = spectrum[diode, nearest]
        _divide_by_kernel(first[source], frequency[source], nearest, samples)
    for source in range(tones):
        for target in range(tones):
            if target != source:  # not the tone itself
                for j in range(3):
                    k = centres[target] - 1 + j
                    _subtract_tone(around[target, j], frequency[source], first[source], k, samples)
        for order in range(2, LEAKING_HARMONICS + 1):
            place = order * frequency[source]
            nearest = round(place)
            # Aliased harmonics are left out
            if nearest >= samples // 2:
                break
            for diode in range(len(read)):
                read[diode] = spectrum[diode, nearest]
            for other in range(tones):  # without the leakage of the fundamentals
                _subtract_tone(read, frequency[other], first[other], nearest, samples)
            _divide_by_kernel(read, place, nearest, samples)
            for target in range(tones):
                for j in range(3):
                    _subtract_tone(
                        around[target, j], place, read, centres[target] - 1 + j, samples
                    )


@compile_kernel
def estimate_tones(
    spectrum: NDArray[np.complex128],
    highest: NDArray[np.int64],
    weight: NDArray[np.float64],
    samples: int,
) -> Tones:
    """
    Return frequency and amplitude of tones in known bins.

    Parameters
    ----------
    spectrum : ndarray of complex128, shape (d, n // 2 + 1)
        From `lta_vlc.spectral.spectrum.fourier_transform`.
    highest : ndarray of int, shape (b,)
        Bin of each tone.
    weight : ndarray, shape (d,)
        1 for each diode that decides on the frequency, else 0.
    samples : int
        Samples in the block.

    """
    tones, diodes = len(highest), spectrum.shape[0]
    centres = np.zeros(tones, np.int64)
    around = np.zeros((tones, 3, diodes), np.complex128)
    for tone in range(tones):
        # Neither bin 0 (the mean) nor the last one, its own mirror image, contains a usable tone.
        centres[tone] = min(max(highest[tone], 2), samples // 2 - 1)
        for j in range(3):
            for diode in range(diodes):
                around[tone, j, diode] = spectrum[diode, centres[tone] - 1 + j]
    # Twice: a first frequency to remove the leakage, a second one without it
    frequency, own = np.zeros(tones), np.zeros((tones, diodes))
    amplitude = np.zeros((tones, diodes))
    for tone in range(tones):
        frequency[tone] = _estimate_frequencies(
            around[tone], centres[tone], weight, samples, own[tone]
        )
    _remove_leakage(around, spectrum, frequency, centres, samples)
    for tone in range(tones):
        frequency[tone] = _estimate_frequencies(
            around[tone], centres[tone], weight, samples, own[tone]
        )
        _estimate_amplitudes(
            around[tone], centres[tone], frequency[tone], samples, amplitude[tone]
        )
    return Tones(frequency, own, amplitude)
