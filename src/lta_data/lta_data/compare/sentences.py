"""A comparison in words: how the flights stand, when they part, and what was done about clocks."""

from dataclasses import replace
import math
from typing import Final

from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.channel_roles import FIELDS, select_headline_channels
from lta_data.compare.compared_flight import ComparedFlight
from lta_data.compare.comparison import ComparisonResult
from lta_data.compare.faults import TopicFaults
from lta_data.compare.frame_alignment import FrameAlignment
from lta_data.compare.frame_fit import FramePlacement
from lta_data.compare.time_alignment import TimeAlignment

DEGREES: Final = 180.0 / math.pi
BASIS: Final = 1e6
MISSING: Final = '\N{EN DASH}'


def format_channel_name(channel: ChannelComparison) -> str:
    """Return what people call a channel, with its topic."""
    topic, _, field = channel.name.rpartition('/')
    word = next((word for end, word in FIELDS.items() if field.endswith(end)), field)
    return f'{word} of {topic}'


def format_quantity(value: float, unit: str, digits: int = 3) -> str:
    """Return a value with its unit; angles in degrees."""
    if unit in ('rad', 'rad/s'):
        value, unit = value * DEGREES, unit.replace('rad', '°')
    return f'{value:.{digits}g}' + (
        unit if unit.startswith('°') else f' {unit}' if unit not in ('', '1') else ''
    )


def format_verdict(comparison: ComparisonResult) -> str:
    """Return how the flights stand, in a sentence."""
    if comparison.is_identical:
        return f'Identical: {describe_equality(comparison)}.'
    if comparison.is_same:
        few = len(comparison.channels)
        what = 'tolerances' if comparison.asked.tolerances else 'noise'
        return f'The same within their {what}: none of {few} channels parts.'
    parted = [
        each
        for each in select_headline_channels(comparison.channels)
        if each.parting.at is not None
    ]
    if not parted:
        return format_minor_differences(comparison)
    first = find_earliest(parted)
    who = format_subject(comparison)
    text = f'{who} part at {first.parting.at:.2f} s, first in {format_channel_name(first)}'
    if is_apart_initially(first):
        text = f'{who} are apart from the start, in {format_channel_name(first)}'
    worst = parted[0]
    if worst is not first:
        text += f', and most in {format_channel_name(worst)}'
    elif len(parted) > 1:
        text += ' and there most'
    rms = 0.0 if worst.measures is None else worst.measures.rms
    return f'{text}: {format_quantity(rms, worst.unit)} RMS.'


def format_subject(comparison: ComparisonResult) -> str:
    """Return what is compared: two flights, or two topics of one."""
    one = (comparison.a.path, comparison.a.robot) == (comparison.b.path, comparison.b.robot)
    if one and len(comparison.topics) == 1:
        ((topic, other),) = comparison.topics.items()
        return f'{topic} and {other}'
    return 'The flights'


def is_apart_initially(channel: ChannelComparison) -> bool:
    """Tell whether a channel is apart as soon as both are known."""
    time = channel.both.time[channel.both.both_valid]
    return len(time) > 1 and channel.parting.at is not None and channel.parting.at <= time[1]


def format_minor_differences(comparison: ComparisonResult) -> str:
    """Return how flights stand whose motion does not part."""
    parted = sum(each.parting.at is not None for each in comparison.channels)
    times = sum(each.verdict == 'apart at times' for each in comparison.channels)
    parts = []
    if parted:
        parts.append(
            f'{format_count(parted, "channel")} beside it {"does" if parted == 1 else "do"}'
        )
    if times:
        parts.append(
            f'{format_count(times, "channel")} {"is" if times == 1 else "are"} apart at times'
        )
    return f'The motion does not part, but {" and ".join(parts)}.'


def describe_equality(comparison: ComparisonResult) -> str:
    """Return what is the same in both flights."""
    topics = len(comparison.identical_topics)
    if topics and topics == len(comparison.a.topics):
        if topics == 1:
            return 'the one topic is the same byte for byte'
        return f'all {topics} topics are the same byte for byte'
    return f'all {len(comparison.channels)} channels have the same instants and values'


def find_earliest(parted: list[ChannelComparison]) -> ChannelComparison:
    """Return the channel that parts first; of several at one instant the one furthest apart."""
    return min(parted, key=lambda each: (each.parting.at, -each.score))


def describe_comparison(comparison: ComparisonResult) -> str:
    """Return what stands beside what, in two or three sentences."""
    begin, end = comparison.span
    return (
        f'A is {describe_source(comparison.a)}; B is {describe_source(comparison.b)}. Differences '
        f'are B minus A over the '
        f"{end - begin:.2f} s that both cover, on A's clock. {describe_timing(comparison.timing)}"
    )


def describe_source(side: ComparedFlight) -> str:
    """Return where a flight comes from."""
    facts = [side.provenance.get(key, '') for key in ('vehicle', 'scenario')]
    seed = side.provenance.get('seed')
    known = ' '.join([fact for fact in facts if fact] + ([f'seed {seed}'] if seed else []))
    robot = f', {side.robot}' if side.robot else ''
    return f'{side.path}{robot}' + (f' ({known})' if known else '')


def describe_timing(timing: TimeAlignment) -> str:
    """Return what was done about the clocks."""
    if timing.how == 'none':
        base = (
            'Stamps are taken as they are'
            if timing.on_stamps
            else ('Each flight counts from its own start')
        )
        return f'{base}. {timing.reason}'
    text = f"B's {describe_time_base(timing)} {format_offset(timing)}. {timing.reason}"
    if timing.drift:
        text += f" It runs {BASIS * timing.drift:+.0f} ppm against A's."
    return text


def describe_time_base(timing: TimeAlignment) -> str:
    """Return what an offset counts between."""
    return 'clock' if timing.on_stamps else 'time since its start'


def format_offset_parts(timing: TimeAlignment) -> tuple[str, str, str]:
    """Return an offset, half its 95 % interval ('' where it has none) and their unit."""
    factor, unit = (1e3, 'ms') if 0.0 < abs(timing.offset) < 1.0 else (1.0, 's')
    doubt = 1.96 * timing.sigma * factor
    if not doubt > 0.0:
        return f'{factor * timing.offset:.6g}', '', unit
    decimals = max(0, 1 - math.floor(math.log10(doubt)))
    return f'{factor * timing.offset:.{decimals}f}', f'{doubt:.{decimals}f}', unit


def format_offset(timing: TimeAlignment) -> str:
    """Return an offset with its 95 % interval."""
    ahead = 'ahead' if timing.offset >= 0.0 else 'behind'
    value, doubt, unit = format_offset_parts(replace(timing, offset=abs(timing.offset)))
    when = f' at {timing.middle:.1f} s' if timing.drift else ''
    return f'is {value}{f" ± {doubt}" if doubt else ""} {unit} {ahead}{when}'


def format_decimal(value: float, digits: int) -> str:
    """Return a number with so many decimals; nothing is no less than nothing."""
    text = f'{value:.{digits}f}'
    return text.removeprefix('-') if float(text) == 0.0 else text


def describe_frames(placed: FrameAlignment) -> str:
    """Return what was done about a pair of frames."""
    fit = placed.fit
    if fit is None or not placed.applied:
        return f'As given. {placed.reason}'
    return f'B {describe_placement(fit)}. {placed.reason}'


def describe_placement(fit: FramePlacement) -> str:
    """Return a turn and shift."""
    how = ', the turn by the headings' if fit.by_heading else ''
    shift = ', '.join(format_decimal(part, 3) for part in (fit.x, fit.y, fit.z))
    moved = f'turned by {format_decimal(fit.yaw * DEGREES, 2)}° and shifted by ({shift}) m{how}'
    return f'{moved}; the paths are {fit.after:.3f} m apart so, {fit.before:.3f} m before'


def describe_faults(faults: TopicFaults) -> str:
    """Return what is wrong with a topic; empty where nothing is."""
    parts = []
    if faults.gap_count:
        longest = max(faults.gaps, key=lambda gap: gap.end - gap.begin)
        parts.append(
            f'{format_count(faults.gap_count, "gap")}, {faults.missing:.2f} s in all, the longest '
            f'{longest.begin:.2f} to {longest.end:.2f} s'
        )
    if faults.same_stamp:
        again = f', {faults.repeated} of them byte for byte' if faults.repeated else ''
        parts.append(f'{format_count(faults.same_stamp, "message")} at the time of another{again}')
    if faults.backwards_count:
        first = faults.backwards[0]
        parts.append(
            f'time runs backwards {format_count(faults.backwards_count, "time")}, first from '
            f'{first.begin:.3f} to {first.end:.3f} s'
        )
    if faults.unknown:
        worst = max(faults.unknown.values())
        parts.append(
            f'{format_count(len(faults.unknown), "channel")} without a number in up to '
            f'{100 * worst:.1f} % of the messages'
        )
    if not faults.rhythm:
        parts.append('no even rhythm, so gaps cannot be told')
    return '; '.join(parts)


def format_count(count: int, word: str) -> str:
    """Return a count and its noun."""
    return f'{count} {word}{"" if count == 1 else "s"}'


def format_rate(faults: TopicFaults) -> str:
    """Return the rate of a topic."""
    return MISSING if not faults.period else f'{1.0 / faults.period:.4g} Hz'
