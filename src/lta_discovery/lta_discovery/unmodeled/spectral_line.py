"""
Detect spectral lines of the residuals, from something that rotates, swings or flaps.

The latent wrench cannot follow oscillations faster than half a wave per knot interval; they remain
in the residual. A line exceeds the running median of its neighbours. Whole-flight spectra reveal
weak steady frequencies; averaged spectra of the pieces reveal drifting ones. All flights have to
show the same frequency. A line is reported only if the force or moment that causes it is relevant.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.flights.measured_flight import CHANNELS, PERIOD
from lta_discovery.flights.windows import LENGTH
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, median_filter
from scipy.special import gammainccinv, gammaincinv

Array = NDArray[np.float64]

MEDIANS: Final = 5.0  # times the median of the neighbours, over the pieces of all flights
EACH: Final = 3.0  # the same, for each flight
CHANCE: Final = 1e-4  # false-alarm probability over all frequencies of a channel
NEIGHBOURS: Final = 2.5  # Hz; width of the median for averaged pieces
BESIDE: Final = 1.0  # Hz; width of the median for a whole flight, with its many bins
BEYOND: Final = 1.05  # times the highest frequency of the knots; lowest one of a line
KNOWN: Final = 0.9  # of the readings of a piece have to be known
NEAR: Final = 1  # bins; largest difference of the frequency between flights
WORTH: Final = 1.0  # noise floors; smallest RMS of the causing wrench
SURE: Final = 0.01  # false-alarm probability in a single further flight
HALF: Final = np.log(2.0)  # median of the power of white noise, by its mean
SPREAD: Final = 1.3  # margin for correlated bins and for the noise of the level
STEPS: Final = 2  # oversampling of the bins of a whole flight
UNITS: Final = ('m',) * 3 + ('rad',) * 3 + ('rad/s',) * 3 + ('m/s2',) * 3
TURNS: Final = (1, 2)  # the rotational ones of these four kinds of channel
ORDERS: Final = (2, 2, 1, 0)  # order of the derivative that gives an acceleration
LOOKED_AT: Final = CHANNELS[: len(UNITS)]  # range and pressure also show floor and weather


@final
class SpectralLine(NamedTuple):
    """A spectral line of the residuals."""

    channel: str  # of LOOKED_AT
    hertz: float  # frequency [Hz]
    amplitude: float  # of the reading, in the unit of the channel
    medians: float  # power by that of its neighbours, in the flight where it is weakest

    def equivalent_wrench(self, inverse: Array) -> tuple[int, float]:
        """
        Return axis and RMS of the wrench that would cause the line. [N, N m]

        `inverse`, shape (6, 6): of the mass matrix, including added mass.
        """
        # Channels come in kinds of three axes
        kind, way = divmod(LOOKED_AT.index(self.channel), 3)
        axis = way + 3 * (kind in TURNS)
        # Differentiating a wave multiplies its amplitude by the angular frequency
        rate = (2.0 * np.pi * self.hertz) ** ORDERS[kind]
        return axis, float(np.sqrt(0.5) * self.amplitude * rate / inverse[axis, axis])

    @property
    def unit(self) -> str:
        """Of the amplitude."""
        return UNITS[LOOKED_AT.index(self.channel)]


@final
class LeveledSpectrum(NamedTuple):
    """Power spectrum of one series, with its level."""

    # Frequencies, and squared amplitude of a wave of each, shape (B,)
    hertz: Array
    power: Array
    level: Array  # running median of the power, shape (B,)
    pieces: int

    @property
    def power_ratio(self) -> Array:
        """Power by the level, shape (B,)."""
        ratio: Array = self.power / np.maximum(self.level, 1e-300)
        return ratio


def select_strong_lines(
    lines: Sequence[SpectralLine], inverse: Array, floor: Array
) -> tuple[SpectralLine, ...]:
    """Return the lines with a relevant causing wrench."""
    out = []
    for line in lines:
        axis, size = line.equivalent_wrench(inverse)
        if size > WORTH * floor[axis]:
            out.append(line)
    return tuple(out)


def lowest_frequency(knots: int) -> float:
    """Return the frequency above which the latent wrench cannot follow. [Hz]"""
    return BEYOND * 0.5 * (knots - 1) / LENGTH


def level_spectrum(
    hertz: Array, power: Array, pieces: int, wide: float, least: float
) -> LeveledSpectrum:
    """Return the spectrum above a lowest frequency, with its level."""
    use = hertz >= least
    # An odd window, so that the median is centred
    size = max(3, round(wide / (hertz[1] - hertz[0]))) | 1
    # Power below the lowest frequency may differ: use the larger of both levels.
    below = median_filter(power, size, mode='reflect')[use]
    above = median_filter(power[use], size, mode='reflect')
    return LeveledSpectrum(hertz[use], power[use], np.maximum(below, above), pieces)


def _detrend_pieces(pieces: Array) -> Array:
    """Remove a quadratic trend from pieces; 0 where nothing was measured."""
    good = np.isfinite(pieces)
    filled = np.where(good, pieces, 0.0)
    # Quadratic, linear and constant term over a piece
    ramp = np.vander(np.linspace(-1.0, 1.0, pieces.shape[1]), 3)
    inner = np.einsum('sn,na,nb->sab', good, ramp, ramp) + 1e-9 * np.eye(3)
    slow = np.linalg.solve(inner, (filled @ ramp)[..., None])[..., 0] @ ramp.T
    flat: Array = np.where(good, filled - slow, 0.0)
    return flat


def piece_spectrum(pieces: Array, least: float) -> LeveledSpectrum:
    """
    Return the mean spectrum of one channel's residual pieces.

    `pieces`, shape (S, n): every PERIOD; NaN where nothing was measured. Pieces with many gaps are
    left out.
    """
    detrended = _detrend_pieces(pieces[np.isfinite(pieces).mean(axis=1) >= KNOWN])
    count, size = detrended.shape
    window = np.hanning(size + 2)[1:-1]
    # Scaled to the amplitude of a sine
    waves = np.abs(np.fft.rfft(detrended * window, axis=1)) * 2.0 / window.sum()
    hertz = np.asarray(np.fft.rfftfreq(size, PERIOD), dtype=np.float64)
    power = np.mean(waves**2, axis=0) if count else np.zeros(len(hertz))
    return level_spectrum(hertz, power, count, NEIGHBOURS, least)


def flight_spectrum(pieces: Array, time: Array, size: int, least: float) -> LeveledSpectrum:
    """
    Return the spectrum of one channel's residuals over a whole flight.

    `pieces`, shape (S, n): NaN where nothing was measured. `size`: length of the transform in
    periods: that of the longest flight, so that all have equal bins.
    """
    place = np.rint((time - time.min()) / PERIOD).astype(int)
    finite = np.isfinite(pieces)
    # Zero padding gives STEPS bins per resolved frequency
    series = np.zeros(STEPS * size)
    series[place[finite]] = _detrend_pieces(pieces)[finite]
    waves = np.abs(np.fft.rfft(series)) * 2.0 / max(int(finite.sum()), 1)
    hertz = np.asarray(np.fft.rfftfreq(len(series), PERIOD), dtype=np.float64)
    return level_spectrum(hertz, waves**2, 1, BESIDE, least)


def _find_drifting_line(spectra: Sequence[LeveledSpectrum]) -> int | None:
    """Return the bin of a line in the averaged spectra of all flights, if any."""
    counts = np.array([one.pieces for one in spectra])
    if counts.min() < 2:
        return None
    # Normalize each flight by its own level, because their noise differs.
    near = np.array([maximum_filter(one.power_ratio, 2 * NEAR + 1) for one in spectra])
    together = counts @ near / counts.sum()
    count = int(counts.sum())
    # A mean of spectra of white noise is gamma distributed; compare its quantile with its median.
    high, middle = gammaincinv(count, [1.0 - CHANCE / near.shape[1], 0.5])
    limit = max(MEDIANS, SPREAD * float(high / middle))
    good = (together > limit) & (near > EACH).all(axis=0)
    return _highest_bin(spectra, np.where(good, together, 0.0))


def find_steady_line(spectra: Sequence[LeveledSpectrum]) -> int | None:
    """Return the bin of a line in the whole-flight spectra of all flights, if any."""
    near = np.array(
        [HALF * maximum_filter(one.power_ratio, 2 * NEAR * STEPS + 1) for one in spectra]
    )
    looked = 2 * NEAR + 1
    # Corrected for the tried bins, and for the free bin of each further flight
    chance = CHANCE / (near.shape[1] * float(looked) ** (len(spectra) - 1))
    # A sum of exponential powers, one per flight, is gamma distributed
    limit = SPREAD * float(gammainccinv(len(spectra), chance))
    each = SPREAD * float(np.log(looked / SURE))
    good = (near.sum(axis=0) > limit) & (near > each).all(axis=0)
    return _highest_bin(spectra, np.where(good, near.sum(axis=0), 0.0))


def _highest_bin(spectra: Sequence[LeveledSpectrum], strength: Array) -> int | None:
    """Return the bin that is highest in all spectra; None if there is no line."""
    if not strength.any():
        return None
    product = np.prod([one.power_ratio for one in spectra], axis=0)
    return int(np.argmax(np.where(strength >= 0.999 * strength.max(), product, 0.0)))


def find_spectral_lines(
    residuals: Sequence[Array], times: Sequence[Array], noise: Sequence[Array], least: float
) -> list[SpectralLine]:
    """
    Return the lines that all flights show, at most one per channel, the strongest first.

    `residuals`, shape (S, n, 14): of each flight, by the noise.
    """
    out = []
    size = max(round((each.max() - each.min()) / PERIOD) + 1 for each in times)
    for k, channel in enumerate(LOOKED_AT):
        if not all(np.isfinite(level[k]) for level in noise):
            continue
        series = [each[:, :, k] for each in residuals]
        long = [
            flight_spectrum(one, time, size, least)
            for one, time in zip(series, times, strict=True)
        ]
        short = [piece_spectrum(one, least) for one in series]
        for seen, at in ((long, find_steady_line(long)), (short, _find_drifting_line(short))):
            if at is not None:
                out.append(_measure_line(channel, seen, at, [level[k] for level in noise]))
                break
    return sorted(out, key=lambda line: -line.medians)


def _measure_line(
    channel: str, spectra: Sequence[LeveledSpectrum], at: int, noise: Sequence[float]
) -> SpectralLine:
    """Return a line at a bin of some spectra."""
    beside = slice(max(at - NEAR, 0), at + NEAR + 1)
    sizes = [
        float(np.sqrt(one.power[beside].max())) * level
        for one, level in zip(spectra, noise, strict=True)
    ]
    least = min(float(one.power_ratio[beside].max()) for one in spectra)
    return SpectralLine(channel, float(spectra[0].hertz[at]), float(np.mean(sizes)), least)
