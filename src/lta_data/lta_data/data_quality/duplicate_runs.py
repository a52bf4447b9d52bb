"""
Detect one run in two recordings, even if it was cropped, shifted, rounded or resampled.

Two flights of one manoeuvre move alike: two free decays correlate almost fully. Their noise
differs, and is the same in a copy. So each channel is limited to frequencies above the motion and
gets a flat spectrum, in which every frequency counts equally. It is correlated with that of the
other recording at each offset. Filtered and rounded recordings have no noise left; there, a
copy also has the motion of the other within half a per cent, which no vehicle repeats.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_data.data_quality import limits, roles
from lta_data.data_quality.finding import QualityFinding, Severity
from lta_data.data_quality.recording import ChannelRecording
from lta_data.data_quality.smoothing import (
    hann_kernel,
    interpolate_on_grid,
    median_period,
    smooth_columns,
    sort_samples,
)
from lta_data.even_grid import build_uniform_time_grid
import numpy as np
from numpy.typing import NDArray
from scipy.signal.windows import tukey

Array = NDArray[np.float64]
KIND = 'twin'
STEP = 0.01  # of the common grid [s]
COARSE = 0.08  # largest usable period of a channel [s]
FINE = 0.25  # smoothing of the motion, which makes it robust to resampling [s]
TREND = 2.0  # slower changes are removed from the motion as trend [s]
ALIKE: Final = 0.98  # correlation of the motion; from here on, its size is compared too
SAME: Final = 0.005  # largest difference of a copy, of the motion in the median channel
QUICK: Final = 0.5  # slower changes are removed from the noise as trend [s]
TIMES: Final = 3  # passes of this filter: after one, smooth motion is still there
OUTLIER: Final = 4.0  # standard deviations; a jump, as of an angle at 180 degrees, is clipped
BAND: Final = (2.5, 12.0)  # frequencies of noise, which resampling leaves [Hz]
SHARE_OF_RATE: Final = 0.4  # of the sampling rate, the highest frequency in use
SMOOTHED: Final = 1.0  # width over which a spectrum is smoothed before it is made flat [Hz]
SHARE = 0.3  # least part of a recording's energy in the overlap
ABSURD: Final = 1e12  # in any unit; larger readings are invalid
FADE: Final = 2.0  # at each end [s]
LEAST: Final = 6.0  # shorter recordings are not compared [s]
KINDS: Final = ('position', 'rates', 'turning', 'force', 'velocity')


@final
class ChannelPrint(NamedTuple):
    """The changes of a channel on the grid, which identify a run."""

    motion: Array  # without trend and noise, shape (n,)
    noise: Array  # with a flat spectrum, shape (m,)
    highest: float  # frequency of the noise [Hz]

    def limit(self, highest: float) -> Array:
        """Return the noise up to a frequency, which a copy at a lower rate has. [Hz]"""
        if highest >= self.highest:
            return self.noise
        spectrum = np.fft.rfft(self.noise)
        spectrum[np.fft.rfftfreq(len(self.noise), STEP) > highest] = 0.0
        return np.fft.irfft(spectrum, len(self.noise))


Fingerprint = Mapping[str, ChannelPrint]


def find_duplicate_runs(
    recordings: Sequence[tuple[str, ChannelRecording]],
) -> dict[str, list[QualityFinding]]:
    """
    Compare all pairs of recordings, given with their display names.

    Returns
    -------
    dict of str to list of QualityFinding
        By the name of the later recording of each pair.

    """
    fingerprints = [
        (name, extract_fingerprints(recording), simulation_seed(recording))
        for name, recording in recordings
    ]
    findings: dict[str, list[QualityFinding]] = {}
    for index, (name, mine, seed) in enumerate(fingerprints):
        # Each pair once: the later recording is reported as the duplicate
        for other, theirs, its in fingerprints[:index]:
            # Simulated flights with different seeds are separate runs by definition.
            if seed and its and seed != its:
                continue
            twin = compare_fingerprints(theirs, mine, other)
            if twin is not None:
                findings.setdefault(name, []).append(twin)
    return findings


def simulation_seed(recording: ChannelRecording) -> str:
    """
    Return the seed of a simulated flight; '' for any other.

    Simulated flights of one plan in still air differ only in noise, but are separate runs.
    """
    return recording.provenance.get('seed', '') if recording.is_simulated else ''


def extract_fingerprints(recording: ChannelRecording) -> Fingerprint:
    """Return the changes of each channel on a grid over the common span."""
    some = {
        channel.name: sort_samples(channel.time, _mask_absurd(channel.values)[:, None])
        for channel in recording.channels.values()
        if roles.match_noisy_quantity(channel) in KINDS
    }
    some = {
        n: part
        for n, part in some.items()
        if len(part[0]) > 100 and median_period(part[0]) < COARSE
    }
    if not some:
        return {}
    begin = max(float(time[0]) for time, _ in some.values())
    last = min(float(time[-1]) for time, _ in some.values())
    grid = build_uniform_time_grid(begin, last, STEP, sum(len(time) for time, _ in some.values()))
    if len(grid) * STEP < LEAST:
        return {}
    table = np.stack([interpolate_on_grid(*part, grid)[0][:, 0] for part in some.values()], axis=1)
    motion = _remove_trend(smooth_columns(table, hann_kernel(FINE, STEP)), TREND)
    quick = table
    for _ in range(TIMES):
        quick = _remove_trend(quick, QUICK)
    prints: dict[str, ChannelPrint] = {}
    for k, (name, part) in enumerate(some.items()):
        highest = min(BAND[1], SHARE_OF_RATE / median_period(part[0]))
        noise = flatten_spectrum(quick[:, k], highest)
        if float(np.std(noise)) > 0.0:
            prints[name] = ChannelPrint(motion[:, k], noise, highest)
    return prints


def _remove_trend(table: Array, width: float) -> Array:
    """Return the faster changes, without the ends, where the trend depends on the cut."""
    end = round(width / STEP / 2) + 1
    return (table - smooth_columns(table, hann_kernel(width, STEP)))[end:-end]


def flatten_spectrum(row: Array, highest: float) -> Array:
    """Return a row with equal power at all frequencies of BAND up to `highest` [Hz]."""
    # Faded in and out, since a jump from the end to the beginning has all frequencies
    spectrum = np.fft.rfft(row * tukey(len(row), min(1.0, 2.0 * FADE / (STEP * len(row)))))
    frequencies = np.fft.rfftfreq(len(row), STEP)
    power = np.abs(spectrum) ** 2
    half = max(1, round(SMOOTHED / frequencies[1] / 2))
    wide = np.pad(power, half, mode='edge')
    smooth = np.convolve(wide, np.ones(2 * half + 1) / (2 * half + 1), mode='valid')
    inside = (frequencies > BAND[0]) & (frequencies < highest) & (smooth > 0.0)
    flat = np.where(inside, spectrum / np.sqrt(np.where(inside, smooth, 1.0)), 0.0)
    noise = np.fft.irfft(flat, len(row))
    most = OUTLIER * 1.4826 * float(np.median(np.abs(noise)))
    return np.clip(noise, -most, most)


def _mask_absurd(values: Array) -> Array:
    """Return readings with NaN for those so large that all others would vanish."""
    return np.where(np.abs(values) < ABSURD, values, np.nan)


def compare_fingerprints(
    first: Fingerprint, second: Fingerprint, name: str
) -> QualityFinding | None:
    """Return a finding if two recordings contain the same run, otherwise None."""
    shared = sorted(first.keys() & second.keys())
    least = round(limits.TWIN_TIME / STEP)
    if not shared or any(len(one[c].noise) < least for one in (first, second) for c in shared):
        return None
    highest = {c: min(first[c].highest, second[c].highest) for c in shared}
    rows = [[one[c].limit(highest[c]) for c in shared] for one in (first, second)]
    score, offset, count = find_best_alignment(rows[0], rows[1], least)
    what = 'noise'
    if score < limits.TWIN_AGREE:
        if any(len(one[c].motion) < least for one in (first, second) for c in shared):
            return None
        rows = [[one[c].motion for c in shared] for one in (first, second)]
        score, offset, count = find_best_alignment(rows[0], rows[1], least)
        if score < ALIKE or measure_difference(rows[0], rows[1], offset, count) > SAME:
            return None
        what = 'motion, in size too,'
    begin = max(0.0, -offset * STEP)
    topics = ', '.join(dict.fromkeys(c.rpartition('/')[0] for c in shared))
    return QualityFinding(
        KIND, topics, begin, begin + count * STEP,
        f"This is the same run as '{name}' from {max(0.0, offset * STEP):.1f} s on, for "
        f'{count * STEP:.1f} s: the {what} of {len(shared)} channels agrees by '
        f'{100 * score:.0f} %.',
        Severity.SUSPICIOUS,
        {'agreement': score, 'offset_s': offset * STEP, 'length_s': count * STEP},
    )  # fmt: skip


def measure_difference(first: list[Array], second: list[Array], offset: int, count: int) -> float:
    """Return the median difference of channels, of their size, at an offset of the grid."""
    one, two = (
        np.stack([row[begin : begin + count] for row in rows])
        for rows, begin in ((first, max(0, offset)), (second, max(0, -offset)))
    )
    size = np.sqrt((one**2).mean(axis=1, keepdims=True))
    one, two = one / size, two / size
    # The offset is a fraction of a step off
    slope = np.gradient(one, axis=1)
    off = two - one
    off = off - slope * (slope * off).sum() / (slope**2).sum()
    return float(np.median(np.sqrt((off**2).mean(axis=1))))


def find_best_alignment(
    first: list[Array], second: list[Array], least: int
) -> tuple[float, int, int]:
    """
    Return the best agreement with its offset and overlap in grid steps.

    The agreement at an offset is the correlation of all channels over the overlap, each channel
    scaled to unit variance.
    """
    most = max(len(x) for x in first), max(len(x) for x in second)
    # Padded beyond the sum of lengths, so that the circular correlation does not wrap around
    size = 1 << int(sum(most)).bit_length()
    products = np.zeros(size)
    total_first = total_second = 0.0
    energy_first, energy_second = np.zeros(size), np.zeros(size)
    for one, two in zip(first, second, strict=True):
        # Each channel counts equally, whatever its unit.
        scale = float(np.std(one)) * float(np.std(two))
        left, right = np.fft.rfft(one, size), np.conj(np.fft.rfft(two, size))
        # Correlating squares with ones gives the energy within the overlap, for all lags at once
        there, here = np.fft.rfft(np.ones(len(one)), size), np.fft.rfft(np.ones(len(two)), size)
        ones, twos = np.fft.rfft(one**2, size), np.conj(np.fft.rfft(two**2, size))
        products += np.fft.irfft(left * right, size) / scale
        energy_first += np.fft.irfft(ones * np.conj(here), size) / scale
        energy_second += np.fft.irfft(there * twos, size) / scale
        total_first += float((one**2).sum()) / scale
        total_second += float((two**2).sum()) / scale
    lags = np.arange(size)
    # FFT order: the upper half are negative lags.
    lags = np.where(lags < size // 2, lags, lags - size)
    # Samples in common at each lag
    overlap = np.minimum(most[0], most[1] + lags) - np.maximum(0, lags)
    both = np.sqrt(np.maximum(energy_first * energy_second, 1e-12))
    # A stretch with hardly any motion correlates by chance.
    lasting = overlap >= least
    eventful = (energy_first > SHARE * total_first) | (energy_second > SHARE * total_second)
    # Normalised cross-correlation, -1..1
    agreement = np.where(lasting & eventful, products / both, -1.0)
    best = int(np.argmax(agreement))
    return float(agreement[best]), int(lags[best]), int(overlap[best])
