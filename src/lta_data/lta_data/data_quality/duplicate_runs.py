"""
Detect one run in two recordings, even if it was cropped, rounded, shifted or resampled.

Two flights may share slow motion, but fast motion (gusts, corrections, noise) is unique. So the
high-pass part of all shared instrument channels is correlated with that of the other recording at
each offset. One run correlates almost fully at some offset; two runs never do.
"""

from collections.abc import Sequence
from typing import Final

from lta_data.data_quality import roles
from lta_data.data_quality.finding import QualityFinding, Severity
from lta_data.data_quality.limits import QualityLimits
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

Array = NDArray[np.float64]
KIND = 'twin'
STEP = 0.01  # of the common grid [s]
COARSE = 0.08  # largest usable period of a channel [s]
FINE = 0.25  # smoothing, which makes the result robust to resampling [s]
TREND = 2.0  # slower changes are removed as trend [s]
SHARE = 0.3  # least part of a recording's energy in the overlap
ABSURD: Final = 1e12  # in any unit; larger readings are invalid
KINDS: Final = ('position', 'rates', 'turning', 'force', 'velocity')


def find_duplicate_runs(
    recordings: Sequence[tuple[str, ChannelRecording]], limits: QualityLimits | None = None
) -> dict[str, list[QualityFinding]]:
    """
    Compare all pairs of recordings, given with their display names.

    Returns
    -------
    dict of str to list of QualityFinding
        By the name of the later recording of each pair.

    """
    known = [
        (name, extract_fingerprints(recording), simulation_seed(recording))
        for name, recording in recordings
    ]
    found: dict[str, list[QualityFinding]] = {}
    for index, (name, mine, seed) in enumerate(known):
        # Each pair once: the later recording is reported as the duplicate
        for other, theirs, its in known[:index]:
            # Simulated flights with different seeds are separate runs by definition.
            if seed and its and seed != its:
                continue
            twin = compare_fingerprints(theirs, mine, other, limits or QualityLimits())
            if twin is not None:
                found.setdefault(name, []).append(twin)
    return found


def simulation_seed(recording: ChannelRecording) -> str:
    """
    Return the seed of a simulated flight; '' for any other.

    Simulated flights of one plan in still air differ only in noise, but are separate runs.
    """
    return recording.provenance.get('seed', '') if recording.is_simulated else ''


def extract_fingerprints(recording: ChannelRecording) -> dict[str, Array]:
    """Return the high-pass part of each channel on a grid over the common span."""
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
    if len(grid) * STEP < 3.0 * TREND:
        return {}
    table = np.stack([interpolate_on_grid(*part, grid)[0][:, 0] for part in some.values()], axis=1)
    calm = smooth_columns(table, hann_kernel(FINE, STEP))
    # Near the ends the trend depends on where the recording was cut.
    end = round(TREND / STEP / 2) + 1
    quick = (calm - smooth_columns(calm, hann_kernel(TREND, STEP)))[end:-end].T
    return {n: row for n, row in zip(some, quick, strict=True) if float(np.std(row)) > 0.0}


def _mask_absurd(values: Array) -> Array:
    """Return readings with NaN for those so large that all others would vanish."""
    return np.where(np.abs(values) < ABSURD, values, np.nan)


def compare_fingerprints(
    first: dict[str, Array],
    second: dict[str, Array],
    name: str,
    limits: QualityLimits,
) -> QualityFinding | None:
    """Return a finding if two recordings contain the same run, otherwise None."""
    shared = sorted(first.keys() & second.keys())
    least = round(limits.twin_time / STEP)
    if not shared or any(min(len(first[c]), len(second[c])) < least for c in shared):
        return None
    score, offset, count = find_best_alignment(
        [first[c] for c in shared], [second[c] for c in shared], least
    )
    if score < limits.twin_agree:
        return None
    begin = max(0.0, -offset * STEP)
    topics = ', '.join(dict.fromkeys(c.rpartition('/')[0] for c in shared))
    return QualityFinding(
        KIND, topics, begin, begin + count * STEP,
        f"This is the same run as '{name}' from {max(0.0, offset * STEP):.1f} s on, for "
        f'{count * STEP:.1f} s: the fast motion in {len(shared)} channels has a '
        f'correlation of {100 * score:.1f} %.',
        Severity.SUSPICIOUS,
        {'agreement': score, 'offset_s': offset * STEP, 'length_s': count * STEP},
    )  # fmt: skip


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
