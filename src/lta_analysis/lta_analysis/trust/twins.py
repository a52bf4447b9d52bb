"""
The same run in two recordings, whatever was trimmed, rounded, shifted or sampled again.

What two flights have in common is slow; what is quick, gusts, corrections and noise, happens once.
So the quick part of every shared channel of an instrument is laid over the other recording's at
each offset, all channels at one; one run agrees almost wholly somewhere, two runs nowhere.
"""

from collections.abc import Sequence
from typing import Final

from lta_analysis.bag.channels import Channel
from lta_analysis.trust import roles
from lta_analysis.trust.finding import Finding, Severity
from lta_analysis.trust.limits import Limits
from lta_analysis.trust.recording import Recording
from lta_analysis.trust.smooth import in_order, kernel, on_grid, period, smoothed
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
KIND = 'twin'
STEP = 0.04  # of the grid on which recordings are compared [s]
FINE = 0.25  # smoothing, so that sampling again changes little [s]
TREND = 2.0  # what is slower says little [s]
KINDS: Final = ('position', 'rates', 'turning', 'force', 'velocity')


def twins(
    recordings: Sequence[tuple[str, Recording]], limits: Limits | None = None
) -> dict[str, list[Finding]]:
    """
    Compare all pairs of recordings.

    Parameters
    ----------
    recordings : sequence of (str, Recording)
        With the names that the sentences use.
    limits : Limits, optional
        Thresholds.

    Returns
    -------
    dict of str to list of Finding
        By the name of the later recording of each pair.

    """
    known = [(name, prints(recording)) for name, recording in recordings]
    found: dict[str, list[Finding]] = {}
    for index, (name, mine) in enumerate(known):
        for other, theirs in known[:index]:
            twin = compared(theirs, mine, other, limits or Limits())
            if twin is not None:
                found.setdefault(name, []).append(twin)
    return found


def prints(recording: Recording) -> dict[str, tuple[float, Array]]:
    """Return the quick part of each channel and the time of its first value. [s]"""
    found = {}
    for channel in recording.channels.values():
        if roles.restless(channel) in KINDS:
            quick = of_channel(channel)
            if quick is not None:
                found[channel.name] = float(np.round(channel.time[0] / STEP) * STEP), quick
    return found


def of_channel(channel: Channel) -> Array | None:
    """Return the quick part of a channel on the grid; None where it is too short or still."""
    time, table = in_order(channel.time, channel.values[:, None])
    if len(time) < 100 or period(time) > 2.0 * STEP:
        return None
    grid = np.arange(np.ceil(time[0] / STEP), np.floor(time[-1] / STEP)) * STEP
    if len(grid) * STEP < 3.0 * TREND:
        return None
    # Smoothed before it is sampled anew: noise above the grid's band would fold into it.
    fine = np.arange(time[0], time[-1], period(time))
    calm = smoothed(on_grid(time, table, fine)[0], kernel(FINE, period(time)))
    calm, _ = on_grid(fine, calm, grid)
    quick = (calm - smoothed(calm, kernel(TREND, STEP)))[:, 0]
    return quick if float(np.std(quick)) > 0.0 else None


def compared(
    first: dict[str, tuple[float, Array]],
    second: dict[str, tuple[float, Array]],
    name: str,
    limits: Limits,
) -> Finding | None:
    """Return what two recordings share; None where they are two runs."""
    shared = sorted(first.keys() & second.keys())
    least = round(limits.twin_time / STEP)
    if not shared or any(min(len(first[c][1]), len(second[c][1])) < least for c in shared):
        return None
    score, offset, count = aligned(
        [first[c][1] for c in shared], [second[c][1] for c in shared], least
    )
    if score < limits.twin_agree:
        return None
    begin = max(0.0, -offset * STEP)
    topics = ', '.join(dict.fromkeys(c.rpartition('/')[0] for c in shared))
    return Finding(
        KIND, topics, begin, begin + count * STEP,
        f"The same run as '{name}' from {max(0.0, offset * STEP):.1f} s on, for "
        f'{count * STEP:.1f} s: what is quick in {len(shared)} channels agrees by '
        f'{100 * score:.1f} %.',
        Severity.SUSPICIOUS,
        {'agreement': score, 'offset_s': offset * STEP, 'length_s': count * STEP},
    )  # fmt: skip


def aligned(first: list[Array], second: list[Array], least: int) -> tuple[float, int, int]:
    """
    Return the best agreement, its offset and overlap in grid steps.

    The agreement at an offset is the correlation over the overlap of all channels together, each
    scaled to one.
    """
    most = max(len(x) for x in first), max(len(x) for x in second)
    size = 1 << int(sum(most)).bit_length()
    products = np.zeros(size)
    energy_first, energy_second = np.zeros(size), np.zeros(size)
    for one, two in zip(first, second, strict=True):
        scale = float(np.std(one)) * float(np.std(two))
        left, right = np.fft.rfft(one, size), np.conj(np.fft.rfft(two, size))
        there, here = np.fft.rfft(np.ones(len(one)), size), np.fft.rfft(np.ones(len(two)), size)
        products += np.fft.irfft(left * right, size) / scale
        energy_first += np.fft.irfft(np.fft.rfft(one**2, size) * np.conj(here), size) / np.var(one)
        energy_second += np.fft.irfft(there * np.conj(np.fft.rfft(two**2, size)), size) / np.var(two)
    lags = np.arange(size)
    lags = np.where(lags < size // 2, lags, lags - size)
    overlap = np.minimum(most[0], most[1] + lags) - np.maximum(0, lags)
    both = np.sqrt(np.maximum(energy_first * energy_second, 1e-12))
    # A stretch in which next to nothing happens agrees by chance.
    lasting = overlap >= least
    eventful = energy_first > 0.3 * len(first) * np.maximum(overlap, 1)
    agreement = np.where(lasting & eventful, products / both, -1.0)
    best = int(np.argmax(agreement))
    return float(agreement[best]), int(lags[best]), int(overlap[best])
