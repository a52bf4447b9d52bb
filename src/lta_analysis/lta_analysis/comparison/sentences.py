# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Describe a comparison in sentences: verdict, divergence, and alignment of clocks and frames."""

from dataclasses import asdict, replace
import math
from typing import Any, Final

from lta_config.constants import DEGREES_PER_RADIAN
from lta_config.errors import format_count
from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.channel_roles import (
    FIELDS,
    find_pose_prefix,
    select_headline_channels,
)
from lta_data.compare.comparison import ComparisonResult
from lta_data.compare.frame_alignment import FrameAlignment, FrameTransform
from lta_data.compare.time_alignment import TimeAlignment
from lta_data.flight import Flight
from lta_report.json_value import to_json_value
import numpy as np

BASIS: Final = 1e6  # ppm
MISSING_DASH: Final = '\N{EN DASH}'


def format_channel_name(channel: ChannelComparison) -> str:
    """Return the common name of a channel, with its topic."""
    topic, _, field = channel.name.rpartition('/')
    word = next((word for end, word in FIELDS.items() if field.endswith(end)), field)
    return f'{word} of {topic}'


def format_quantity(value: float, unit: str, digits: int = 3) -> str:
    """Format a value with its unit; angles in degrees."""
    if unit in ('rad', 'rad/s'):
        value, unit = value * DEGREES_PER_RADIAN, unit.replace('rad', '°')
    return f'{value:.{digits}g}' + (
        unit if unit.startswith('°') else f' {unit}' if unit not in ('', '1') else ''
    )


def format_verdict(comparison: ComparisonResult) -> str:
    """Return the verdict in a sentence."""
    if comparison.is_identical:
        return f'Identical: {describe_equality(comparison)}.'
    if comparison.is_within_bands:
        few = len(comparison.channels)
        what = 'tolerances' if comparison.request.tolerances else 'noise'
        return f'The flights agree within their {what}: none of {few} channels diverges.'
    parted = [
        each
        for each in select_headline_channels(comparison.channels)
        if each.parting.at is not None
    ]
    if not parted:
        return describe_minor_differences(comparison)
    first = find_earliest_divergence(parted)
    who = format_subject(comparison)
    text = f'{who} diverge at {first.parting.at:.2f} s, first in {format_channel_name(first)}'
    if differs_from_start(first):
        text = f'{who} differ from the start, in {format_channel_name(first)}'
    worst = parted[0]
    if worst is not first:
        text += f', and most in {format_channel_name(worst)}'
    elif len(parted) > 1:
        text += ', which also differs most'
    rms = 0.0 if worst.measures is None else worst.measures.rms
    return f'{text}: {format_quantity(rms, worst.unit)} RMS.{describe_separation(comparison)}'


def describe_separation(comparison: ComparisonResult) -> str:
    """Return how far apart the positions are, and where; '' without those of the vehicle."""
    pose = find_pose_prefix(comparison.channels)
    is_flown = pose and not pose.startswith(('setpoint', 'light'))
    names = {f'{pose}position.{axis}' for axis in 'xyz'} if is_flown else set()
    places = [each.both for each in comparison.channels if each.name in names]
    if len(places) < 3 or len({len(each.time) for each in places}) > 1:
        return ''
    apart = np.linalg.norm([each.difference for each in places], axis=0)
    samples = np.flatnonzero(np.isfinite(apart))
    if not len(samples):
        return ''
    most, last = samples[np.argmax(apart[samples])], samples[-1]
    time = places[0].time
    return (
        f' The positions are up to {format_quantity(apart[most], "m")} apart, at {time[most]:.1f} '
        f's, and {format_quantity(apart[last], "m")} at {time[last]:.1f} s, the last time of both.'
    )


def format_sides(comparison: ComparisonResult) -> tuple[str, str]:
    """Return the names of both sides: A and B, or two topics of one flight."""
    if is_one_flight(comparison):
        ((topic, other),) = comparison.topics.items()
        return topic, other
    return 'A', 'B'


def is_one_flight(comparison: ComparisonResult) -> bool:
    """Return whether two topics of one flight are compared."""
    a, b = comparison.a, comparison.b
    one = bool(a.path) and (a.path, a.robot) == (b.path, b.robot)
    return one and len(comparison.topics) == 1


def format_subject(comparison: ComparisonResult) -> str:
    """Return the subject of the sentence: two flights, or two topics of one."""
    return ' and '.join(format_sides(comparison)) if is_one_flight(comparison) else 'The flights'


def differs_from_start(channel: ChannelComparison) -> bool:
    """Return whether a channel differs from the first common samples on."""
    time = channel.both.time[channel.both.both_valid]
    # At the first or second common sample
    return len(time) > 1 and channel.parting.at is not None and channel.parting.at <= time[1]


def describe_minor_differences(comparison: ComparisonResult) -> str:
    """Describe flights whose motion agrees but that differ in other channels."""
    parted = sum(each.parting.at is not None for each in comparison.channels)
    times = sum(each.verdict == 'apart at times' for each in comparison.channels)
    parts = []
    if parted:
        parts.append(f'{format_count(parted, "other channel")} {"does" if parted == 1 else "do"}')
    if times:
        parts.append(
            f'{format_count(times, "channel")} {"differs" if times == 1 else "differ"} at times'
        )
    return f'The motion does not diverge, but {" and ".join(parts)}.'


def describe_equality(comparison: ComparisonResult) -> str:
    """Return what is equal in both flights."""
    topics = len(comparison.identical_topics)
    if topics and topics == len(comparison.a.topics):
        if topics == 1:
            return 'the only topic is identical in every value'
        return f'all {topics} topics are identical in every value'
    return f'all {len(comparison.channels)} channels have the same times and values'


def find_earliest_divergence(parted: list[ChannelComparison]) -> ChannelComparison:
    """Return the channel that diverges first; at equal times, the one with the highest score."""
    return min(parted, key=lambda each: (each.parting.at, -each.score))


def describe_comparison(comparison: ComparisonResult) -> str:
    """Describe what is compared, in two or three sentences."""
    begin, end = comparison.span
    return (
        f'A is {describe_source(comparison.a)}; B is {describe_source(comparison.b)}. Differences '
        f'are B minus A over the '
        f"{end - begin:.2f} s that both cover, on A's clock. {describe_timing(comparison.timing)}"
    )


def describe_source(side: Flight) -> str:
    """Return the origin of a flight."""
    facts = [side.provenance.get(key, '') for key in ('vehicle', 'scenario')]
    seed = side.provenance.get('seed')
    text = ' '.join([fact for fact in facts if fact] + ([f'seed {seed}'] if seed else []))
    robot = f', {side.robot}' if side.robot else ''
    return f'{side.path}{robot}' + (f' ({text})' if text else '')


def describe_timing(timing: TimeAlignment) -> str:
    """Describe the alignment of the clocks."""
    if timing.how == 'none':
        base = (
            'The time stamps are unchanged'
            if timing.on_stamps
            else 'The time of each flight starts at zero'
        )
        return f'{base}. {timing.reason}'
    text = f"B's {describe_time_base(timing)} {format_offset(timing)}. {timing.reason}"
    if timing.drift:
        text += f" B's clock drifts by {BASIS * timing.drift:+.0f} ppm against A's."
    return text


def describe_time_base(timing: TimeAlignment) -> str:
    """Return what an offset refers to."""
    return 'clock' if timing.on_stamps else 'time since its start'


def format_offset_and_interval(timing: TimeAlignment) -> tuple[str, str, str]:
    """Return an offset, half its 95 % interval ('' if none) and their unit."""
    factor, unit = (1e3, 'ms') if 0.0 < abs(timing.offset) < 1.0 else (1.0, 's')
    doubt = 1.96 * timing.sigma * factor
    # Set by hand, or unknown
    if not doubt > 0.0:
        return f'{factor * timing.offset:.6g}', '', unit
    # Two significant digits of the uncertainty.
    decimals = max(0, 1 - math.floor(math.log10(doubt)))
    return f'{factor * timing.offset:.{decimals}f}', f'{doubt:.{decimals}f}', unit


def format_offset(timing: TimeAlignment) -> str:
    """Format an offset with its 95 % interval."""
    ahead = 'ahead' if timing.offset >= 0.0 else 'behind'
    value, doubt, unit = format_offset_and_interval(replace(timing, offset=abs(timing.offset)))
    when = f' at {timing.middle:.1f} s' if timing.drift else ''
    return f'is {value}{f" ± {doubt}" if doubt else ""} {unit} {ahead}{when}'


def format_decimal(value: float, digits: int) -> str:
    """Format a number with fixed decimals, without '-0'."""
    text = f'{value:.{digits}f}'
    return text.removeprefix('-') if float(text) == 0.0 else text


def describe_frames(placed: FrameAlignment) -> str:
    """Describe what was done about a pair of frames."""
    fit = placed.fit
    if fit is None or not placed.applied:
        return f'B is not transformed. {placed.reason}'
    return f'B {describe_frame_transform(fit)}. {placed.reason}'


def describe_frame_transform(fit: FrameTransform) -> str:
    """Describe a rotation and shift."""
    how = ' (rotation estimated from the headings)' if fit.by_heading else ''
    shift = ', '.join(format_decimal(part, 3) for part in (fit.x, fit.y, fit.z))
    degrees = format_decimal(fit.yaw * DEGREES_PER_RADIAN, 2)
    moved = f'is rotated by {degrees}° and shifted by ({shift}) m{how}'
    return (
        f'{moved}; this reduces the distance between the paths from {fit.before:.3f} m to '
        f'{fit.after:.3f} m'
    )


JSON_UNITS = {
    'offset': 's', 'sigma': 's', 'lead': 's', 'drift': '1', 'drift_sigma': '1', 'middle': 's',
    'span': 's', 'yaw': 'rad', 'x': 'm', 'y': 'm', 'z': 'm', 'before': 'm', 'after': 'm',
    'periods': 's', 'at': 's', 'first': 's', 'greatest_at': 's', 'lag': 's', 'start': 'ns',
    'nrmse': '1', 'outside': '1', 'score': '1',
    'bias, rms, rms_low, rms_high, greatest, spread, band': 'unit',
}  # fmt: skip


def comparison_to_dict(comparison: ComparisonResult) -> dict[str, Any]:
    """Return the whole comparison; unknown values are null."""
    content = {
        'verdict': comparison.verdict,
        'sentence': format_verdict(comparison),
        'a': flight_to_dict(comparison.a, comparison.only_a),
        'b': flight_to_dict(comparison.b, comparison.only_b),
        'span': comparison.span,
        'timing': asdict(comparison.timing),
        'frames': [asdict(each) for each in comparison.frames],
        'identical_topics': comparison.identical_topics,
        'remarks': comparison.remarks,
        'channels': [channel_to_dict(each) for each in comparison.channels],
        'normalised_by': 'standard deviation of A at the compared times',
        'units': JSON_UNITS,
    }
    plain: dict[str, Any] = to_json_value(content)
    return plain


def flight_to_dict(side: Flight, only: tuple[str, ...]) -> dict[str, Any]:
    """Return the origin of one flight."""
    return {
        'path': side.path,
        'robot': side.robot,
        'start': side.start,
        'span': side.span,
        'topics_only_here': only,
    }


def channel_to_dict(each: ChannelComparison) -> dict[str, Any]:
    """Return a channel without its samples."""
    return {
        'name': each.name,
        'other': each.other,
        'unit': each.unit,
        'angular': each.angular,
        'verdict': each.verdict,
        'score': each.score,
        'periods': each.periods,
        'measures': each.measures,
        'parting': each.parting,
        # A NamedTuple would become a list.
        'correlation': each.lag
        and {'value': each.lag.correlations[each.name], 'lag': each.lag.lag},
    }
