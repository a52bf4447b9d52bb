"""When two channels part: from where on their difference stays outside what noise explains."""

from dataclasses import dataclass
import math
from typing import Final, final

from lta_data.compare.measures import standard_deviation
from lta_data.compare.sampling import AlignedSignals, Array
import numpy as np

SIGMAS: Final = 4.0  # of both noises together; 6 of 100 000 samples of a normal one lie outside
FLOOR: Final = 1e-3  # of the spread: what nobody would call a difference
NORMAL: Final = 1.4826  # standard deviation of a normal distribution by its median deviation
LEVELS: Final = 6  # different values that tell steps of a measurement from those of a command
SECOND: Final = math.sqrt(6.0)  # white noise of 1 has second differences of that
SHORTEST: Final = 1.0  # s that a departure lasts, or 2 % of the span
SHARE: Final = 0.02
FEWEST: Final = 10  # samples that a departure lasts


@final
@dataclass(frozen=True, slots=True)
class Divergence:
    """
    When two channels are apart.

    Attributes
    ----------
    band : float
        Differences up to here are within the noise, or within the tolerance. [unit]
    given : bool
        Whether the band is a tolerance set by hand.
    at : float or None
        From here to the end they are apart; None where they are together at the end. [s]
    first : float or None
        When they are first apart for longer than a moment, perhaps to meet again. [s]
    outside : float
        Share of the instants outside the band.

    """

    band: float
    given: bool
    at: float | None
    first: float | None
    outside: float


def noise_deviation(values: Array) -> float:
    """
    Return the standard deviation of the noise on a signal that is smooth otherwise.

    White noise as `white_noise_deviation` finds it; where there is none, and the values keep to
    many steps as
    those of an ADC do, the smallest step over sqrt(12). Few steps are commands, which have none.
    Noise that was filtered away before recording is not seen.

    Parameters
    ----------
    values : ndarray, shape (n,)
        In the order of time; NaN is left out.

    """
    found = white_noise_deviation(values)
    levels = np.unique(values[np.isfinite(values)]) if found == 0.0 else np.empty(0)
    return float(np.diff(levels).min()) / math.sqrt(12.0) if len(levels) >= LEVELS else found


def white_noise_deviation(values: Array) -> float:
    """
    Return the standard deviation of the white noise on a signal.

    From the median size of second differences, which a straight line does not touch and a few
    outliers do not move.
    """
    seconds = np.diff(values, 2)
    seconds = seconds[np.isfinite(seconds)]
    if not len(seconds):
        return 0.0
    return NORMAL * float(np.median(np.abs(seconds - np.median(seconds)))) / SECOND


def noise_band(pair: AlignedSignals, *, angular: bool = False, doubt: float = 0.0) -> float:
    """
    Return the difference that the noise of two channels explains.

    Parameters
    ----------
    pair : Aligned
        The channels.
    angular : bool
        Whether values 2 pi apart mean the same.
    doubt : float
        Standard deviation of the offset between their clocks; what moves fast may differ by as
        much as it moves in that time. [s]

    """
    a, b = (np.unwrap(part) if angular else part for part in prepare_pair(pair, angular))
    both = math.hypot(noise_deviation(a), noise_deviation(b))
    known = pair.both_valid
    spread = max(standard_deviation(part[known], angular) for part in (pair.a, pair.b))
    late = 0.0
    if doubt > 0.0 and known.sum() > 2:
        step = np.diff(pair.time[known])
        rate = np.diff(np.unwrap(pair.a[known]) if angular else pair.a[known]) / step
        late = doubt * math.sqrt(float(np.mean(rate**2)))
    return max(SIGMAS * math.hypot(both, late), FLOOR * spread)


def prepare_pair(pair: AlignedSignals, angular: bool) -> tuple[Array, Array]:
    """Return both; of angles only what is known, since one NaN would spoil all that follows."""
    return (pair.a[pair.both_valid], pair.b[pair.both_valid]) if angular else (pair.a, pair.b)


def find_divergence(pair: AlignedSignals, band: float, *, by_hand: bool = False) -> Divergence:
    """
    Return when two channels part.

    They are apart at an instant when their difference is outside the band then, and for most of a
    window that begins there: 1 s, ten samples or 2 % of the span, whichever is longest. They have
    parted at the first such instant after which no window says otherwise.

    Parameters
    ----------
    pair : Aligned
        The two channels.
    band : float
        Half its width. [unit]
    given : bool
        Whether it was set by hand.

    """
    known = pair.both_valid
    time = pair.time[known]
    if len(time) < 2:
        return Divergence(band, by_hand, None, None, 0.0)
    outside = np.abs(pair.difference[known]) > band
    share = float(outside.mean())
    if not outside.any():
        return Divergence(band, by_hand, None, None, 0.0)
    step = float(np.median(np.diff(time)))
    window = max(SHORTEST, FEWEST * step, SHARE * float(time[-1] - time[0]))
    ends = np.searchsorted(time, time + window, side='right')
    total = np.concatenate([[0], np.cumsum(outside)])
    here = np.arange(len(time))
    most = (total[ends] - total[here]) * 2 >= ends - here
    whole = time + window <= time[-1] + 0.5 * step
    if not whole.any():  # shorter than one window
        whole[0] = True
    apart = outside & most & whole
    first = float(time[apart.argmax()]) if apart.any() else None
    together = np.flatnonzero(whole & ~most)
    later = apart & (here > (together[-1] if len(together) else -1))
    at = float(time[later.argmax()]) if later.any() else None
    return Divergence(band, by_hand, at, first, share)
