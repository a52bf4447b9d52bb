# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Choose frequencies so that lamps are not confused with each other or with the mains.

All frequencies are at the centre of a bin, so that a lamp's wave has no leakage between its
harmonics. Rules, in bins of the demodulator's block with a search window of w bins on either side:

- the windows of two lamps do not touch: they are more than 2 w bins apart;
- no multiple of the mains flicker is in a window;
- no harmonic of a lamp, up to an order, is in the window of another. Harmonics above Nyquist are
  aliased, and only harmonics that exist at this duty cycle count;
- the windows are between the lowest frequency and Nyquist.

A harmonic is weaker than its fundamental by its order. The higher the clear order, the nearer a
drone may be to one lamp and still receive a distant one. The highest order that leaves enough
frequencies is therefore used.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
import math
from typing import Final, final

from lta_config.errors import BadInput
from lta_studies.light.plan.floor import Array, Mask
from lta_vlc.settings import DemodulationSettings
import numpy as np

LOWEST_FLICKER: Final = 150.0  # Hz, from the paper; slower flicker is visible
CLEAR_ORDERS: Final = range(49, 4, -2)  # clear orders of harmonics to try, best first
ZERO_AMPLITUDE: Final = 1e-9  # amplitude below which a harmonic is zero except for rounding
BIN_TOLERANCE: Final = 1e-6  # bins, tolerance


@final
@dataclass(frozen=True, slots=True)
class FrequencyBand:
    """Constraints on the frequencies."""

    rate: float  # sampling rate [Hz]
    samples: int  # samples per block
    window: int  # bins searched on either side of a lamp's frequency
    mains: float  # frequency of the mains flicker; its multiples are excluded [Hz]
    duty: float  # duty cycle of the lamps; determines their harmonics

    @property
    def bin_width(self) -> float:
        """Width of a bin [Hz]."""
        return self.rate / self.samples

    @property
    def half_window(self) -> float:
        """Half width of a search window, including a rounding tolerance [Hz]."""
        return (self.window + BIN_TOLERANCE) * self.bin_width

    def list_harmonics(self, order: int) -> list[int]:
        """Return the existing harmonics from the second up to an order."""
        # Fourier coefficient of a rectangular wave: sin(pi n d) / (pi n)
        return [
            n
            for n in range(2, order + 1)
            if abs(math.sin(math.pi * n * self.duty)) > ZERO_AMPLITUDE
        ]

    def alias_frequency(self, frequency: Array) -> Array:
        """Return the aliased frequencies in the sampled spectrum [Hz]."""
        return np.abs(frequency - self.rate * np.rint(frequency / self.rate))

    def is_usable_frequency(self, frequency: Array) -> Mask:
        """Return whether the windows are within the band and clear of the mains."""
        half = self.half_window
        # The nearest multiple of the mains flicker, not counting 0
        multiple = np.maximum(np.rint(frequency / self.mains), 1.0)
        off_mains = np.abs(frequency - self.mains * multiple) > half
        # The window must not reach bin 0, which holds the steady light.
        low = max(LOWEST_FLICKER, self.bin_width + self.window * self.bin_width)
        ends = (frequency >= low) & (frequency + self.window * self.bin_width <= self.rate / 2)
        return np.asarray(ends & off_mains)

    def is_separable(self, first: float, second: Array, order: int) -> Mask:
        """Return which lamps do not interfere with `first`, with harmonics up to an order."""
        # Shape (harmonics, 1), to compare with all candidates at once
        orders = np.array(self.list_harmonics(order))[:, None]
        near = np.abs(first - second) <= 2.0 * self.half_window
        from_first = np.abs(self.alias_frequency(orders * first) - second) <= self.half_window
        from_second = np.abs(self.alias_frequency(orders * second) - first) <= self.half_window
        return ~(near | from_first.any(axis=0) | from_second.any(axis=0))


def build_band(
    settings: DemodulationSettings, rate: float, samples: int, mains: float, duty: float
) -> FrequencyBand:
    """Build the frequency constraints of a demodulator; in Hz."""
    return FrequencyBand(rate, samples, settings.window, mains, duty)


def find_clear_frequencies(
    band: FrequencyBand, existing: Sequence[float], order: int, most: int
) -> list[float]:
    """Return up to `most` further frequencies, lowest first [Hz]."""
    middles: Array = np.arange(1.0, band.samples // 2 + 1) * band.bin_width
    free = band.is_usable_frequency(middles)
    for frequency in existing:
        free &= band.is_separable(frequency, middles, order)
    frequencies: list[float] = []
    while free.any() and len(frequencies) < most:
        # `argmax` of a mask is its first True: the lowest free frequency.
        frequencies.append(float(middles[free.argmax()]))
        free &= band.is_separable(frequencies[-1], middles, order)
    return frequencies


def choose_frequencies(
    band: FrequencyBand, existing: Sequence[float], count: int
) -> tuple[list[float], int]:
    """
    Choose frequencies for new lamps; also return the order up to which harmonics are clear.

    `band`: constraints. `existing`: frequencies of existing lamps [Hz]. `count`: number of new
    frequencies. Raise `BadInput` if existing frequencies conflict, or not enough new ones fit.
    """
    _check_existing_frequencies(band, existing)
    for order in CLEAR_ORDERS:
        if _find_conflict(band, existing, order):
            continue
        frequencies = find_clear_frequencies(band, existing, order, count)
        if len(frequencies) == count:
            return frequencies, order
    # How many would fit under the weakest rule, for the message
    fit = len(find_clear_frequencies(band, existing, CLEAR_ORDERS[-1], band.samples))
    raise BadInput(explain_shortage(band, existing, count, fit))


def explain_shortage(band: FrequencyBand, existing: Sequence[float], count: int, fit: int) -> str:
    """Return the error message for too few frequencies."""
    width = band.bin_width
    half = band.window * width
    addition = f' besides those of the existing lamps ({len(existing)})' if existing else ''
    return (
        f'{count} lamps need a frequency, but only {fit} are free{addition}. A frequency '
        f'must be the centre of a bin of {width:g} Hz between {LOWEST_FLICKER:g} Hz and '
        f'{band.rate / 2 - half:g} Hz, more than {2 * half:g} Hz from the others, and more '
        f'than {half:g} Hz from every multiple of {band.mains:g} Hz (mains) and from '
        f'harmonics of the others up to the {CLEAR_ORDERS[-1]}th. Use fewer lamps with '
        f'--lamps, or '
        'a narrower window with --set demodulator.window=1.'
    )


def _check_existing_frequencies(band: FrequencyBand, existing: Sequence[float]) -> None:
    """Raise `BadInput` if existing frequencies are unusable or conflict."""
    for frequency in existing:
        if not band.is_usable_frequency(np.array(frequency)):
            raise BadInput(
                f'An existing lamp flickers at {frequency:g} Hz, which cannot be received: '
                f'it is below {LOWEST_FLICKER:g} Hz, too close to the Nyquist frequency of '
                f'{band.rate / 2:g} Hz, or within {band.window * band.bin_width:g} Hz of a '
                f'multiple of {band.mains:g} Hz (mains). Change the frequency of this lamp.'
            )
    if conflict := _find_conflict(band, existing, CLEAR_ORDERS[-1]):
        raise BadInput(
            f'Two existing lamps flicker at {conflict[0]:g} and {conflict[1]:g} Hz. For a '
            f'demodulator with bins of {band.bin_width:g} Hz and a window of {band.window} '
            "bins, these are too close to each other or to each other's harmonics; change "
            'one of the frequencies.'
        )


def _find_conflict(
    band: FrequencyBand, existing: Sequence[float], order: int
) -> tuple[float, float] | None:
    """Return the first pair of conflicting frequencies, or None."""
    return next(
        (
            (one, other)
            for one, other in combinations(existing, 2)
            if not band.is_separable(one, np.array([other]), order).all()
        ),
        None,
    )
