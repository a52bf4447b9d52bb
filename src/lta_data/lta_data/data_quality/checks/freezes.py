"""
Detect channels that freeze for a while and then continue.

Consecutive equal values are regular if a slow instrument is sampled fast, and random if its
resolution is coarse. A run is suspicious if it is much longer than either explains.
"""

from collections.abc import Iterator
import math

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits, roles
from lta_data.data_quality.checks.constant_channels import is_constant
from lta_data.data_quality.finding import CheckVerdict, QualityFinding, Severity
from lta_data.data_quality.recording import CheckContext
from lta_data.data_quality.smoothing import find_coarse_unit, find_runs, median_period
import numpy as np
from numpy.typing import NDArray

KIND = 'frozen'
START = 3  # samples within which a run counts as starting at the beginning
RELEASED = 5.0  # least jump at the end of a freeze, in usual steps
HIDDEN = 2.5  # units to which readings are rounded; a motion may change them so much at once
NOTHING = 1e-9  # residual speed of a simulated vehicle at rest
USUAL = 90.0  # percentile of the run lengths that counts as regular


def find_freezes(evidence: CheckContext) -> CheckVerdict:
    """Find freezes in noisy channels."""
    findings = [
        finding
        for channel in evidence.recording.channels.values()
        if roles.match_noisy_quantity(channel) and len(channel.values) >= limits.LEAST_SAMPLES
        for finding in find_channel_freezes(channel, evidence.recording.is_simulated)
    ]
    return CheckVerdict(tuple(findings))


def find_channel_freezes(channel: SignalChannel, simulated: bool) -> Iterator[QualityFinding]:
    """Yield the freezes of one channel."""
    values = channel.values
    if not np.isfinite(values).any() or is_constant(channel):
        return
    with np.errstate(invalid='ignore'):
        equal = np.diff(values) == 0.0
    if simulated:  # exactly constant until take-off
        equal[: find_initial_run_end(equal)] = False
    runs = find_runs(equal)
    lengths = runs[:, 1] - runs[:, 0]
    # Of each value, most of which are read once
    holds = np.diff(np.flatnonzero(np.concatenate(([True], ~equal, [True]))))
    low, high = np.nanmin(values), np.nanmax(values)
    hidden = HIDDEN * find_coarse_unit(values)
    for (begin, end), length in zip(runs.tolist(), lengths.tolist(), strict=True):
        held = values[begin]
        # A run at an extreme is clipping, which another check reports
        piled = held in {low, high} and not ends_with_jump(values, end)
        rests = (
            simulated
            and channel.topic.startswith('ground_truth')
            and (end == len(equal) or abs(held) < NOTHING)
        )
        # Rounded readings of a slow motion repeat; those of a frozen one jump when it goes on
        slow = hidden and not abs(values[min(end + 1, len(equal))] - held) > hidden
        if piled or rests or slow or length + 1 < limits.FROZEN_SAMPLES:
            continue
        # Sample-and-hold data have long runs all the time.
        usual = np.percentile(holds, USUAL)
        # Share of equal neighbours outside this run: how often the sensor repeats a value anyway
        share = (equal.sum() - length) / max(1, len(equal) - length)
        # Probability of such a run at any position, if equal neighbours were independent.
        chance = math.log(len(equal)) + length * math.log(max(share, 1.0 / len(equal)))
        last = float(channel.time[end]) - float(channel.time[begin])
        if (
            chance < math.log(limits.FROZEN_CHANCE)
            and length > limits.FROZEN_TIMES * max(1.0, float(usual))
            and last + median_period(channel.time) > limits.FROZEN_TIME
        ):
            yield build_freeze_finding(channel, begin, end)


def find_initial_run_end(equal: NDArray[np.bool_]) -> int:
    """Return the end of a run at the beginning; 0 without one."""
    runs = find_runs(equal)
    return int(runs[0, 1]) if len(runs) and runs[0, 0] <= START else 0


def ends_with_jump(values: NDArray[np.float64], end: int) -> bool:
    """
    Return whether a run at an extreme ends with a jump.

    A clipped signal leaves the limit continuously; a frozen one has moved on in the meantime.
    """
    if end + 1 >= len(values):
        return False
    with np.errstate(invalid='ignore'):
        steps = np.abs(np.diff(values))
    steps = steps[np.isfinite(steps)]
    usual = float(np.median(steps[steps > 0.0]))
    return bool(abs(values[end + 1] - values[end]) > RELEASED * usual)


def build_freeze_finding(channel: SignalChannel, begin: int, end: int) -> QualityFinding:
    """Return the finding of a frozen stretch."""
    first, last = float(channel.time[begin]), float(channel.time[end])
    held = float(channel.values[begin])
    return QualityFinding(
        KIND, channel.name, first, last,
        f'The value is stuck at {held:.6g} {channel.unit} for {end - begin + 1} readings '
        f'({last - first:.2f} s), but changes before and after.',
        Severity.SUSPICIOUS, {'value': held, 'readings': end - begin + 1.0},
    )  # fmt: skip
