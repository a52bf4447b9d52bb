# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare two flights: request, result and procedure."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from hashlib import blake2b
from itertools import starmap, zip_longest
from operator import eq
from typing import Final, final

from lta_config.errors import BadInput
from lta_data.bag.channels import read_flight
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.compare.channel_comparison import (
    ChannelComparison,
    ChannelPair,
    compare_channels,
    find_channel_tolerances,
    pair_channels,
    select_topic_pairs,
    TopicPair,
)
from lta_data.compare.frame_alignment import align_frames, FrameAlignment, Frames
from lta_data.compare.sampling import Array
from lta_data.compare.time_alignment import Align, align_times, TimeAlignment
from lta_data.flight import Flight
from lta_data.scene import describe_exceeded_region_of_bag
import numpy as np

# Rank of the verdicts in tables, largest difference first
ORDER: Final = {'parted': 0, 'apart at times': 1, 'together': 2, 'identical': 3, 'unknown': 4}


@final
@dataclass(frozen=True, slots=True)
class ComparisonRequest:
    """Options of a comparison; see `lta compare --help`."""

    pairs: tuple[str, ...] = ()
    topics: tuple[str, ...] = ()
    align: Align = 'auto'
    offset: float | None = None  # s
    frames: Frames = 'auto'
    tolerances: Mapping[str, float] = field(default_factory=dict)


@final
@dataclass(frozen=True, slots=True)
class ComparisonResult:
    """Result of a comparison."""

    request: ComparisonRequest
    a: Flight
    b: Flight
    timing: TimeAlignment  # how B's time was mapped to A's
    frames: tuple[FrameAlignment, ...]  # what was done about each pair of world frames
    span: tuple[float, float]  # common time on A's clock [s]
    channels: tuple[ChannelComparison, ...]  # those that diverge most and earliest first
    # Topics missing in the other flight
    only_a: tuple[str, ...]
    only_b: tuple[str, ...]
    # Compared topics: B's by A's.
    topics: Mapping[str, str]
    # Topics whose messages have equal values to the bit; without messages, whose channels have
    identical_topics: tuple[str, ...]
    remarks: tuple[str, ...]  # further remarks for the user

    @property
    def is_identical(self) -> bool:
        """Whether topics, times, values and whole messages are all equal."""
        whole = not (self.only_a or self.only_b or self.request.pairs)
        same = all(each.verdict == 'identical' for each in self.channels)
        return whole and same and len(self.identical_topics) == len(self.topics)

    @property
    def is_within_bands(self) -> bool:
        """Whether no channel leaves its band for longer than a moment."""
        return all(each.verdict not in ('parted', 'apart at times') for each in self.channels)

    @property
    def verdict(self) -> str:
        """'identical', 'same' or 'different'."""
        return (
            'identical' if self.is_identical else 'same' if self.is_within_bands else 'different'
        )


Told = Callable[[str], None]


def compare_flights(
    one: RecordedFlight,
    other: RecordedFlight,
    request: ComparisonRequest,
    tick: Told = lambda _: None,
) -> ComparisonResult:
    """
    Compare two recorded flights.

    `tick` is called with the current step; see `count_ticks`.

    Raise `BadInput` if they have no channel or no time in common, or a requested item is missing.
    """
    topic_pairs = select_topic_pairs(request.pairs, request.topics, one.topics, other.topics)
    of_a, of_b = ({each[k] for each in topic_pairs} for k in (0, 1))
    a = read_flight(one, of_a, tick=lambda: tick('reading A'))
    # Two topics of one bag: read it only once.
    if of_a == of_b and (one.bag.path, one.robot) == (other.bag.path, other.robot):
        b = a
    else:
        b = read_flight(other, of_b, tick=lambda: tick('reading B'))
    comparison = compare_sides(a, b, topic_pairs, request, tick)
    identical = find_identical_topics(one, other, comparison.topics)
    comparison = replace(comparison, identical_topics=identical)
    outside = [describe_exceeded_region_of_bag(flight) for flight in (one, other)]
    remarks = [f'{label}: {text}' for label, text in zip('AB', outside, strict=True) if text]
    comparison = replace(comparison, remarks=(*comparison.remarks, *remarks))
    # Topics that were not requested are not missing
    if request.pairs or request.topics:
        return comparison
    return replace(
        comparison,
        only_a=tuple(sorted(set(one.topics) - set(other.topics))),
        only_b=tuple(sorted(set(other.topics) - set(one.topics))),
    )


def find_identical_topics(
    one: RecordedFlight, other: RecordedFlight, topics: Mapping[str, str]
) -> tuple[str, ...]:
    """Return the topics of A whose messages have the values of B's, each to the bit."""
    of_a = hash_messages(one, topics)
    # Two topics of one bag, or a bag with itself: read it only once
    is_same = (one.bag.path, one.robot) == (other.bag.path, other.robot)
    is_read = is_same and of_a.keys() >= {*topics.values()}
    of_b = of_a if is_read else hash_messages(other, topics.values())
    return tuple(
        a for a, b in topics.items()
        # What the middleware leaves in the padding may differ
        if of_a[a] == of_b[b] or all(starmap(eq, zip_longest(
            one.bag.iterate_values(one.absolute_name(a)),
            other.bag.iterate_values(other.absolute_name(b)),
        )))
    )  # fmt: skip


def hash_messages(flight: RecordedFlight, topics: Collection[str]) -> dict[str, bytes]:
    """Return a hash of the bytes of all messages of each topic, in one pass over the bag."""
    hashes = {flight.absolute_name(topic): blake2b(digest_size=16) for topic in topics}
    for name, _, data in flight.bag.iterate_messages([*hashes]):
        # The length separates messages: 'ab' + 'c' must not hash like 'a' + 'bc'
        hashes[name].update(len(data).to_bytes(8, 'little'))
        hashes[name].update(data)
    return {topic: hashes[flight.absolute_name(topic)].digest() for topic in topics}


def count_ticks(one: RecordedFlight, other: RecordedFlight, request: ComparisonRequest) -> int:
    """Return about how often `compare_flights` calls its tick."""
    topic_pairs = select_topic_pairs(request.pairs, request.topics, one.topics, other.topics)
    return 4 * len(topic_pairs) + 4


def compare_sides(
    a: Flight,
    b: Flight,
    topic_pairs: Sequence[TopicPair],
    request: ComparisonRequest,
    tick: Told = lambda _: None,
) -> ComparisonResult:
    """Compare two flights that may come from no bag; see `compare_flights`."""
    matched, remarks = pair_channels(topic_pairs, a.channels, b.channels)
    tick('aligning')
    when = align_times(a, b, matched, request.align, request.offset)
    # Clocks first: a time offset of a moving vehicle looks like a shift of the frame
    on_one_clock = [
        each._replace(b=replace(each.b, time=when.convert_to_a_time(each.b.time)))
        for each in matched
    ]
    pairs, frames = align_frames(on_one_clock, a.types, when.how, request.frames)
    span = find_common_time_span(pairs)
    tick('aligning')
    channels = compare_pairs(pairs, request, when, tick)
    topics = {each.topic_a: each.topic_b for each in topic_pairs}
    return ComparisonResult(
        request=request,
        a=a,
        b=b,
        timing=when,
        frames=tuple(frames),
        span=span,
        channels=channels,
        only_a=(),
        only_b=(),
        topics=topics,
        identical_topics=tuple(
            topic for topic in topics
            if all(each.verdict == 'identical' for each in channels
                   if each.name.rpartition('/')[0] == topic)
        ),
        remarks=(
            *(f'A: {text}' for text in a.losses), *(f'B: {text}' for text in b.losses),
            *remarks, *when.remarks,
        ),
    )  # fmt: skip


def compare_pairs(
    pairs: Sequence[ChannelPair], request: ComparisonRequest, when: TimeAlignment, tick: Told
) -> tuple[ChannelComparison, ...]:
    """Compare all pairs; those that diverge most and earliest come first."""
    bands = find_channel_tolerances(request.tolerances, [pair.name for pair in pairs])
    compared = []
    topic = ''
    for pair in pairs:
        if pair.a.topic != topic:
            topic = pair.a.topic
            tick('comparing')
        if not (np.isfinite(pair.a.values).any() or np.isfinite(pair.b.values).any()):
            continue  # never measured, in neither flight
        compared.append(compare_channels(pair, tolerance=bands.get(pair.name), doubt=when.sigma))
    return tuple(sorted(compared, key=lambda each: (ORDER[each.verdict], -each.score, each.name)))


def find_common_time_span(pairs: Sequence[ChannelPair]) -> tuple[float, float]:
    """Return the time that both flights cover, on A's clock; raise `BadInput` if none [s]."""
    ends = [
        find_time_extent([pair.a.time for pair in pairs]),
        find_time_extent([pair.b.time for pair in pairs]),
    ]
    begin, end = max(first for first, _ in ends), min(last for _, last in ends)
    if begin >= end:
        raise BadInput(
            f'The flights do not overlap in time: A covers {ends[0][0]:.2f} to {ends[0][1]:.2f} '
            f"s, B {ends[1][0]:.2f} to {ends[1][1]:.2f} s on A's clock; give another --offset, or "
            'use --align motion.'
        )
    return begin, end


def find_time_extent(times: Sequence[Array]) -> tuple[float, float]:
    """Return the first and last of all times; raise `BadInput` if there are none [s]."""
    non_empty = [time for time in times if len(time)]
    if not non_empty:
        raise BadInput(
            'One of the flights has no message on the compared topics; choose other topics.'
        )
    return min(float(time.min()) for time in non_empty), max(
        float(time.max()) for time in non_empty
    )
