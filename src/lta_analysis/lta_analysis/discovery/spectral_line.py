"""
Lines in the spectrum of what is left over: something that turns, swings or flaps.

A latent force with knots 0.75 s apart cannot follow a forcing of 2 Hz, so no deviation rises; but
in the spectrum of the residual it stands over its neighbours. Pieces are averaged, the level is
the running median of the neighbours, and a line counts only if all flights show it.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_analysis.discovery.measured import CHANNELS, PERIOD
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter
from scipy.special import gammaincinv

Array = NDArray[np.float64]

MEDIANS: Final = 5.0  # over its neighbours
CHANCE: Final = 1e-4  # that noise has a line, of all frequencies of a channel
NEIGHBOURS: Final = 25  # bins; 4 Hz
LOWEST: Final = 0.5  # Hz; below it the knots follow
KNOWN: Final = 0.9  # of the readings of a piece
NEAR: Final = 1.5  # bins; by which the frequency may differ between flights
UNITS: Final = ('m',) * 3 + ('rad',) * 3 + ('rad/s',) * 3 + ('m/s2',) * 3 + ('m', 'Pa')


@final
class Line(NamedTuple):
    """
    A line in what is left over.

    Attributes
    ----------
    channel : str
        Of CHANNELS.
    hertz : float
        Frequency. [Hz]
    amplitude : float
        Of the oscillation of the reading, in the unit of the channel.
    medians : float
        Its power by that of its neighbours, in the flight that shows it least.

    """

    channel: str
    hertz: float
    amplitude: float
    medians: float

    @property
    def unit(self) -> str:
        """Of the amplitude."""
        return UNITS[CHANNELS.index(self.channel)]


@final
class Spectrum(NamedTuple):
    """
    Mean power of the pieces of one series.

    Attributes
    ----------
    hertz, power : ndarray, shape (B,)
        Frequencies, and mean squared amplitude of a wave of each.
    level : ndarray, shape (B,)
        Running median of the power.
    pieces : int
        How many were averaged.

    """

    hertz: Array
    power: Array
    level: Array
    pieces: int

    @property
    def limit(self) -> float:
        """Medians that noise does not reach."""
        bins, count = len(self.hertz), max(self.pieces, 1)
        high, middle = gammaincinv(count, [1.0 - CHANCE / bins, 0.5])
        # A window makes neighbours of a peak alike, and the median is drawn as well.
        return max(MEDIANS, 1.3 * float(high / middle))


def spectrum(pieces: Array) -> Spectrum:
    """
    Return the spectrum of what is left over of one channel.

    Parameters
    ----------
    pieces : ndarray, shape (S, n)
        Every PERIOD; NaN where nothing was measured. Pieces with many gaps are left out.

    """
    good = np.isfinite(pieces).mean(axis=1) >= KNOWN
    kept = np.where(np.isfinite(pieces[good]), pieces[good], 0.0)
    count, size = kept.shape
    window = np.hanning(size + 2)[1:-1]
    ramp = np.vander(np.linspace(-1.0, 1.0, size), 3)
    kept = kept - (ramp @ np.linalg.lstsq(ramp, kept.T, rcond=None)[0]).T
    waves = np.abs(np.fft.rfft(kept * window, axis=1)) * 2.0 / window.sum()
    hertz: Array = np.asarray(np.fft.rfftfreq(size, PERIOD), dtype=np.float64)
    use = hertz >= LOWEST
    power: Array = np.zeros(int(use.sum()))
    if count:
        power = np.mean(waves[:, use] ** 2, axis=0).astype(np.float64)
    return Spectrum(hertz[use], power, median_filter(power, NEIGHBOURS, mode='nearest'), count)


def _peak(seen: Spectrum) -> tuple[int, float]:
    """Return the bin that stands highest, and by how many medians."""
    ratio = seen.power / np.maximum(seen.level, 1e-300)
    k = int(np.argmax(ratio))
    return k, float(ratio[k])


def lines(residuals: Sequence[Array], noise: Sequence[Array]) -> list[Line]:
    """
    Return the lines that all flights show, the strongest first.

    Parameters
    ----------
    residuals : sequence of ndarray, shape (S, n, 14)
        Of each flight, by the noise.
    noise : sequence of ndarray, shape (14,)
        Of each flight.

    """
    out = []
    for k, channel in enumerate(CHANNELS):
        if not all(np.isfinite(level[k]) for level in noise):
            continue
        seen = [spectrum(each[:, :, k]) for each in residuals]
        if any(one.pieces < 2 or not one.level.all() for one in seen):
            continue
        peaks = [_peak(one) for one in seen]
        apart = max(one[0] for one in peaks) - min(one[0] for one in peaks)
        if apart > NEAR or any(
            ratio < one.limit for one, (_, ratio) in zip(seen, peaks, strict=True)
        ):
            continue
        hertz = float(np.mean([one.hertz[at] for one, (at, _) in zip(seen, peaks, strict=True)]))
        sizes = [
            np.sqrt(one.power[at]) * level[k]
            for one, (at, _), level in zip(seen, peaks, noise, strict=True)
        ]
        out.append(Line(channel, hertz, float(np.mean(sizes)), min(r for _, r in peaks)))
    return sorted(out, key=lambda line: -line.medians)
