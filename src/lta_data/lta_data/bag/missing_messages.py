"""Estimate how many messages a damaged recording has lost, by topic."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from statistics import median
from typing import final, Literal, NamedTuple

from lta_config.topics import load_topic_table
from lta_data.bag.bag_folder import read_metadata
from lta_data.bag.mcap_file.channel_names import parse_topic_metadata
from lta_data.bag.mcap_file.contents import DamagedRegion, McapContents
from lta_data.bag.reader import Bag

Source = Literal['index', 'metadata', 'rhythm']
MOST_STEPS = 10_000  # steps per topic that the median uses
LONG_STEP = 1.5  # in median steps; a longer step contains missing messages


@final
@dataclass(frozen=True, slots=True)
class MissingMessages:
    """
    Lost messages of one topic.

    `source` is how they were counted: 'index' by an index that outlived its chunk or by the
    summary, 'metadata' by metadata.yaml, 'rhythm' by gaps in the topic's period (approximate).
    """

    count: int
    source: Source


class LossSpan(NamedTuple):
    """Log times between which something is lost; None at an end of the recording. [ns]"""

    start: int | None
    end: int | None


@final
class PeriodTracker:
    """Tracks the log times of a periodic topic."""

    def __init__(self) -> None:
        self._last: int | None = None
        self._steps: list[int] = []
        self._long: list[tuple[int, int]] = []

    def add_log_time(self, time: int) -> None:
        """Add the log time of a message. [ns]"""
        if self._last is not None and time > self._last:
            step = time - self._last
            if len(self._steps) < MOST_STEPS:
                self._steps.append(step)
            # Candidates only: the median, known at the end, decides in count_missing
            if step > LONG_STEP * min(self._steps[:100]):
                self._long.append((self._last, time))
        self._last = time

    def count_missing(self, spans: Iterable[LossSpan]) -> int:
        """Return about how many messages are missing in the given spans."""
        # Too few steps for a median.
        if len(self._steps) < 3:
            return 0
        usual = median(self._steps)
        holes = [(start, end) for start, end in self._long if end - start > LONG_STEP * usual]
        spans = list(spans)
        return sum(
            # A gap of n periods lacks n - 1 messages
            round((end - start) / usual) - 1
            for start, end in holes
            if any(spans_overlap(span, start, end) for span in spans)
        )


def spans_overlap(span: LossSpan, start: int, end: int) -> bool:
    """Return whether two time spans overlap. [ns]"""
    return (span.start is None or span.start <= end) and (span.end is None or span.end >= start)


def create_period_trackers(bag: Bag) -> dict[str, PeriodTracker]:
    """Return a tracker for each topic that is periodic according to the topic table."""
    steady = {
        name for name, topic in load_topic_table().topics.items() if topic.period is not None
    }
    return {
        name: PeriodTracker()
        for name in bag.topics
        # The table lists robot topics without the robot's namespace
        if name in steady or name.lstrip('/').partition('/')[2] in steady
    }


def list_loss_spans(bag: Bag) -> list[LossSpan]:
    """Return the spans of lost data, in order; adjacent spans are merged."""
    spans = [
        find_loss_span(part.contents, loss)
        for part in bag.parts
        for loss in sorted(part.contents.lost, key=lambda loss: loss.offset)
    ]
    joined: list[LossSpan] = []
    for span in spans:
        if joined and joined[-1].end is not None and joined[-1].end == span.start:
            span = LossSpan(joined.pop().start, span.end)
        joined.append(span)
    return joined


def find_loss_span(contents: McapContents, loss: DamagedRegion) -> LossSpan:
    """Return the span of lost data, from its own index or from its neighbours."""
    if loss.start is not None and loss.end is not None:
        return LossSpan(loss.start, loss.end)
    before = [place.end for place in contents.places if place.offset < loss.offset]
    after = [place.start for place in contents.places if place.offset > loss.offset]
    return LossSpan(before[-1] if before else None, after[0] if after else None)


def estimate_missing(
    bag: Bag, received: Counter[str], beats: dict[str, PeriodTracker]
) -> dict[str, MissingMessages]:
    """
    Return the lost messages by topic, as far as they can be determined.

    `bag`: a recording that has been read to its end. `received`: messages read by topic. `beats`:
    log times of periodic topics.
    """
    missing: dict[str, MissingMessages] = {}
    described = read_metadata(bag.path) if bag.path.is_dir() else {}
    declared = {entry.topic: entry.messages for entry in parse_topic_metadata(described)}
    indexed = count_indexed_losses(bag)
    lost = list_loss_spans(bag)
    for topic, topic_entry in bag.topics.items():
        # Index and summary count the same messages, so do not add them.
        counted = max(indexed[topic], topic_entry.count - received[topic])
        if counted > 0:
            missing[topic] = MissingMessages(counted, 'index')
        if (more := declared.get(topic, 0) - received[topic]) > counted:
            missing[topic] = MissingMessages(more, 'metadata')
        if topic not in missing and topic in beats and (holes := beats[topic].count_missing(lost)):
            missing[topic] = MissingMessages(holes, 'rhythm')
    return missing


def count_indexed_losses(bag: Bag) -> Counter[str]:
    """Return the messages in the indexes of lost chunks, by topic."""
    counts: Counter[str] = Counter()
    for part in bag.parts:
        for loss in part.contents.lost:
            for id, count in loss.counts.items():
                channel = part.contents.channels.get(id)
                if channel is not None:
                    counts[channel.topic] += count
    return counts
