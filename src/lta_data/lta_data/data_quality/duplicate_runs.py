# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Detect one run in two recordings, even if it was cropped, shifted or rounded.

Two flights of one manoeuvre move alike, but their noise differs. Of each channel, only the signs
of its second differences are compared, which are those of noise and which no offset or rounding
changes much: at the offset of a copy they agree, at any other half of them do.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_data.data_quality import limits, roles
from lta_data.data_quality.recording import QualityFinding, Severity
from lta_data.even_grid import median_period, sort_samples
from lta_data.flight import Flight
import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate, correlation_lags

KIND = 'twin'
NOISY_QUANTITIES: Final = ('position', 'attitude', 'rates', 'turning', 'force', 'velocity')
SAME_RATE: Final = 0.01  # largest difference of the periods of a copy
LIVELY_SHARE: Final = 0.2  # least share of signs that change, as those of noise do


@final
class NoiseSigns(NamedTuple):
    """The signs of the second differences of a topic's channels."""

    period: float  # of the messages [s]
    rows: dict[str, NDArray[np.float64]]  # by channel, -1, 0 or 1, shape (n,)


def find_duplicate_runs(
    recordings: Sequence[tuple[str, Flight]],
) -> dict[str, list[QualityFinding]]:
    """
    Compare all pairs of recordings, given with their display names.

    Returns
    -------
    dict of str to list of QualityFinding
        By the name of the later recording of each pair.

    """
    signs = [
        (name, extract_signs(recording), simulation_seed(recording))
        for name, recording in recordings
    ]
    findings: dict[str, list[QualityFinding]] = {}
    for index, (name, mine, seed) in enumerate(signs):
        # Each pair once: the later recording is reported as the duplicate
        for other, theirs, its in signs[:index]:
            # Simulated flights with different seeds are separate runs by definition
            if seed and its and seed != its:
                continue
            twins = [
                twin
                for topic in sorted(mine.keys() & theirs.keys())
                if (twin := compare_signs(topic, theirs[topic], mine[topic], other)) is not None
            ]
            if twins:
                best = max(twins, key=lambda twin: twin.values['agreement'])
                findings.setdefault(name, []).append(best)
    return findings


def simulation_seed(recording: Flight) -> str:
    """
    Return the seed of a simulated flight; '' for any other.

    Simulated flights of one plan in still air differ only in noise, but are separate runs.
    """
    return recording.provenance.get('seed', '') if recording.is_simulated else ''


def extract_signs(recording: Flight) -> dict[str, NoiseSigns]:
    """Return the signs of the noise of each topic."""
    topics: dict[str, NoiseSigns] = {}
    for channel in recording.channels.values():
        if roles.match_noisy_quantity(channel) not in NOISY_QUANTITIES:
            continue
        time, table = sort_samples(channel.time, channel.values[:, None]).select_complete()
        if len(time) < limits.LEAST_SAMPLES:
            continue
        row = np.sign(np.diff(table[:, 0], 2))
        if np.mean(row[1:] != row[:-1]) > LIVELY_SHARE:
            topic = topics.setdefault(channel.topic, NoiseSigns(median_period(time), {}))
            topic.rows[channel.name] = row
    return topics


def compare_signs(
    topic: str, first: NoiseSigns, second: NoiseSigns, name: str
) -> QualityFinding | None:
    """Return a finding if a topic of two recordings has the same noise, otherwise None."""
    shared = sorted(first.rows.keys() & second.rows.keys())
    if not shared or abs(first.period / second.period - 1.0) > SAME_RATE:
        return None
    score, offset, count = find_best_alignment(
        [first.rows[one] for one in shared], [second.rows[one] for one in shared],
        round(limits.TWIN_TIME / first.period),
    )  # fmt: skip
    if score < limits.TWIN_AGREE:
        return None
    begin, late, length = (rows * first.period for rows in (max(0, -offset), offset, count))
    return QualityFinding(
        KIND, topic, begin, begin + length,
        f"This is the same run as '{name}' from {max(0.0, late):.1f} s on, for {length:.1f} s: "
        f'the noise of {len(shared)} channels agrees by {100 * score:.0f} %.',
        Severity.SUSPICIOUS, {'agreement': score, 'offset_s': late, 'length_s': length},
    )  # fmt: skip


def find_best_alignment(
    first: list[NDArray[np.float64]], second: list[NDArray[np.float64]], least: int
) -> tuple[float, int, int]:
    """
    Return the best agreement of signs, -1 to 1, with its offset and overlap in rows.

    -1 if it is not clearly more than what other offsets have by chance: the signs of filtered
    readings change slowly, so that few of them are independent.
    """
    # Rows of one topic are equally long unless some of their values are unknown
    counts = [max(map(len, rows)) for rows in (first, second)]
    padded = [
        [np.pad(row, (0, count - len(row))) for row in rows]
        for rows, count in zip((first, second), counts, strict=True)
    ]
    total = np.sum(
        [correlate(one, two, method='fft') for one, two in zip(*padded, strict=True)], axis=0
    )
    lags = correlation_lags(counts[0], counts[1])
    overlap = np.minimum(counts[0], counts[1] + lags) - np.maximum(0, lags)
    shares = total / (len(first) * np.maximum(overlap, 1))
    inside = overlap >= least
    # A mean of chances scatters by the root of its length
    sizes = shares * np.sqrt(np.maximum(overlap, 1))
    best = int(np.argmax(np.where(inside, shares, -1.0)))
    is_clear = inside[best] and sizes[best] > limits.TWIN_CLEAR * float(np.std(sizes[inside]))
    return float(shares[best]) if is_clear else -1.0, int(lags[best]), int(overlap[best])
