# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Pair the channels of A and B, and compare each: size and time of the difference."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_data.compare.clock_offset import can_be_prepared
from lta_data.compare.coarse_lag import CoarseLag, estimate_coarse_lag, SharedQuantity
from lta_data.compare.divergence import (
    DifferenceMeasures,
    Divergence,
    find_divergence,
    measure_difference,
    noise_band,
    standard_deviation,
)
from lta_data.compare.sampling import (
    align_signals,
    AlignedSignals,
)
from lta_data.even_grid import median_period, SampledSignal, sort_samples
from lta_data.flight import Channel
import numpy as np

AS: Final = '--pair odom=ground_truth/odom'
LONGEST_CHANNEL_LAG: Final = 5.0  # of a channel behind its pair [s]


class TopicPair(NamedTuple):
    """Two topics to compare, and the field of each if only one channel is meant."""

    topic_a: str
    topic_b: str
    field_a: str = ''
    field_b: str = ''


class ChannelPair(NamedTuple):
    """One quantity of both flights, each in the order of its times; `name` is A's."""

    name: str
    a: Channel
    b: Channel

    @property
    def angular(self) -> bool:
        """Whether values 2 pi apart are equal."""
        return self.a.angular and self.b.angular

    @property
    def signals(self) -> tuple[SampledSignal, SampledSignal]:
        """Return the samples of A and B."""
        return SampledSignal(self.a.time, self.a.values), SampledSignal(self.b.time, self.b.values)

    @property
    def frames(self) -> tuple[str, str]:
        """Return the frames of both; '' if unknown."""
        return self.a.frame, self.b.frame


def select_topic_pairs(
    pair_texts: Sequence[str], only: Collection[str], of_a: Sequence[str], of_b: Sequence[str]
) -> list[TopicPair]:
    """
    Return the topics to compare.

    `pair_texts`: 'odom=ground_truth/odom', of topics or of channels; empty for all of the same
    name. `only`: topics of A to keep; empty for all. Raise `BadInput` if a pair is malformed, a
    topic is missing, or there is none in common.
    """
    if pair_texts:
        pairs = [parse_pair(text, of_a, of_b) for text in pair_texts]
    else:
        pairs = [TopicPair(topic, topic) for topic in of_a if topic in set(of_b)]
        if not pairs:
            raise BadInput(
                f'The flights have no topic in common (A: {", ".join(of_a) or "none"}; B: '
                f'{", ".join(of_b) or "none"}); name the topics to compare, as in {AS}.'
            )
    for name in only:
        if name not in {each.topic_a for each in pairs}:
            common = ', '.join(sorted({each.topic_a for each in pairs}))
            raise BadInput(
                f"Topic '{name}' is not among the compared topics; choose from: {common}."
            )
    return [each for each in pairs if not only or each.topic_a in only]


def parse_pair(text: str, of_a: Sequence[str], of_b: Sequence[str]) -> TopicPair:
    """Parse two topics or channels from the form 'a=b'."""
    first, equals, second = text.partition('=')
    if not equals or not first or not second:
        raise BadInput(
            f"Invalid pair '{text}'; write a topic of A, '=' and a topic of B, as in {AS}."
        )
    topic_a, field_a = split_channel_name(first, of_a, 'A')
    topic_b, field_b = split_channel_name(second, of_b, 'B')
    if bool(field_a) != bool(field_b):
        raise BadInput(f"'{text}' pairs a topic with a channel; give two topics or two channels.")
    return TopicPair(topic_a, topic_b, field_a, field_b)


def split_channel_name(name: str, topics: Sequence[str], label: str) -> tuple[str, str]:
    """Return topic and field of a name; the field is '' if the name is a topic."""
    # The robot's topics are listed without a leading slash; accept one
    name = name.removeprefix('/') if name not in topics else name
    if name in topics:
        return name, ''
    topic, _, field = name.rpartition('/')
    if topic in topics:
        return topic, field
    names = ', '.join(topics) or 'none'
    raise BadInput(f"Flight {label} has no topic or channel '{name}'; its topics: {names}.")


class PairingResult(NamedTuple):
    """The pairs, and a remark for each that cannot be compared."""

    pairs: list[ChannelPair]
    remarks: list[str]


def pair_channels(
    topic_pairs: Sequence[TopicPair],
    a: Mapping[str, Channel],
    b: Mapping[str, Channel],
) -> PairingResult:
    """
    Return the pairs of corresponding channels.

    Fields correspond if they are equal or one ends with the other: `pose.position.x` of a
    PoseStamped is `pose.pose.position.x` of an Odometry.

    Raise `BadInput` if a requested channel is missing, or there is none in common.
    """
    pairing = PairingResult([], [])
    for each in topic_pairs:
        fields_a = [channel.field for channel in a.values() if channel.topic == each.topic_a]
        fields_b = [channel.field for channel in b.values() if channel.topic == each.topic_b]
        for field_a, field_b in match_fields(each, fields_a, fields_b):
            name = f'{each.topic_a}/{field_a}'
            one, other = a[name], b[f'{each.topic_b}/{field_b}']
            # An unknown unit counts as equal.
            if one.unit and other.unit and one.unit != other.unit:
                pairing.remarks.append(
                    f"Channel '{name}' is not compared: its unit is {one.unit} in A, but "
                    f'{other.unit} in B.'
                )
            else:
                pairing.pairs.append(ChannelPair(name, sort_channel(one), sort_channel(other)))
    if not pairing.pairs:
        raise BadInput(
            f'The flights have no channel in common; name the topics to compare, as in {AS}.'
        )
    return pairing


def sort_channel(channel: Channel) -> Channel:
    """Return a channel in the order of its times, with NaN for all non-finite values."""
    time, values = sort_samples(channel.time, channel.values)
    return replace(channel, time=time, values=values)


def match_fields(
    topic_pair: TopicPair, of_a: Sequence[str], of_b: Sequence[str]
) -> list[tuple[str, str]]:
    """Return the corresponding fields of two topics."""
    if topic_pair.field_a:
        for topic, field, fields in (
            (topic_pair.topic_a, topic_pair.field_a, of_a),
            (topic_pair.topic_b, topic_pair.field_b, of_b),
        ):
            if field not in fields:
                names = ', '.join(fields)
                raise BadInput(f"Topic '{topic}' has no channel '{field}'; it has: {names}.")
        return [(topic_pair.field_a, topic_pair.field_b)]
    pairs = []
    for field in of_a:
        if field in of_b:
            pairs.append((field, field))
            continue
        ending = [
            # Such as position.x of a Pose and pose.pose.position.x of an Odometry
            other
            for other in of_b
            if other.endswith(f'.{field}') or field.endswith(f'.{other}')
        ]
        # Ambiguous endings are not paired.
        if len(ending) == 1 and ending[0] not in of_a:
            pairs.append((field, ending[0]))
    return pairs


STRAY: Final = 0.01  # share of samples that noise alone may put outside the band


@final
@dataclass(frozen=True, slots=True)
class ChannelComparison:
    """One channel of both flights."""

    # The channel's name in A and in B
    name: str
    other: str
    unit: str  # unit of the values
    angular: bool  # whether values 2 pi apart are equal
    # 'parted': outside the band to the end. 'apart at times': outside it for longer than a moment,
    # or at more than 1 % of the samples. 'together'. 'identical': all times and values are equal.
    # 'unknown': no common valid sample
    verdict: str
    # Both as recorded, on A's time, B in A's frame
    a: SampledSignal
    b: SampledSignal
    both: AlignedSignals  # both at the same times
    periods: tuple[float, float]  # median periods of A and B [s]
    measures: DifferenceMeasures | None  # None if there is no common valid sample
    parting: Divergence  # when they differ
    lag: CoarseLag | None  # of B behind A; None if their changes do not correlate
    # Rank of the divergence: RMS over the larger of both spreads and the band, times the share of
    # the common span during which they differ.
    score: float

    @property
    def both_constant(self) -> bool:
        """Whether both sides are constant."""
        return all(
            not np.isfinite(line.values).any() or np.nanmax(line.values) == np.nanmin(line.values)
            for line in (self.a, self.b)
        )


def compare_channels(
    pair: ChannelPair, *, tolerance: float | None = None, doubt: float = 0.0
) -> ChannelComparison:
    """
    Compare two channels that are both on A's time.

    `tolerance` replaces the noise band [unit of the channel]; `doubt` is the standard deviation
    of the clock offset [s].
    """
    angular = pair.angular
    a, b = pair.signals
    quantity = SharedQuantity(pair.name, a, b, angular)
    both = align_signals(a, b, angular=angular)
    measures = measure_difference(both, angular=angular)
    by_hand = tolerance is not None
    band = noise_band(both, angular=angular, doubt=doubt) if tolerance is None else tolerance
    when = find_divergence(both, band, by_hand=by_hand)
    same = np.array_equal(a.time, b.time) and np.array_equal(a.values, b.values, equal_nan=True)
    return ChannelComparison(
        name=pair.name,
        other=pair.b.name,
        unit=pair.a.unit or pair.b.unit,
        angular=angular,
        verdict='identical' if same and len(a.time) else classify_difference(measures, when),
        a=a,
        b=b,
        both=both,
        periods=(median_period(a.time), median_period(b.time)),
        measures=measures,
        parting=when,
        lag=estimate_coarse_lag([quantity], LONGEST_CHANNEL_LAG)
        if can_be_prepared(quantity)
        else None,
        score=0.0 if measures is None else score_difference(both, measures, when, angular),
    )


def classify_difference(difference: DifferenceMeasures | None, when: Divergence) -> str:
    """Return the verdict on a channel that is not identical."""
    if difference is None:
        return 'unknown'
    if when.at is not None:
        return 'parted'
    strayed = when.outside > (0.0 if when.given else STRAY)
    return 'apart at times' if strayed or when.first is not None else 'together'


def score_difference(
    both: AlignedSignals, difference: DifferenceMeasures, when: Divergence, angular: bool
) -> float:
    """Return the rank of a divergence by its size and duration [1]."""
    valid = both.both_valid
    spread = max(standard_deviation(part[valid], angular) for part in (both.a, both.b))
    # The band limits the score of a nearly constant channel.
    scale = max(spread, when.band)
    size = difference.rms / scale if scale > 0.0 else float(difference.rms > 0.0)
    if when.at is None:
        return size * when.outside
    time = both.time[valid]
    length = float(time[-1] - time[0])
    # The earlier the divergence, the larger the share of the span.
    return size * (float(time[-1]) - when.at) / length if length > 0.0 else size


def find_channel_tolerances(texts: Mapping[str, float], names: list[str]) -> dict[str, float]:
    """
    Return the tolerance of each channel that has one.

    The keys of `texts` are names or patterns such as 'odom/*position*'; the first match applies.

    Raise `BadInput` if a name or pattern matches no channel.
    """
    tolerances: dict[str, float] = {}
    for pattern, value in texts.items():
        fitting = [name for name in names if name == pattern or fnmatchcase(name, pattern)]
        if not fitting:
            raise BadInput(
                f"--tolerance: no channel of both flights matches '{pattern}'; run without "
                '--tolerance to list the channels.'
            )
        for name in fitting:
            tolerances.setdefault(name, value)
    return tolerances
