"""Say what the checks judged of a recording, and what they could not, topic by topic."""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits, roles
from lta_data.data_quality.checks.repeated_values import is_constant
from lta_data.data_quality.checks.stamps import is_regular
from lta_data.data_quality.checks.units import SIZES
from lta_data.data_quality.finding import QualityFinding, Severity
from lta_data.data_quality.recording import CheckContext
from lta_data.data_quality.roles import COUNTS, RANGES, SPREAD
from lta_data.data_quality.smoothing import find_coarse_unit
import numpy as np

KIND: Final = 'missing'
POSE: Final = ('position', 'attitude')  # that a model of a vehicle needs
SENSED: Final = ('rates', 'force')
RULES: Final = (*(one.names for one in RANGES), *(one.names for one in SIZES), COUNTS, SPREAD)
MOVING: Final = ('position', 'attitude', 'velocity', 'rates', 'force')
WORDS: Final = {'turning': 'rates', 'force': 'acceleration'}


@final
class Coverage(NamedTuple):
    """What was judged and what was not, a sentence each, and what was never measured."""

    judged: tuple[str, ...]
    unjudged: tuple[str, ...]
    missing: tuple[QualityFinding, ...]


def describe_coverage(evidence: CheckContext) -> Coverage:
    """Return what the checks of a recording judged."""
    by_topic: dict[str, list[SignalChannel]] = {}
    for channel in evidence.recording.channels.values():
        by_topic.setdefault(channel.topic, []).append(channel)
    sentences: list[str] = []
    unjudged: list[str] = []
    missing: list[QualityFinding] = []
    ruleless: list[str] = []
    least = limits.LEAST_SAMPLES
    for topic, channels in by_topic.items():
        count = len(channels[0].time)
        if count < least:
            unjudged.append(f"'{topic}' is too short: {count} messages, and {least} are needed.")
            continue
        one = _describe_topic(topic, channels)
        sentences += one.judged
        unjudged += one.unjudged
        missing += one.missing
        ruleless += [] if one.judged else [topic]
    if ruleless:
        unjudged.append(f'No rule is there for the numbers of {", ".join(map(repr, ruleless))}.')
    if not by_topic:
        unjudged.append('It has no message whose numbers can be read.')
    placed = any(pose.position is not None for pose in evidence.poses)
    if placed and all(pose.attitude is None for pose in evidence.poses):
        unjudged.append('It has no attitude: frames, axes and rates are not judged.')
    return Coverage(tuple(sentences), tuple(unjudged), tuple(missing))


def _describe_topic(topic: str, channels: Sequence[SignalChannel]) -> Coverage:
    """Return what was judged of a topic with enough messages."""
    measured: dict[str, bool] = {}
    for channel in channels:
        quantity = roles.match_noisy_quantity(channel)
        if roles.QUATERNION.match(channel.field) or roles.ANGLE.match(channel.field):
            quantity = 'attitude'
        # An estimate may be constant or smooth, but it cannot jump
        quantity = 'position' if roles.POSITION.match(channel.field) else quantity
        if quantity is None and any(rule.search(channel.name) for rule in RULES):
            quantity = 'range of values'
        if quantity is not None:
            finite = bool(np.isfinite(channel.values).any())
            measured[quantity] = measured.get(quantity, False) or finite
    there = [WORDS.get(name, name) for name, is_there in measured.items() if is_there]
    expected = SENSED if 'force' in measured else POSE if 'position' in measured else ()
    absent = [name for name in expected if name in measured and not measured[name]]
    time = channels[0].time
    missing = tuple(
        QualityFinding(
            KIND, topic, float(time[0]), float(time[-1]),
            f'The {WORDS.get(name, name)} was never measured: none of the {len(time)} messages '
            'has a number for it, so nothing that needs it is judged.',
            Severity.NOTE,
        )
        for name in absent
    )  # fmt: skip
    if not there:
        return Coverage((), (), missing)
    unjudged = []
    if not is_regular(time):
        unjudged.append(f"The stamps of '{topic}' are irregular: lost messages cannot be counted.")
    span = float(np.ptp(time))
    if span < limits.PAIR_TIME and any(name in measured for name in MOVING):
        unjudged.append(
            f"'{topic}' is too short to compare motions (units, axes, clocks): {span:.1f} s, and "
            f'{limits.PAIR_TIME:g} s are needed.'
        )
    coarse = [
        f'{channel.field.rpartition(".")[2]} to {unit:.2g} {channel.unit}'.rstrip()
        for channel in channels
        if roles.match_noisy_quantity(channel)
        and (unit := find_coarse_unit(channel.values))
        and not is_constant(channel)
    ]
    if coarse:
        unjudged.append(
            f"'{topic}' is rounded ({', '.join(coarse)}), which hides its noise: equal, extreme "
            'and repeated values of these are not judged.'
        )
    text = f"{', '.join(there)} of '{topic}' ({len(time)} messages)"
    return Coverage((text,), tuple(unjudged), missing)
