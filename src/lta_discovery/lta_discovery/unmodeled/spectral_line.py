"""
Lines in the spectrum of what is left over: something that turns, swings or flaps.

A latent force cannot follow a forcing faster than half a wave from knot to knot, so no deviation
rises; but in the spectrum of the residual it stands over its neighbours, whose running median is
the level. It is looked for in two ways. Over a whole flight a steady frequency adds up however
weak it is; one that drifts adds up within the pieces, whose spectra are averaged. Either way all
flights have to show it, at one frequency. Whole flights show waves that move nothing; a line is
told where the force or moment that shakes the vehicle so is worth speaking of.
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

MEDIANS: Final = 5.0  # over its neighbours, of the pieces of all flights
EACH: Final = 3.0  # the same, of those of each flight
CHANCE: Final = 1e-4  # that noise has a line, of all frequencies of a channel
NEIGHBOURS: Final = 2.5  # Hz, of the mean of pieces
BESIDE: Final = 1.0  # Hz, of a whole flight, whose bins are many
BEYOND: Final = 1.05  # times the highest frequency that the knots follow; the lowest of a line
KNOWN: Final = 0.9  # of the readings of a piece
NEAR: Final = 1  # bins; by which the frequency may differ between flights
WORTH: Final = 1.0  # floors; root mean square of the wrench that a line takes
SURE: Final = 0.01  # chance that noise shows in one flight what another one has
HALF: Final = np.log(2.0)  # median of the power of noise, by its mean
SPREAD: Final = 1.3  # windows make neighbours alike, levels are drawn as well
STEPS: Final = 2  # of a bin of a whole flight
UNITS: Final = ('m',) * 3 + ('rad',) * 3 + ('rad/s',) * 3 + ('m/s2',) * 3
TURNS: Final = (1, 2)  # of these four kinds of channel
ORDERS: Final = (2, 2, 1, 0)  # of the derivative of each that is an acceleration
LOOKED_AT: Final = CHANNELS[: len(UNITS)]  # range and pressure tell of floor and weather as well


@final
class SpectralLine(NamedTuple):
    """
    A line in what is left over.

    Attributes
    ----------
    channel : str
        Of LOOKED_AT.
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

    def equivalent_wrench(self, inverse: Array) -> tuple[int, float]:
        """
        Return what shakes a vehicle so: on which axis, and its root mean square. [N, N m]

        Parameters
        ----------
        inverse : ndarray, shape (6, 6)
            Of the matrix of masses and inertias, with those of the air.

        """
        kind, way = divmod(LOOKED_AT.index(self.channel), 3)
        axis = way + 3 * (kind in TURNS)
        rate = (2.0 * np.pi * self.hertz) ** ORDERS[kind]
        return axis, float(np.sqrt(0.5) * self.amplitude * rate / inverse[axis, axis])

    @property
    def unit(self) -> str:
        """Of the amplitude."""
        return UNITS[LOOKED_AT.index(self.channel)]


@final
class LeveledSpectrum(NamedTuple):
    """
    Power of one series, of a whole flight or the mean of its pieces.

    Attributes
    ----------
    hertz, power : ndarray, shape (B,)
        Frequencies, and squared amplitude of a wave of each.
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
    def power_ratio(self) -> Array:
        """Power by the level, shape (B,)."""
        ratio: Array = self.power / np.maximum(self.level, 1e-300)
        return ratio


def select_strong_lines(
    lines: Sequence[SpectralLine], inverse: Array, floor: Array
) -> tuple[SpectralLine, ...]:
    """
    Return the lines of which the wrench is worth speaking of.

    Parameters
    ----------
    seen : sequence of Line
        By `find_lines`.
    inverse : ndarray, shape (6, 6)
        As for `SpectralLine.equivalent_wrench`.
    floor : ndarray, shape (6,)
        Deviations of the latent wrench that are not worth speaking of.

    """
    out = []
    for line in lines:
        axis, size = line.equivalent_wrench(inverse)
        if size > WORTH * floor[axis]:
            out.append(line)
    return tuple(out)


def lowest_frequency(knots: int) -> float:
    """Return the frequency above which a latent wrench with so many knots is blind. [Hz]"""
    return BEYOND * 0.5 * (knots - 1) / LENGTH


def level_spectrum(
    hertz: Array, power: Array, pieces: int, wide: float, least: float
) -> LeveledSpectrum:
    """Return the frequencies from the least on, with their level."""
    use = hertz >= least
    size = max(3, round(wide / (hertz[1] - hertz[0]))) | 1
    # Below the lowest there may be more, of noise with a colour, or less, where knots have it.
    below = median_filter(power, size, mode='reflect')[use]
    above = median_filter(power[use], size, mode='reflect')
    return LeveledSpectrum(hertz[use], power[use], np.maximum(below, above), pieces)


def _detrend_pieces(pieces: Array) -> Array:
    """Return pieces without their slow part, 0 where nothing was measured."""
    good = np.isfinite(pieces)
    kept = np.where(good, pieces, 0.0)
    ramp = np.vander(np.linspace(-1.0, 1.0, pieces.shape[1]), 3)
    inner = np.einsum('sn,na,nb->sab', good, ramp, ramp) + 1e-9 * np.eye(3)
    slow = np.linalg.solve(inner, (kept @ ramp)[..., None])[..., 0] @ ramp.T
    flat: Array = np.where(good, kept - slow, 0.0)
    return flat


def piece_spectrum(pieces: Array, least: float) -> LeveledSpectrum:
    """
    Return the mean spectrum of the pieces of what is left over of one channel.

    Parameters
    ----------
    pieces : ndarray, shape (S, n)
        Every PERIOD; NaN where nothing was measured. Pieces with many gaps are left out.
    least : float
        Lowest frequency. [Hz]

    """
    kept = _detrend_pieces(pieces[np.isfinite(pieces).mean(axis=1) >= KNOWN])
    count, size = kept.shape
    window = np.hanning(size + 2)[1:-1]
    waves = np.abs(np.fft.rfft(kept * window, axis=1)) * 2.0 / window.sum()
    hertz = np.asarray(np.fft.rfftfreq(size, PERIOD), dtype=np.float64)
    power = np.mean(waves**2, axis=0) if count else np.zeros(len(hertz))
    return level_spectrum(hertz, power, count, NEIGHBOURS, least)


def flight_spectrum(pieces: Array, time: Array, size: int, least: float) -> LeveledSpectrum:
    """
    Return the spectrum of what is left over of one channel in a whole flight.

    Parameters
    ----------
    pieces : ndarray, shape (S, n)
        NaN where nothing was measured.
    time : ndarray, shape (S, n)
        Of the readings. [s]
    size : int
        Of the transform, in periods: that of the longest flight, so that all have the same bins.
    least : float
        Lowest frequency. [Hz]

    """
    place = np.rint((time - time.min()) / PERIOD).astype(int)
    known = np.isfinite(pieces)
    series = np.zeros(STEPS * size)
    series[place[known]] = _detrend_pieces(pieces)[known]
    waves = np.abs(np.fft.rfft(series)) * 2.0 / max(int(known.sum()), 1)
    hertz = np.asarray(np.fft.rfftfreq(len(series), PERIOD), dtype=np.float64)
    return level_spectrum(hertz, waves**2, 1, BESIDE, least)


def _find_drifting_line(spectra: Sequence[LeveledSpectrum]) -> int | None:
    """Return the bin of a line in the mean spectra of the pieces of all flights, if any."""
    counts = np.array([one.pieces for one in spectra])
    if counts.min() < 2:
        return None
    # Each flight by its own level: their noise differs.
    near = np.array([maximum_filter(one.power_ratio, 2 * NEAR + 1) for one in spectra])
    together = counts @ near / counts.sum()
    count = int(counts.sum())
    high, middle = gammaincinv(count, [1.0 - CHANCE / near.shape[1], 0.5])
    limit = max(MEDIANS, SPREAD * float(high / middle))
    good = (together > limit) & (near > EACH).all(axis=0)
    return _highest_bin(spectra, np.where(good, together, 0.0))


def find_steady_line(spectra: Sequence[LeveledSpectrum]) -> int | None:
    """Return the bin of a line in the spectra of all flights as a whole, if any."""
    near = np.array(
        [HALF * maximum_filter(one.power_ratio, 2 * NEAR * STEPS + 1) for one in spectra]
    )
    looked = 2 * NEAR + 1
    chance = CHANCE / (near.shape[1] * float(looked) ** (len(spectra) - 1))
    limit = SPREAD * float(gammainccinv(len(spectra), chance))
    each = SPREAD * float(np.log(looked / SURE))
    good = (near.sum(axis=0) > limit) & (near > each).all(axis=0)
    return _highest_bin(spectra, np.where(good, near.sum(axis=0), 0.0))


def _highest_bin(spectra: Sequence[LeveledSpectrum], strength: Array) -> int | None:
    """Return the bin that stands highest in all spectra; None where none does."""
    if not strength.any():
        return None
    product = np.prod([one.power_ratio for one in spectra], axis=0)
    return int(np.argmax(np.where(strength >= 0.999 * strength.max(), product, 0.0)))


def find_lines(
    residuals: Sequence[Array], times: Sequence[Array], noise: Sequence[Array], least: float
) -> list[SpectralLine]:
    """
    Return the lines that all flights show, at most one a channel, the strongest first.

    Parameters
    ----------
    residuals : sequence of ndarray, shape (S, n, 14)
        Of each flight, by the noise.
    times : sequence of ndarray, shape (S, n)
        Of the readings. [s]
    noise : sequence of ndarray, shape (14,)
        Of each flight.
    least : float
        Lowest frequency: what the knots do not follow, by `lowest_frequency`. [Hz]

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
