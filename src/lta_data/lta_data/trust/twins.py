"""
The same run in two recordings, whatever was trimmed, rounded, shifted or sampled again.

What two flights have in common is slow; what is quick, gusts, corrections and noise, happens once.
So the quick part of every shared channel of an instrument is laid over the other recording's at
each offset, all channels at one; one run agrees almost wholly somewhere, two runs nowhere.
"""

from collections.abc import Sequence
from typing import Final

from lta_data.even_grid import even_grid
from lta_data.trust import roles
from lta_data.trust.finding import Finding, Severity
from lta_data.trust.limits import Limits
from lta_data.trust.recording import Recording
from lta_data.trust.smooth import in_order, kernel, on_grid, period, smoothed
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
KIND = 'twin'
STEP = 0.01  # of the grid on which recordings are compared [s]
COARSE = 0.08  # a slower channel is no print [s]
FINE = 0.25  # smoothing, so that sampling again changes little [s]
TREND = 2.0  # what is slower says little [s]
SHARE = 0.3  # of what happens in one of the two must be in what they share
ABSURD: Final = 1e12  # in any unit; no instrument reads as much
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
    known = [(name, prints(recording), drawn(recording)) for name, recording in recordings]
    found: dict[str, list[Finding]] = {}
    for index, (name, mine, seed) in enumerate(known):
        for other, theirs, its in known[:index]:
            if seed and its and seed != its:
                continue
            twin = compared(theirs, mine, other, limits or Limits())
            if twin is not None:
                found.setdefault(name, []).append(twin)
    return found


def drawn(recording: Recording) -> str:
    """
    Return the seed of a simulated flight; '' for any other.

    In still air two flights of one plan are alike but for their noise, and yet are two.
    """
    return recording.provenance.get('seed', '') if recording.simulated else ''


def prints(recording: Recording) -> dict[str, Array]:
    """Return the quick part of each channel on the grid, all from one time to one time."""
    some = {
        channel.name: in_order(channel.time, _sane(channel.values)[:, None])
        for channel in recording.channels.values()
        if roles.restless(channel) in KINDS
    }
    some = {n: part for n, part in some.items() if len(part[0]) > 100 and period(part[0]) < COARSE}
    if not some:
        return {}
    begin = max(float(time[0]) for time, _ in some.values())
    last = min(float(time[-1]) for time, _ in some.values())
    grid = even_grid(begin, last, STEP, sum(len(time) for time, _ in some.values()))
    if len(grid) * STEP < 3.0 * TREND:
        return {}
    table = np.stack([on_grid(*part, grid)[0][:, 0] for part in some.values()], axis=1)
    calm = smoothed(table, kernel(FINE, STEP))
    # Near an end the trend is a guess, another one in each recording.
    end = round(TREND / STEP / 2) + 1
    quick = (calm - smoothed(calm, kernel(TREND, STEP)))[end:-end].T
    return {n: row for n, row in zip(some, quick, strict=True) if float(np.std(row)) > 0.0}


def _sane(values: Array) -> Array:
    """Return readings, NaN for those beside which all others would vanish."""
    return np.where(np.abs(values) < ABSURD, values, np.nan)


def compared(
    first: dict[str, Array],
    second: dict[str, Array],
    name: str,
    limits: Limits,
) -> Finding | None:
    """Return what two recordings share; None where they are two runs."""
    shared = sorted(first.keys() & second.keys())
    least = round(limits.twin_time / STEP)
    if not shared or any(min(len(first[c]), len(second[c])) < least for c in shared):
        return None
    score, offset, count = aligned([first[c] for c in shared], [second[c] for c in shared], least)
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
    total_first = total_second = 0.0
    energy_first, energy_second = np.zeros(size), np.zeros(size)
    for one, two in zip(first, second, strict=True):
        scale = float(np.std(one)) * float(np.std(two))
        left, right = np.fft.rfft(one, size), np.conj(np.fft.rfft(two, size))
        there, here = np.fft.rfft(np.ones(len(one)), size), np.fft.rfft(np.ones(len(two)), size)
        ones, twos = np.fft.rfft(one**2, size), np.conj(np.fft.rfft(two**2, size))
        products += np.fft.irfft(left * right, size) / scale
        energy_first += np.fft.irfft(ones * np.conj(here), size) / scale
        energy_second += np.fft.irfft(there * twos, size) / scale
        total_first += float((one**2).sum()) / scale
        total_second += float((two**2).sum()) / scale
    lags = np.arange(size)
    lags = np.where(lags < size // 2, lags, lags - size)
    overlap = np.minimum(most[0], most[1] + lags) - np.maximum(0, lags)
    both = np.sqrt(np.maximum(energy_first * energy_second, 1e-12))
    # A stretch in which next to nothing happens agrees by chance.
    lasting = overlap >= least
    eventful = (energy_first > SHARE * total_first) | (energy_second > SHARE * total_second)
    agreement = np.where(lasting & eventful, products / both, -1.0)
    best = int(np.argmax(agreement))
    return float(agreement[best]), int(lags[best]), int(overlap[best])
