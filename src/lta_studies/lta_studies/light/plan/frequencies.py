"""
Frequencies for several lamps, so that no lamp is taken for another, nor for the mains.

All stand in the middle of a bin: a lamp's wave then leaves nothing between its own harmonics. The
law, in bins of the demodulator's block and its search window of w bins on either side:

- the windows of two lamps do not touch: more than 2 w bins apart;
- no multiple of the flicker of the mains lies in a window;
- no harmonic of a lamp, up to an order, lies in the window of another: n f folded at the sampling
  rate, since what lies above Nyquist comes back; only harmonics that a wave of this duty has;
- the windows lie between the lowest frequency and Nyquist.

A harmonic is weaker than its fundamental by its order: the higher the order up to which they
stay clear, the nearer a drone may be to one lamp and still hear a far one. So the highest order
is taken for which there are enough frequencies.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
import math
from typing import Final, final

from lta_config.errors import BadInput
from lta_studies.light.plan.polygon import Array, Mask
from lta_vlc.settings import DemodulationSettings
import numpy as np

LOWEST: Final = 150.0  # Hz, the paper's; slower flicker is seen by people
ORDERS: Final = range(49, 4, -2)  # up to which harmonics stay clear, the best first
FAINT: Final = 1e-9  # a harmonic that a wave does not have, but for rounding
ROUNDING: Final = 1e-6  # of a bin


@final
@dataclass(frozen=True, slots=True)
class FrequencyBand:
    """
    Where frequencies can be.

    Attributes
    ----------
    rate : float
        Samples a second. [Hz]
    samples : int
        In a block.
    window : int
        Bins searched on either side of a lamp's frequency.
    mains : float
        Frequency of the mains' flicker, whose multiples are taken. [Hz]
    duty : float
        Of the lamps: which harmonics there are.

    """

    rate: float
    samples: int
    window: int
    mains: float
    duty: float

    @property
    def bin_width(self) -> float:
        """Of a bin. [Hz]"""
        return self.rate / self.samples

    @property
    def half_window(self) -> float:
        """How far a window reaches to either side, with room for rounding. [Hz]"""
        return (self.window + ROUNDING) * self.bin_width

    def list_harmonics(self, order: int) -> list[int]:
        """Return the harmonics above the first that a wave of this duty has, up to an order."""
        return [n for n in range(2, order + 1) if abs(math.sin(math.pi * n * self.duty)) > FAINT]

    def alias_frequency(self, frequency: Array) -> Array:
        """Return where frequencies show in the spectrum. [Hz]"""
        return np.abs(frequency - self.rate * np.rint(frequency / self.rate))

    def is_usable(self, frequency: Array) -> Mask:
        """Return whether the windows of lamps [Hz] are clear of both ends and of the mains."""
        half = self.half_window
        multiple = np.maximum(np.rint(frequency / self.mains), 1.0)
        off_mains = np.abs(frequency - self.mains * multiple) > half
        low = max(LOWEST, self.bin_width + self.window * self.bin_width)
        ends = (frequency >= low) & (frequency + self.window * self.bin_width <= self.rate / 2)
        return np.asarray(ends & off_mains)

    def is_separable(self, first: float, second: Array, order: int) -> Mask:
        """Return which lamps and one more leave each other's windows alone, up to an order."""
        orders = np.array(self.list_harmonics(order))[:, None]
        near = np.abs(first - second) <= 2.0 * self.half_window
        from_first = np.abs(self.alias_frequency(orders * first) - second) <= self.half_window
        from_second = np.abs(self.alias_frequency(orders * second) - first) <= self.half_window
        return ~(near | from_first.any(axis=0) | from_second.any(axis=0))


def build_band(
    settings: DemodulationSettings, rate: float, samples: int, mains: float, duty: float
) -> FrequencyBand:
    """Return where frequencies can be for a demodulator; in Hz."""
    return FrequencyBand(rate, samples, settings.window, mains, duty)


def find_clear_frequencies(
    band: FrequencyBand, existing: Sequence[float], order: int, most: int
) -> list[float]:
    """Return up to `most` frequencies beside the kept ones, the lowest first. [Hz]"""
    middles: Array = np.arange(1.0, band.samples // 2 + 1) * band.bin_width
    free = band.is_usable(middles)
    for frequency in existing:
        free &= band.is_separable(frequency, middles, order)
    found: list[float] = []
    while free.any() and len(found) < most:
        found.append(float(middles[free.argmax()]))
        free &= band.is_separable(found[-1], middles, order)
    return found


def choose_frequencies(
    band: FrequencyBand, existing: Sequence[float], count: int
) -> tuple[list[float], int]:
    """
    Return frequencies for new lamps, and the order up to which all harmonics stay clear.

    Parameters
    ----------
    band : Band
        Where they can be.
    kept : sequence of float
        Of lamps that keep theirs. [Hz]
    count : int
        How many more are wanted.

    Raises
    ------
    BadInput
        If the kept ones are in each other's way or the mains', or not enough fit beside them.

    """
    _check_existing(band, existing)
    for order in ORDERS:
        if _find_conflict(band, existing, order):
            continue
        found = find_clear_frequencies(band, existing, order, count)
        if len(found) == count:
            return found, order
    fit = len(find_clear_frequencies(band, existing, ORDERS[-1], band.samples))
    raise BadInput(explain_shortage(band, existing, count, fit))


def explain_shortage(band: FrequencyBand, existing: Sequence[float], count: int, fit: int) -> str:
    """Return the sentence that says how few frequencies fit, and why."""
    width = band.bin_width
    half = band.window * width
    beside = f' beside the {len(existing)} that lamps keep' if existing else ''
    return (
        f'{count} lamps want a frequency, but only {fit} fit{beside}: in bins of {width:g} Hz, '
        f'from {LOWEST:g} Hz to {band.rate / 2 - half:g} Hz, more than {2 * half:g} Hz apart, '
        f'more than {half:g} Hz off every multiple of {band.mains:g} Hz (mains) and off each '
        f"other's harmonics up to the {ORDERS[-1]}th; ask for fewer lamps with --lamps, or for a "
        'narrower window with --set demodulator.window=1.'
    )


def _check_existing(band: FrequencyBand, existing: Sequence[float]) -> None:
    """Refuse frequencies of lamps already there that cannot be told apart."""
    for frequency in existing:
        if not band.is_usable(np.array(frequency)):
            raise BadInput(
                f'A lamp that is there already flickers at {frequency:g} Hz, below {LOWEST:g} Hz, '
                f'too near to Nyquist ({band.rate / 2:g} Hz) or within '
                f'{band.window * band.bin_width:g} Hz of a multiple of {band.mains:g} Hz (mains); '
                'give it another frequency.'
            )
    if found := _find_conflict(band, existing, ORDERS[-1]):
        raise BadInput(
            f'Two lamps that are there already flicker at {found[0]:g} and {found[1]:g} Hz, too '
            f"near to each other or to each other's harmonics for a demodulator with bins of "
            f'{band.bin_width:g} Hz and a window of {band.window} bins; give one another '
            f'frequency.'
        )


def _find_conflict(
    band: FrequencyBand, existing: Sequence[float], order: int
) -> tuple[float, float] | None:
    """Return two of the frequencies that are not apart."""
    return next(
        (
            (one, other)
            for one, other in combinations(existing, 2)
            if not band.is_separable(one, np.array([other]), order).all()
        ),
        None,
    )
