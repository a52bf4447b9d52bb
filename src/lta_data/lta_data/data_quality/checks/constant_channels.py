"""A channel that never changes though its instrument always does."""

from collections import defaultdict

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import roles
from lta_data.data_quality.check_context import CheckContext
from lta_data.data_quality.finding import CheckVerdict, QualityFinding, Severity
import numpy as np

KIND = 'constant'


def find_constant_channels(evidence: CheckContext) -> CheckVerdict:
    """Find channels without any change, and vectors that nobody filled in."""
    limits = evidence.limits
    groups: defaultdict[str, list[SignalChannel]] = defaultdict(list)
    for channel in evidence.recording.channels.values():
        if should_vary(channel) and np.isfinite(channel.values).sum() >= limits.least_samples:
            groups[roles.vector_name(channel.name)].append(channel)
    found: list[QualityFinding] = []
    for name, group in groups.items():
        still = [channel for channel in group if is_constant(channel)]
        if evidence.recording.is_simulated and name.startswith('ground_truth'):
            still = [
                channel
                for channel in still
                if len(still) < len(group) and first_finite_value(channel)
            ]
        if len(still) == len(group) > 1 and all(
            first_finite_value(channel) == 0.0 for channel in still
        ):
            found.append(build_unfilled_finding(name, still[0]))
        else:
            found += [build_constant_finding(channel) for channel in still]
    return CheckVerdict(tuple(found))


def should_vary(channel: SignalChannel) -> bool:
    """Whether an instrument's channel should change all the time."""
    if roles.find_restless_kind(channel) is not None:
        return True
    lit = bool(roles.SHINE.match(channel.field)) and channel.topic == 'photodiodes'
    return roles.is_measured(channel) and (lit or channel.name == 'range/range')


def is_constant(channel: SignalChannel) -> bool:
    """Whether all finite values are one."""
    values = channel.values[np.isfinite(channel.values)]
    return bool((values == values[0]).all())


def first_finite_value(channel: SignalChannel) -> float:
    """Return the first finite value."""
    return float(channel.values[np.isfinite(channel.values)][0])


def build_unfilled_finding(name: str, channel: SignalChannel) -> QualityFinding:
    """Say that a vector is zero throughout: its sender has no such quantity."""
    return QualityFinding(
        KIND, name, float(channel.time[0]), float(channel.time[-1]),
        f'All parts are exactly 0 in all {len(channel.time)} messages: nobody filled them in.',
        Severity.NOTE,
    )  # fmt: skip


def build_constant_finding(channel: SignalChannel) -> QualityFinding:
    """Say that one channel is constant."""
    held = first_finite_value(channel)
    return QualityFinding(
        KIND, channel.name, float(channel.time[0]), float(channel.time[-1]),
        f'All {len(channel.time)} values are {held:.6g} {channel.unit}; an instrument of this '
        'kind never repeats itself for so long.',
        Severity.SUSPICIOUS, {'value': held},
    )  # fmt: skip
