"""
A channel that piles up at an extreme: its instrument, its converter or a program cut it off.

What is measured thins out towards its extremes, so that the outermost value is the rarest; at a
limit it is the most frequent, and it is held there in runs.
"""

from collections.abc import Iterator

from lta_data.bag.channels import Channel
from lta_data.trust import roles
from lta_data.trust.checks.constant import constant
from lta_data.trust.checks.frozen import first_move, released, START
from lta_data.trust.evidence import Evidence
from lta_data.trust.finding import Finding, Severity, Verdict
from lta_data.trust.limits import Limits
from lta_data.trust.runs import runs
import numpy as np

KIND = 'clipped'
NEIGHBOURS = 3
ADC = 'photodiodes'
UNKNOWN_TOP = (
    'How far the converter of the photodiodes counts is unknown, since the recording holds no '
    'vehicle file that can be read: what reaches its upper end cannot be judged.'
)


def check(evidence: Evidence) -> Verdict:
    """Find pile-ups at extremes, and converter blocks at the ends of the converter."""
    found: list[Finding] = []
    for channel in evidence.recording.channels.values():
        if roles.restless(channel):
            found += piled(channel, evidence.limits, evidence.recording.simulated)
        elif channel.topic == ADC and channel.field.startswith(('min[', 'max[')):
            found += railed(channel, evidence)
    lit = any(channel.topic == ADC for channel in evidence.recording.channels.values())
    return Verdict(tuple(found), (UNKNOWN_TOP,) if lit and evidence.top is None else ())


def piled(channel: Channel, limits: Limits, simulated: bool) -> Iterator[Finding]:
    """Yield the extremes of one channel at which it piles up."""
    good = np.isfinite(channel.values)
    if simulated:  # at rest until it flies, to the last bit
        good[: first_move(np.diff(channel.values, prepend=channel.values[:1]) == 0.0)] = False
    values, time = channel.values[good], channel.time[good]
    if len(values) < limits.least_samples or constant(channel):
        return
    levels, counts = np.unique(values, return_counts=True)
    for side, word in ((0, 'lowest'), (-1, 'highest')):
        count = int(counts[side])
        beside = counts[1 : 1 + NEIGHBOURS] if side == 0 else counts[-1 - NEIGHBOURS : -1]
        if count < limits.clipped_samples or count < limits.clipped_pile * float(
            np.median(beside)
        ):
            continue
        at = runs(values == levels[side])
        alone = len(at) == 1
        rests = simulated and alone and (at[0, 0] <= START or at[0, 1] == len(values))
        stopped = alone and released(values, int(at[0, 1]) - 1)
        if (at[:, 1] - at[:, 0]).max() < limits.clipped_run or rests or stopped:
            continue
        yield Finding(
            KIND, channel.name, float(time[at[0, 0]]), float(time[at[-1, 1] - 1]),
            f'{count} of {len(values)} readings are the {word} one, {levels[side]:.6g} '
            f'{channel.unit}, and {np.median(beside):.0f} each of the next values.',
            Severity.SUSPICIOUS, {'limit': float(levels[side]), 'readings': float(count)},
        )  # fmt: skip


def railed(channel: Channel, evidence: Evidence) -> Iterator[Finding]:
    """Yield where the blocks of one diode reach an end of the converter."""
    end = evidence.top if channel.field.startswith('max[') else 0.0
    if end is None:
        return
    at = channel.values == end
    if int(at.sum()) >= evidence.limits.adc_blocks:
        times = channel.time[at]
        yield Finding(
            KIND, channel.name, float(times[0]), float(times[-1]),
            f'{int(at.sum())} of {len(at)} blocks reach the end of the converter, {end:.0f} '
            'counts.',
            Severity.SUSPICIOUS, {'limit': end, 'blocks': float(at.sum())},
        )  # fmt: skip
