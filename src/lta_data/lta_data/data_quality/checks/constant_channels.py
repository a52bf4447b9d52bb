"""Detect channels that never change although their instrument always does."""

from collections import defaultdict

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits, roles
from lta_data.data_quality.finding import CheckVerdict, QualityFinding, Severity
from lta_data.data_quality.recording import CheckContext
import numpy as np

KIND = 'constant'


def find_constant_channels(evidence: CheckContext) -> CheckVerdict:
    """Find constant channels, and vectors that were never filled in."""
    groups: defaultdict[str, list[SignalChannel]] = defaultdict(list)
    for channel in evidence.recording.channels.values():
        if should_vary(channel) and np.isfinite(channel.values).sum() >= limits.LEAST_SAMPLES:
            groups[roles.vector_name(channel.name)].append(channel)
    findings: list[QualityFinding] = []
    for name, group in groups.items():
        still = [channel for channel in group if is_constant(channel)]
        # In a simulated truth, zero components and entirely constant vectors are legitimate.
        if evidence.recording.is_simulated and name.startswith('ground_truth'):
            still = [
                channel
                for channel in still
                if len(still) < len(group) and first_finite_value(channel)
            ]
        # Many senders leave unknown vectors at zero: a note, not a suspicion
        if len(still) == len(group) > 1 and all(
            first_finite_value(channel) == 0.0 for channel in still
        ):
            findings.append(build_unfilled_finding(name, still[0]))
        else:
            findings += [build_constant_finding(channel) for channel in still]
    return CheckVerdict(tuple(findings))


def should_vary(channel: SignalChannel) -> bool:
    """Return whether a channel of an instrument should change all the time."""
    if roles.match_noisy_quantity(channel) is not None:
        return True
    lit = bool(roles.SHINE.match(channel.field)) and channel.topic == 'photodiodes'
    return roles.is_measured(channel) and (lit or channel.name == 'range/range')


def is_constant(channel: SignalChannel) -> bool:
    """Return whether all finite values are equal."""
    values = channel.values[np.isfinite(channel.values)]
    return bool((values == values[0]).all())


def first_finite_value(channel: SignalChannel) -> float:
    """Return the first finite value."""
    return float(channel.values[np.isfinite(channel.values)][0])


def build_unfilled_finding(name: str, channel: SignalChannel) -> QualityFinding:
    """Return the finding of a vector that is always zero: its sender has no such quantity."""
    text = (
        f'All components are exactly 0 in all {len(channel.time)} messages: the sender does '
        'not fill them in.'
    )
    # Zero angles are an identity quaternion, which is set; an unset one has length 0
    if roles.ANGLE.match(channel.field):
        text = (
            f'The attitude is the identity in all {len(channel.time)} messages, exactly level '
            'with heading 0: the sender may not measure it.'
        )
    return QualityFinding(
        KIND, name, float(channel.time[0]), float(channel.time[-1]), text, Severity.NOTE
    )


def build_constant_finding(channel: SignalChannel) -> QualityFinding:
    """Return the finding of a constant channel."""
    held = first_finite_value(channel)
    why = 'the noise of a real sensor would change them.'
    if held == 0.0 and roles.ANGLE.match(channel.field):
        why = (
            'the angle was not recorded, and the import of a log without its column takes it as '
            'zero. Export it, too: models are fitted to the tilt.'
        )
    return QualityFinding(
        KIND, channel.name, float(channel.time[0]), float(channel.time[-1]),
        f'All {len(channel.time)} values are {held:.6g} {channel.unit}; {why}',
        Severity.SUSPICIOUS, {'value': held},
    )  # fmt: skip
