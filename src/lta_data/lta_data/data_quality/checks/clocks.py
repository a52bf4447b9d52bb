# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Detect clocks that disagree: one motion at two times, or with a drifting lag.

The lag is estimated as that of two flights that are compared (`lta_data.compare.coarse_lag`), here
between a sensor and what the pose implies for it.
"""

from collections.abc import Iterator, Sequence
from typing import Final, final, NamedTuple

from lta_data.compare.coarse_lag import estimate_coarse_lag, LAG_STEPS, SharedQuantity
from lta_data.data_quality import limits
from lta_data.data_quality.motion import MeasuredVector, MOVING_SPREADS, PoseMotion
from lta_data.data_quality.recording import CheckContext, CheckVerdict, QualityFinding, Severity
from lta_data.even_grid import (
    DELIVERED_TOGETHER,
    find_late_messages,
    find_runs,
    hann_kernel,
    is_grid_allowed,
    median_period,
    SampledSignal,
    smooth_columns,
)
from lta_data.flight import Channel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
KIND: Final = 'clock'
AMBIGUOUS: Final = 0.9  # height of a second peak, as of a pure oscillation, over the first
INDEPENDENT: Final = 4.0  # independent values per second after a kernel of 0.25 s
# Trial drifts over the flight [s]
DRIFTS: Final = tuple(size * sign for size in (0.2, 0.35, 0.5, 0.65, 0.8, 1.0) for sign in (1, -1))


def find_clock_errors(evidence: CheckContext) -> CheckVerdict:
    """Find channels that are late or early relative to others."""
    findings: list[QualityFinding] = []
    unjudged: list[str] = []
    for motion in evidence.motions:
        turning = {vector.name.split('/')[0] for vector in motion.list_vectors('rates')}
        for vector in motion.vectors:
            if vector.kind == 'force' and vector.name.split('/')[0] in turning:
                continue  # the rates of this sensor are more precise
            shared = share_axes(motion, vector)
            if not shared:
                unjudged.append(
                    f"The clock of '{vector.name}' cannot be judged: "
                    f"'{motion.name_reference(vector.kind)}' shows too little motion to compare "
                    'it with.'
                )
                continue
            lag = estimate_lag(shared)
            if lag is not None:
                findings += find_lag(motion, vector, lag)
    return CheckVerdict(tuple(findings), tuple(unjudged))


def share_axes(motion: PoseMotion, vector: MeasuredVector) -> list[SharedQuantity]:
    """Return the axes of a vector that move, derived from the pose and measured, of one size."""
    seconds = motion.seconds
    if not is_grid_allowed(float(seconds[-1] - seconds[0]), LAG_STEPS[0], len(seconds)):
        return []  # a clock that was set by hours or years, which `stamps` reports
    weights = hann_kernel(limits.KERNEL, median_period(seconds))
    derived = smooth_columns(motion.derive(vector.kind), weights)
    measured = smooth_columns(vector.values, weights)
    # Derivatives of a pose are often zero in the first and last rows. These would look like a
    # drift of the clock, so they are left out.
    cut = len(weights) if len(seconds) > 4 * len(weights) else 0
    inner = slice(cut, len(seconds) - cut)
    seconds, derived, measured = seconds[inner], derived[inner], measured[inner]
    shared = []
    for axis in range(3):
        sides = [side[:, axis] - np.nanmean(side[:, axis]) for side in (derived, measured)]
        sizes = [float(np.nanstd(side)) for side in sides]
        if sizes[0] > MOVING_SPREADS[vector.kind] and sizes[1] > 0.0:
            one, other = (
                SampledSignal(seconds, side / size)
                for side, size in zip(sides, sizes, strict=True)
            )
            shared.append(SharedQuantity('xyz'[axis], one, other))
    return shared


@final
class DriftingLag(NamedTuple):
    """A lag in the middle of the flight, its standard error and its drift [s]."""

    lag: float
    error: float
    drift: float  # from start to end
    before: float  # correlation as recorded
    after: float  # correlation without lag and drift


def estimate_lag(shared: Sequence[SharedQuantity]) -> DriftingLag | None:
    """Return lag and drift at which a vector correlates best; None if nothing tells them."""
    ways = []
    for drift in (0.0, *DRIFTS):
        moved = [each._replace(b=_move(each, 0.0, drift)) for each in shared]
        coarse = estimate_coarse_lag(moved, limits.CLOCK_SEARCH)
        if coarse is not None and coarse.rival < AMBIGUOUS:
            ways.append((correlate_moved(shared, coarse.lag, drift), coarse.lag, drift))
    if not ways:
        return None
    after, lag, drift = max(ways)
    steady = next((way for way in ways if way[2] == 0.0), (0.0, 0.0, 0.0))
    # A drift must explain clearly more than a lag alone
    if 1.0 - steady[0] < limits.CLOCK_GAIN * (1.0 - after):
        after, lag, drift = steady
    return DriftingLag(lag, _estimate_error(shared, after), drift, correlate_moved(shared), after)


def _estimate_error(shared: Sequence[SharedQuantity], correlation: float) -> float:
    """
    Return the standard error of a lag by the correlation there [s].

    Twice the bound of Knapp and Carter (1976, doi:10.1109/TASSP.1976.1162830), with the number of
    independent values that the kernel leaves in the flight.
    """
    time, table = shared[0].a.time, np.array([each.a.values for each in shared])
    pace = np.nanstd(np.gradient(table, time, axis=1)) / np.nanstd(table)
    unlike = max(1e-4, 1.0 - correlation**2)
    return 2.0 * float(np.sqrt(unlike / max(1.0, np.ptp(time) * INDEPENDENT)) / pace)


def find_lag(
    motion: PoseMotion, vector: MeasuredVector, estimate: DriftingLag
) -> Iterator[QualityFinding]:
    """Yield the lag of a vector, or its drift, if significant."""
    lag, error, drift, before, after = estimate
    small = abs(lag) < limits.LARGEST_CLOCK_OFFSET + limits.CLOCK_SIGMAS * error
    # An improved correlation must clearly reduce the mismatch
    gained = 1.0 - before > limits.CLOCK_GAIN * (1.0 - after)
    if (small and not drift) or after < limits.WANDER_AGREE or not gained:
        return
    gain = f'(correlation {before:.2f} as recorded, {after:.2f} after correction)'
    reference = motion.name_reference(vector.kind)
    if drift:
        text = (
            f"The time stamps drift by about {drift:.1f} s relative to '{reference}' from start "
            f'to end {gain}.'
        )
        values = {'drift': drift, 'error': error}
    else:
        word = 'late' if lag > 0 else 'early'
        text = (
            f'The data are {abs(lag):.3f} s +- {error:.3f} s {word} relative to '
            f"'{reference}' {gain}."
        )
        values = {'lag': lag, 'error': error}
    yield QualityFinding(KIND, vector.name, *motion.span, text, Severity.SUSPICIOUS, values)


def _move(each: SharedQuantity, lag: float, drift: float) -> SampledSignal:
    """Return the measured signal without a lag and a drift over the flight [s]."""
    time, values = each.b
    share = (each.a.time - each.a.time[0]) / np.ptp(each.a.time) - 0.5
    finite = np.isfinite(values)
    moved = np.interp(each.a.time + lag + drift * share, time[finite], values[finite])
    return SampledSignal(each.a.time, moved)


def correlate_moved(
    shared: Sequence[SharedQuantity], lag: float = 0.0, drift: float = 0.0
) -> float:
    """Return the correlation of all axes after removing a lag and a drift over the flight [s]."""
    left = np.concatenate([np.nan_to_num(each.a.values) for each in shared])
    right = np.concatenate([_move(each, lag, drift).values for each in shared])
    return float((left * right).sum() / (np.linalg.norm(left) * np.linalg.norm(right)))


STAMPS: Final = 'stamps'
TWICE: Final = 0.001  # share of repeated stamps from which they are reported
REGULAR: Final = 0.3  # relative standard deviation of a period, at most
LONG: Final = 98.0  # percentile of irregular periods that a gap exceeds
MAX_STAMP_FINDINGS: Final = 5  # findings of one kind per topic, at most


def find_stamp_errors(evidence: CheckContext) -> CheckVerdict:
    """Find errors in the times of each topic."""
    findings: list[QualityFinding] = []
    first: dict[str, Channel] = {}
    for channel in evidence.recording.channels.values():
        # All channels of a topic have the same times, so check one of them
        first.setdefault(channel.topic, channel)
    for topic, channel in first.items():
        if len(channel.time) >= limits.LEAST_SAMPLES:
            findings += find_backward_stamps(topic, channel.time)
            findings += find_gaps(topic, channel.time)
        arrived = evidence.recording.arrivals.get(topic)
        if arrived is not None and len(arrived) == len(channel.time) > 1:
            findings += find_stamp_jumps(topic, channel.time, arrived)
    return CheckVerdict(tuple(findings))


def find_backward_stamps(topic: str, time: Array) -> Iterator[QualityFinding]:
    """Yield where time runs backwards or repeats."""
    late = find_late_messages(time)
    if late.any():
        at = np.flatnonzero(late)
        behind = float((np.maximum.accumulate(time) - time)[late].max())
        yield QualityFinding(
            STAMPS, topic, float(time[at[0]]), float(time[at[-1]]),
            f'{len(at)} of {len(time)} messages were recorded after later ones, by up to '
            f'{behind:.3f} s; their time stamps put them in order.',
            Severity.WARNING, {'late': float(len(at))},
        )  # fmt: skip
    step = np.diff(time[~late])
    time = time[~late]
    back = np.flatnonzero(step < 0.0)
    for index in back[:MAX_STAMP_FINDINGS].tolist():
        begin, end = float(time[index + 1]), float(time[index])
        yield QualityFinding(
            STAMPS, topic, begin, end,
            f'The time stamps go back by {end - begin:.3f} s at {end:.3f} s ({len(back)} such '
            'steps).',
            Severity.ERROR, {'back': end - begin, 'steps': float(len(back))},
        )  # fmt: skip
    twice = np.flatnonzero(step == 0.0)
    if len(twice) > TWICE * len(time):
        yield QualityFinding(
            STAMPS, topic, float(time[twice[0]]), float(time[twice[-1]]),
            f'{len(twice)} of {len(time)} messages repeat the previous time stamp.',
            Severity.SUSPICIOUS, {'messages': float(len(twice))},
        )  # fmt: skip


def find_gaps(topic: str, time: Array) -> Iterator[QualityFinding]:
    """Yield gaps, and the share of lost messages of a regular topic."""
    step = np.diff(time)
    step = step[step > 0.0]
    if len(step) < limits.LEAST_SAMPLES // 2:
        return
    usual = float(np.median(step))
    regular = is_regular(time)
    # On irregular stamps, a gap is longer than nearly all other steps
    longest = usual if regular else float(np.percentile(step, LONG))
    gaps = np.flatnonzero(np.diff(time) > max(limits.GAP_PERIODS * longest, limits.GAP_TIME))
    for index in gaps[:MAX_STAMP_FINDINGS].tolist():
        begin, end = float(time[index]), float(time[index + 1])
        yield QualityFinding(
            STAMPS, topic, begin, end,
            f'No message for {end - begin:.2f} s; the usual period is {usual:.3f} s '
            f'({len(gaps)} such {"gap" if len(gaps) == 1 else "gaps"}).',
            Severity.SUSPICIOUS, {'gap': end - begin, 'gaps': float(len(gaps))},
        )  # fmt: skip
    if not regular:
        return
    # n periods over some messages lack the rest; one that is late lacks none. Gaps are above
    whole = np.diff(time)
    whole[gaps] = usual
    lost = np.round(np.diff(np.cumsum(whole)[::DELIVERED_TOGETHER]) / usual) - DELIVERED_TOGETHER
    missing = float(lost[lost > 0.0].sum())
    if missing > limits.DROPOUT_SHARE * (len(time) + missing):
        at = np.flatnonzero(lost > 0.0) * DELIVERED_TOGETHER
        yield QualityFinding(
            STAMPS, topic, float(time[at[0]]), float(time[at[-1] + DELIVERED_TOGETHER]),
            f'{missing:.0f} of {len(time) + missing:.0f} messages are missing in small gaps.',
            Severity.WARNING, {'missing': missing},
        )  # fmt: skip


def is_regular(time: Array) -> bool:
    """Return whether messages follow at a period, so that lost ones can be counted."""
    step = np.diff(time)
    step = step[step > 0.0]
    if not len(step):
        return True
    usual = float(np.median(step))
    together = usual < REGULAR * median_period(time)
    # 1.4826: standard deviation from the median absolute deviation
    return not together and 1.4826 * float(np.median(np.abs(step - usual))) <= REGULAR * usual


def find_stamp_jumps(topic: str, time: Array, arrived: Array) -> Iterator[QualityFinding]:
    """Yield where stamps jump relative to the log times."""
    # A constant offset between both clocks is legitimate; only its changes count
    ahead = (time - time[0]) - (arrived - arrived[0])
    jumped = np.abs(np.diff(ahead)) > limits.LOG_JUMP
    for begin, _ in find_runs(jumped)[:MAX_STAMP_FINDINGS].tolist():
        size = float(ahead[begin + 1] - ahead[begin])
        low, high = sorted((float(time[begin]), float(time[begin + 1])))
        yield QualityFinding(
            STAMPS, topic, low, high,
            f'The time stamps jump by {size:.3f} s relative to the log time.',
            Severity.SUSPICIOUS, {'jump': size},
        )  # fmt: skip
