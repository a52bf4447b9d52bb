"""A channel that never changes though its instrument always does."""

from collections import defaultdict

from lta_data.bag.channels import Channel
from lta_data.trust import roles
from lta_data.trust.evidence import Evidence
from lta_data.trust.finding import Finding, Severity, Verdict
import numpy as np

KIND = 'constant'


def check(evidence: Evidence) -> Verdict:
    """Find channels without any change, and vectors that nobody filled in."""
    limits = evidence.limits
    groups: defaultdict[str, list[Channel]] = defaultdict(list)
    for channel in evidence.recording.channels.values():
        if restless(channel) and np.isfinite(channel.values).sum() >= limits.least_samples:
            groups[roles.family(channel.name)].append(channel)
    found: list[Finding] = []
    for name, group in groups.items():
        still = [channel for channel in group if constant(channel)]
        if evidence.recording.simulated and name.startswith('ground_truth'):
            still = [channel for channel in still if len(still) < len(group) and value(channel)]
        if len(still) == len(group) > 1 and all(value(channel) == 0.0 for channel in still):
            found.append(unfilled(name, still[0]))
        else:
            found += [stuck(channel) for channel in still]
    return Verdict(tuple(found))


def restless(channel: Channel) -> bool:
    """Whether an instrument's channel should change all the time."""
    if roles.restless(channel) is not None:
        return True
    lit = bool(roles.SHINE.match(channel.field)) and channel.topic == 'photodiodes'
    return roles.measured(channel) and (lit or channel.name == 'range/range')


def constant(channel: Channel) -> bool:
    """Whether all finite values are one."""
    values = channel.values[np.isfinite(channel.values)]
    return bool((values == values[0]).all())


def value(channel: Channel) -> float:
    """Return the first finite value."""
    return float(channel.values[np.isfinite(channel.values)][0])


def unfilled(name: str, channel: Channel) -> Finding:
    """Say that a vector is zero throughout: its sender has no such quantity."""
    return Finding(
        KIND, name, float(channel.time[0]), float(channel.time[-1]),
        f'All parts are exactly 0 in all {len(channel.time)} messages: nobody filled them in.',
        Severity.NOTE,
    )  # fmt: skip


def stuck(channel: Channel) -> Finding:
    """Say that one channel is constant."""
    held = value(channel)
    return Finding(
        KIND, channel.name, float(channel.time[0]), float(channel.time[-1]),
        f'All {len(channel.time)} values are {held:.6g} {channel.unit}; an instrument of this '
        'kind never repeats itself for so long.',
        Severity.SUSPICIOUS, {'value': held},
    )  # fmt: skip
