"""Find when two channels diverge: from when on their difference exceeds the noise band."""

from dataclasses import dataclass
import math
from typing import Final, final

from lta_data.compare.measures import standard_deviation
from lta_data.compare.sampling import AlignedSignals, Array
import numpy as np

SIGMAS: Final = 4.0  # of the combined noise; 6 of 100 000 normal samples lie outside
FLOOR: Final = 1e-3  # of the spread; smaller differences are irrelevant
NORMAL: Final = 1.4826  # standard deviation over median absolute deviation
LEVELS: Final = 6  # least distinct values of a quantised measurement; fewer: a command
SECOND: Final = math.sqrt(6.0)  # standard deviation of second differences of unit white noise
SHORTEST: Final = 1.0  # s that a divergence must last, or 2 % of the span
SHARE: Final = 0.02
FEWEST: Final = 10  # samples that a divergence must last


@final
@dataclass(frozen=True, slots=True)
class Divergence:
    """When two channels differ."""

    band: float  # largest difference explained by noise, or the tolerance [unit]
    given: bool  # whether the band is a tolerance set by the user
    at: float | None  # time from which they differ to the end; None if they agree at the end [s]
    first: float | None  # time when they first differ for longer than a moment [s]
    outside: float  # share of the samples outside the band


def noise_deviation(values: Array) -> float:
    """
    Return the standard deviation of the noise on an otherwise smooth signal.

    Without white noise, a signal with many distinct levels, such as an ADC's, has quantisation
    noise: the smallest step over sqrt(12). Few levels mean a command, which has no noise. Noise
    that was filtered out before recording is not detected. NaN values are ignored.
    """
    deviation = white_noise_deviation(values)
    # Only a signal without white noise can be limited by quantisation.
    # A median of zero: most neighbours are equal, as after rounding
    levels = np.unique(values[np.isfinite(values)]) if deviation == 0.0 else np.empty(0)
    # Standard deviation of rounding to steps: step / sqrt(12)
    return float(np.diff(levels).min()) / math.sqrt(12.0) if len(levels) >= LEVELS else deviation


def white_noise_deviation(values: Array) -> float:
    """
    Return the standard deviation of the white noise on a signal.

    It comes from the median magnitude of second differences, which ignores linear trends and
    single outliers.
    """
    # Second differences remove level and slope, leaving the noise
    seconds = np.diff(values, 2)
    seconds = seconds[np.isfinite(seconds)]
    if not len(seconds):
        return 0.0
    return NORMAL * float(np.median(np.abs(seconds - np.median(seconds)))) / SECOND


def noise_band(pair: AlignedSignals, *, angular: bool = False, doubt: float = 0.0) -> float:
    """
    Return the difference that the noise of two channels explains. [unit of the channels]

    `doubt` is the standard deviation of the clock offset [s]; it widens the band by the change of
    the signal in that time.
    """
    a, b = (
        np.unwrap(part) if angular else part for part in select_comparable_values(pair, angular)
    )
    both = math.hypot(noise_deviation(a), noise_deviation(b))
    valid = pair.both_valid
    spread = max(standard_deviation(part[valid], angular) for part in (pair.a, pair.b))
    late = 0.0
    if doubt > 0.0 and valid.sum() > 2:
        step = np.diff(pair.time[valid])
        rate = np.diff(np.unwrap(pair.a[valid]) if angular else pair.a[valid]) / step
        # A clock error shifts the signal by rate times error.
        late = doubt * math.sqrt(float(np.mean(rate**2)))
    return max(SIGMAS * math.hypot(both, late), FLOOR * spread)


def select_comparable_values(pair: AlignedSignals, angular: bool) -> tuple[Array, Array]:
    """Return both value arrays; for angles without NaN, because NaN breaks unwrapping."""
    return (pair.a[pair.both_valid], pair.b[pair.both_valid]) if angular else (pair.a, pair.b)


def find_divergence(pair: AlignedSignals, band: float, *, by_hand: bool = False) -> Divergence:
    """
    Find when two channels diverge.

    They differ at a time if the difference exceeds the band then and for most of a window that
    begins there: 1 s, ten samples or 2 % of the span, whichever is longest. They diverge at the
    first such time that no window in agreement follows. `band` is half the width. [unit]
    """
    valid = pair.both_valid
    time = pair.time[valid]
    if len(time) < 2:
        return Divergence(band, by_hand, None, None, 0.0)
    outside = np.abs(pair.difference[valid]) > band
    share = float(outside.mean())
    if not outside.any():
        return Divergence(band, by_hand, None, None, 0.0)
    step = float(np.median(np.diff(time)))
    window = max(SHORTEST, FEWEST * step, SHARE * float(time[-1] - time[0]))
    ends = np.searchsorted(time, time + window, side='right')
    # Cumulative count, so that each window needs one subtraction
    total = np.concatenate([[0], np.cumsum(outside)])
    here = np.arange(len(time))
    # More than half of the window must be outside the band.
    most = (total[ends] - total[here]) * 2 >= ends - here
    # Windows cut off by the end of the recording do not count; half a step covers rounding.
    whole = time + window <= time[-1] + 0.5 * step
    if not whole.any():  # shorter than one window
        whole[0] = True
    apart = outside & most & whole
    first = float(time[apart.argmax()]) if apart.any() else None
    # The last window in agreement; the divergence starts after it.
    together = np.flatnonzero(whole & ~most)
    later = apart & (here > (together[-1] if len(together) else -1))
    at = float(time[later.argmax()]) if later.any() else None
    return Divergence(band, by_hand, at, first, share)
