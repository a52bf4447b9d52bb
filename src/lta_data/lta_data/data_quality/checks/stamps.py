"""Detect stamps that run backwards, repeat or jump, missing messages, and log-time mismatch."""

from collections.abc import Iterator
from typing import Any

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits
from lta_data.data_quality.finding import CheckVerdict, QualityFinding, Severity
from lta_data.data_quality.recording import CheckContext
from lta_data.data_quality.smoothing import find_runs, median_period, TOGETHER
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
KIND = 'stamps'
TWICE = 0.001  # share of repeated stamps from which they are reported
IN_A_ROW = 3  # messages that a network may deliver late together
LATE = 0.05  # share of late messages beyond which the time stamps are wrong
REGULAR = 0.3  # relative standard deviation of a period, at most
LONG = 98.0  # percentile of irregular periods that a gap exceeds
SHOWN = 5  # findings of one kind per topic, at most


def find_stamp_errors(evidence: CheckContext) -> CheckVerdict:
    """Find errors in the times of each topic."""
    findings: list[QualityFinding] = []
    first: dict[str, SignalChannel] = {}
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
            KIND, topic, float(time[at[0]]), float(time[at[-1]]),
            f'{len(at)} of {len(time)} messages were recorded after later ones, by up to '
            f'{behind:.3f} s; their time stamps put them in order.',
            Severity.WARNING, {'late': float(len(at))},
        )  # fmt: skip
    step = np.diff(time[~late])
    time = time[~late]
    back = np.flatnonzero(step < 0.0)
    for index in back[:SHOWN].tolist():
        begin, end = float(time[index + 1]), float(time[index])
        yield QualityFinding(
            KIND, topic, begin, end,
            f'The time stamps go back by {end - begin:.3f} s at {end:.3f} s ({len(back)} such '
            'steps).',
            Severity.ERROR, {'back': end - begin, 'steps': float(len(back))},
        )  # fmt: skip
    twice = np.flatnonzero(step == 0.0)
    if len(twice) > TWICE * len(time):
        yield QualityFinding(
            KIND, topic, float(time[twice[0]]), float(time[twice[-1]]),
            f'{len(twice)} of {len(time)} messages repeat the previous time stamp.',
            Severity.SUSPICIOUS, {'messages': float(len(twice))},
        )  # fmt: skip


def find_late_messages(time: Array) -> Any:  # noqa: ANN401 - an array of bool
    """
    Return which messages arrived after later ones, as on a network without order.

    Where a clock is set back, all messages are behind until it has caught up; here, a few are.
    """
    behind = time < np.maximum.accumulate(time)
    late = np.zeros(len(time), dtype=bool)
    for begin, end in find_runs(behind).tolist():
        late[begin:end] = end - begin <= IN_A_ROW
    return late if late.mean() <= LATE else np.zeros(len(time), dtype=bool)


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
    for index in gaps[:SHOWN].tolist():
        begin, end = float(time[index]), float(time[index + 1])
        yield QualityFinding(
            KIND, topic, begin, end,
            f'No message for {end - begin:.2f} s; the usual period is {usual:.3f} s '
            f'({len(gaps)} such {"gap" if len(gaps) == 1 else "gaps"}).',
            Severity.SUSPICIOUS, {'gap': end - begin, 'gaps': float(len(gaps))},
        )  # fmt: skip
    if not regular:
        return
    # n periods over some messages lack the rest; one that is late lacks none. Gaps are above
    whole = np.diff(time)
    whole[gaps] = usual
    lost = np.round(np.diff(np.cumsum(whole)[::TOGETHER]) / usual) - TOGETHER
    missing = float(lost[lost > 0.0].sum())
    if missing > limits.DROPOUT_SHARE * (len(time) + missing):
        at = np.flatnonzero(lost > 0.0) * TOGETHER
        yield QualityFinding(
            KIND, topic, float(time[at[0]]), float(time[at[-1] + TOGETHER]),
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
    for begin, _ in find_runs(jumped)[:SHOWN].tolist():
        size = float(ahead[begin + 1] - ahead[begin])
        low, high = sorted((float(time[begin]), float(time[begin + 1])))
        yield QualityFinding(
            KIND, topic, low, high,
            f'The time stamps jump by {size:.3f} s relative to the log time.',
            Severity.SUSPICIOUS, {'jump': size},
        )  # fmt: skip
