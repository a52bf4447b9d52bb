"""
Detect a stretch of data that occurs twice in a recording.

Two stretches of an instrument's noise are never equal bit for bit. The comparison is in single
precision, so that a conversion of type does not hide a copy.
"""

from collections.abc import Iterator

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits, roles
from lta_data.data_quality.finding import CheckVerdict, QualityFinding, Severity
from lta_data.data_quality.recording import CheckContext
from lta_data.data_quality.smoothing import find_coarse_unit
import numpy as np
from numpy.typing import NDArray

KIND = 'duplicate'
ULPS = 256  # least range of a stretch, in steps of single precision


def find_duplication(evidence: CheckContext) -> CheckVerdict:
    """Find repeated stretches in noisy channels."""
    findings = [
        finding
        for channel in evidence.recording.channels.values()
        if roles.match_noisy_quantity(channel)
        for finding in find_repeats(channel)
    ]
    return CheckVerdict(tuple(findings))


def hash_windows(values: NDArray[np.float64], length: int) -> NDArray[np.uint64]:
    """Return a hash of each window of `length` readings, by single-precision bits."""
    # Plus one, or zeros would not contribute to the hash
    bits = values.astype(np.float32).view(np.uint32).astype(np.uint64) + np.uint64(1)
    # Random odd weights: a multilinear hash modulo 2^64.
    factor = np.random.default_rng(0).integers(1, 2**62, length, dtype=np.uint64) * np.uint64(2)
    total = np.zeros(len(values) - length + 1, dtype=np.uint64)
    # Overflow is the modulo 2^64
    with np.errstate(over='ignore'):
        for index, weight in enumerate(factor + np.uint64(1)):
            total += bits[index : index + len(total)] * weight
    return total


def find_repeats(channel: SignalChannel) -> Iterator[QualityFinding]:
    """Yield the repeated stretches of one channel."""
    values, length = channel.values, limits.DUPLICATED_SAMPLES
    if len(values) < 2 * length or find_coarse_unit(values):
        return
    finite = np.isfinite(values)
    single = np.where(finite, values, 0.0).astype(np.float32)
    changing = np.diff(single) != 0.0
    # Number of changes within each window; constant windows are equal without duplication
    lively = np.convolve(changing, np.ones(length - 1), mode='valid') >= limits.DUPLICATED_LEVELS
    windows = np.lib.stride_tricks.sliding_window_view(single, length)
    # A slow channel has few distinct values in single precision and repeats by chance.
    fine = np.ptp(windows, axis=1) > ULPS * np.spacing(np.abs(windows).max(axis=1))
    lively &= fine & np.lib.stride_tricks.sliding_window_view(finite, length).all(axis=1)
    hashes = hash_windows(values, length)
    # Equal windows are adjacent after sorting by hash, the earlier one first
    order = np.argsort(hashes, kind='stable')
    same = (hashes[order][1:] == hashes[order][:-1]) & lively[order][1:]
    first, again = order[:-1][same], order[1:][same]
    apart = again - first
    rising = np.argsort(again)
    first, again, apart = first[rising], again[rising], apart[rising]
    # Consecutive windows with one distance form one stretch.
    breaks = np.flatnonzero((np.diff(again) != 1) | (np.diff(apart) != 0)) + 1
    for part in np.split(np.arange(len(again)), breaks):
        # A shorter distance would be an overlap of the window with itself
        if len(part) and apart[part[0]] >= length:
            yield build_repeat_finding(
                channel, int(first[part[0]]), int(again[part[0]]), len(part) + length - 1
            )


def build_repeat_finding(
    channel: SignalChannel, first: int, again: int, count: int
) -> QualityFinding:
    """Return the finding of a repeated stretch."""
    time = channel.time
    begin, end = float(time[again]), float(time[min(again + count, len(time)) - 1])
    return QualityFinding(
        KIND, channel.name, begin, end,
        f'{count} readings in a row are identical bit for bit to those from {time[first]:.2f} s '
        'on.',
        Severity.SUSPICIOUS, {'from_s': float(time[first]), 'readings': float(count)},
    )  # fmt: skip
