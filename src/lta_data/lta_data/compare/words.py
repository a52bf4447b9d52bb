"""A comparison in words: how the flights stand, when they part, and what was done about clocks."""

from dataclasses import replace
import math
from typing import Final

from lta_data.compare.apart import Apart
from lta_data.compare.comparison import Comparison
from lta_data.compare.faults import Faults
from lta_data.compare.frames import Placement
from lta_data.compare.placing import Placed
from lta_data.compare.roles import FIELDS, headline
from lta_data.compare.side import Side
from lta_data.compare.timing import Timing

DEGREES: Final = 180.0 / math.pi
BASIS: Final = 1e6
MISSING: Final = '\N{EN DASH}'


def called(channel: Apart) -> str:
    """Return what people call a channel, with its topic."""
    topic, _, field = channel.name.rpartition('/')
    word = next((word for end, word in FIELDS.items() if field.endswith(end)), field)
    return f'{word} of {topic}'


def amount(value: float, unit: str, digits: int = 3) -> str:
    """Return a value with its unit; angles in degrees."""
    if unit in ('rad', 'rad/s'):
        value, unit = value * DEGREES, unit.replace('rad', '°')
    return f'{value:.{digits}g}' + (
        unit if unit.startswith('°') else f' {unit}' if unit not in ('', '1') else ''
    )


def verdict(found: Comparison) -> str:
    """Return how the flights stand, in a sentence."""
    if found.identical:
        return f'Identical: {bytes_or_values(found)}.'
    if found.same:
        few = len(found.channels)
        what = 'tolerances' if found.asked.tolerances else 'noise'
        return f'The same within their {what}: none of {few} channels parts.'
    parted = [each for each in headline(found.channels) if each.parting.at is not None]
    if not parted:
        return beside(found)
    first = earliest(parted)
    who = subject(found)
    text = f'{who} part at {first.parting.at:.2f} s, first in {called(first)}'
    if begins_apart(first):
        text = f'{who} are apart from the start, in {called(first)}'
    worst = parted[0]
    if worst is not first:
        text += f', and most in {called(worst)}'
    elif len(parted) > 1:
        text += ' and there most'
    rms = 0.0 if worst.measures is None else worst.measures.rms
    return f'{text}: {amount(rms, worst.unit)} RMS.'


def subject(found: Comparison) -> str:
    """Return what is compared: two flights, or two topics of one."""
    one = (found.a.path, found.a.robot) == (found.b.path, found.b.robot)
    if one and len(found.topics) == 1:
        ((topic, other),) = found.topics.items()
        return f'{topic} and {other}'
    return 'The flights'


def begins_apart(channel: Apart) -> bool:
    """Tell whether a channel is apart as soon as both are known."""
    time = channel.both.time[channel.both.known]
    return len(time) > 1 and channel.parting.at is not None and channel.parting.at <= time[1]


def beside(found: Comparison) -> str:
    """Return how flights stand whose motion does not part."""
    parted = sum(each.parting.at is not None for each in found.channels)
    times = sum(each.verdict == 'apart at times' for each in found.channels)
    parts = []
    if parted:
        parts.append(f'{counted(parted, "channel")} beside it {"does" if parted == 1 else "do"}')
    if times:
        parts.append(f'{counted(times, "channel")} {"is" if times == 1 else "are"} apart at times')
    return f'The motion does not part, but {" and ".join(parts)}.'


def bytes_or_values(found: Comparison) -> str:
    """Return what is the same in both flights."""
    topics = len(found.identical_topics)
    if topics and topics == len(found.a.topics):
        if topics == 1:
            return 'the one topic is the same byte for byte'
        return f'all {topics} topics are the same byte for byte'
    return f'all {len(found.channels)} channels have the same instants and values'


def earliest(parted: list[Apart]) -> Apart:
    """Return the channel that parts first; of several at one instant the one furthest apart."""
    return min(parted, key=lambda each: (each.parting.at, -each.score))


def about(found: Comparison) -> str:
    """Return what stands beside what, in two or three sentences."""
    begin, end = found.span
    return (
        f'A is {source(found.a)}; B is {source(found.b)}. Differences are B minus A over the '
        f"{end - begin:.2f} s that both cover, on A's clock. {timing_words(found.timing)}"
    )


def source(side: Side) -> str:
    """Return where a flight comes from."""
    facts = [side.provenance.get(key, '') for key in ('vehicle', 'scenario')]
    seed = side.provenance.get('seed')
    known = ' '.join([fact for fact in facts if fact] + ([f'seed {seed}'] if seed else []))
    robot = f', {side.robot}' if side.robot else ''
    return f'{side.path}{robot}' + (f' ({known})' if known else '')


def timing_words(timing: Timing) -> str:
    """Return what was done about the clocks."""
    if timing.how == 'none':
        base = (
            'Stamps are taken as they are'
            if timing.on_stamps
            else ('Each flight counts from its own start')
        )
        return f'{base}. {timing.reason}'
    text = f"B's {base_words(timing)} {offset_words(timing)}. {timing.reason}"
    if timing.drift:
        text += f" It runs {BASIS * timing.drift:+.0f} ppm against A's."
    return text


def base_words(timing: Timing) -> str:
    """Return what an offset counts between."""
    return 'clock' if timing.on_stamps else 'time since its start'


def offset_figures(timing: Timing) -> tuple[str, str, str]:
    """Return an offset, half its 95 % interval ('' where it has none) and their unit."""
    factor, unit = (1e3, 'ms') if 0.0 < abs(timing.offset) < 1.0 else (1.0, 's')
    doubt = 1.96 * timing.sigma * factor
    if not doubt > 0.0:
        return f'{factor * timing.offset:.6g}', '', unit
    decimals = max(0, 1 - math.floor(math.log10(doubt)))
    return f'{factor * timing.offset:.{decimals}f}', f'{doubt:.{decimals}f}', unit


def offset_words(timing: Timing) -> str:
    """Return an offset with its 95 % interval."""
    ahead = 'ahead' if timing.offset >= 0.0 else 'behind'
    value, doubt, unit = offset_figures(replace(timing, offset=abs(timing.offset)))
    when = f' at {timing.middle:.1f} s' if timing.drift else ''
    return f'is {value}{f" ± {doubt}" if doubt else ""} {unit} {ahead}{when}'


def signless(value: float, digits: int) -> str:
    """Return a number with so many decimals; nothing is no less than nothing."""
    text = f'{value:.{digits}f}'
    return text.removeprefix('-') if float(text) == 0.0 else text


def frame_words(placed: Placed) -> str:
    """Return what was done about a pair of frames."""
    fit = placed.fit
    if fit is None or not placed.applied:
        return f'As given. {placed.reason}'
    return f'B {placement_words(fit)}. {placed.reason}'


def placement_words(fit: Placement) -> str:
    """Return a turn and shift."""
    how = ', the turn by the headings' if fit.by_heading else ''
    shift = ', '.join(signless(part, 3) for part in (fit.x, fit.y, fit.z))
    moved = f'turned by {signless(fit.yaw * DEGREES, 2)}° and shifted by ({shift}) m{how}'
    return f'{moved}; the paths are {fit.after:.3f} m apart so, {fit.before:.3f} m before'


def fault_words(faults: Faults) -> str:
    """Return what is wrong with a topic; empty where nothing is."""
    parts = []
    if faults.gap_count:
        longest = max(faults.gaps, key=lambda gap: gap.end - gap.begin)
        parts.append(
            f'{counted(faults.gap_count, "gap")}, {faults.missing:.2f} s in all, the longest '
            f'{longest.begin:.2f} to {longest.end:.2f} s'
        )
    if faults.same_stamp:
        again = f', {faults.repeated} of them byte for byte' if faults.repeated else ''
        parts.append(f'{counted(faults.same_stamp, "message")} at the time of another{again}')
    if faults.backwards_count:
        first = faults.backwards[0]
        parts.append(
            f'time runs backwards {counted(faults.backwards_count, "time")}, first from '
            f'{first.begin:.3f} to {first.end:.3f} s'
        )
    if faults.unknown:
        worst = max(faults.unknown.values())
        parts.append(
            f'{counted(len(faults.unknown), "channel")} without a number in up to '
            f'{100 * worst:.1f} % of the messages'
        )
    if not faults.rhythm:
        parts.append('no even rhythm, so gaps cannot be told')
    return '; '.join(parts)


def counted(count: int, word: str) -> str:
    """Return a count and its noun."""
    return f'{count} {word}{"" if count == 1 else "s"}'


def rate(faults: Faults) -> str:
    """Return the rate of a topic."""
    return MISSING if not faults.period else f'{1.0 / faults.period:.4g} Hz'
