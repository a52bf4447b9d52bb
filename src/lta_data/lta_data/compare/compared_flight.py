"""Represent one side of a comparison: its channels, and the facts and faults of its topics."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from hashlib import blake2b
from itertools import starmap, zip_longest
from operator import eq
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_data.bag.channels import iterate_channels, read_topics, SignalChannel
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.compare.sampling import Array, GAP
import numpy as np

RHYTHM: Final = 3.0  # largest quartile ratio of the periods of a regular topic
SLOWER: Final = 1.02  # ratio of two periods from which rates count as different
LISTED: Final = 50  # intervals that are stored; all are counted


class FaultInterval(NamedTuple):
    """An interval of time. [s]"""

    begin: float
    end: float


@final
@dataclass(frozen=True, slots=True)
class TopicFaults:
    """The faults of one topic of one flight."""

    count: int  # messages
    period: float | None  # median period; None for fewer than two messages [s]
    rhythm: bool  # whether messages come regularly enough to define a gap
    gaps: tuple[FaultInterval, ...]  # without a message for longer than 2.5 periods; the first 50
    missing: float  # total length of the gaps [s]
    gap_count: int  # number of gaps
    same_stamp: int  # messages with the time of an earlier one
    repeated: int  # of these, those with the same bytes as the previous message
    # Where time decreases: from the later time to the earlier one that follows; the first 50
    backwards: tuple[FaultInterval, ...]
    backwards_count: int  # number of decreases
    unknown: dict[str, float]  # share of non-finite values, by channel, if any

    @property
    def is_clean(self) -> bool:
        """Whether there is no fault."""
        count = self.gap_count + self.same_stamp + self.backwards_count
        return count == 0 and not self.unknown


def find_topic_faults(
    time: Array, unknown: dict[str, float] | None = None, repeated: int = 0, gap: float = GAP
) -> TopicFaults:
    """
    Find the faults in the times of a topic's messages.

    Parameters
    ----------
    time : ndarray, shape (n,)
        In the order of recording. [s]
    unknown : dict of str to float, optional
        Shares of unknown values by channel.
    repeated : int
        Messages that repeat the previous one byte for byte, at the same time.
    gap : float
        Length of a gap in periods.

    """
    steps = np.diff(time)
    falls = np.flatnonzero(steps < 0.0)
    # Sorted and without duplicates, so that these do not count as gaps as well
    instants = np.unique(time)
    rising = np.diff(instants)
    usual = float(np.median(rising)) if len(rising) else None
    # Quartiles ignore single gaps.
    short, long = np.percentile(rising, [25.0, 75.0]) if len(rising) else (1.0, 1.0)
    rhythm = bool(long <= RHYTHM * short)
    # Irregular topics, such as events, have no gaps.
    limit = gap * usual if usual is not None and rhythm else np.inf
    holes = np.flatnonzero(rising > limit)
    return TopicFaults(
        count=len(time),
        period=usual,
        rhythm=rhythm,
        gaps=tuple(
            FaultInterval(float(instants[k]), float(instants[k + 1])) for k in holes[:LISTED]
        ),
        missing=float(sum(rising[k] for k in holes)),
        gap_count=len(holes),
        # Messages beyond the first of each stamp
        same_stamp=len(time) - len(instants),
        repeated=repeated,
        backwards=tuple(FaultInterval(float(time[k]), float(time[k + 1])) for k in falls[:LISTED]),
        backwards_count=len(falls),
        unknown={name: share for name, share in (unknown or {}).items() if share > 0.0},
    )


@final
@dataclass(frozen=True, slots=True)
class ComparedTopic:
    """One topic of a flight."""

    name: str  # relative to the robot
    type_name: str
    frame: str  # `frame_id` of its first message; '' if it has none
    time: Array  # in the order of recording, since the start of the flight, shape (n,) [s]
    digest: str = ''  # hash of all its messages; '' if the raw bytes are not available
    repeated: int = 0  # messages that repeat the previous one at the same time


@final
@dataclass(frozen=True, slots=True)
class ComparedFlight:
    """A flight, ready to be compared."""

    label: str  # 'A' or 'B'
    # Its origin
    path: str
    robot: str
    start: int  # time 0 of its channels, on the clock of the stamps [ns]
    channels: Mapping[str, SignalChannel]  # by name
    topics: Mapping[str, ComparedTopic]  # by name, relative to the robot
    remarks: tuple[str, ...] = ()  # what could not be read
    provenance: Mapping[str, str] = field(default_factory=dict)  # as the recorder stored it
    # Yields the messages of a topic, equal bytes for equal values; none without a recording
    iterate_values: Callable[[str], Iterator[bytes]] = lambda _: iter(())

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of any topic. [s]"""
        times = [topic.time for topic in self.topics.values() if len(topic.time)]
        if not times:
            return 0.0, 0.0
        return min(float(t.min()) for t in times), max(float(t.max()) for t in times)


def read_compared_flight(
    flight: RecordedFlight,
    label: str,
    selection: Collection[str],
    tick: Callable[[], None] = lambda: None,
) -> ComparedFlight:
    """
    Read one side of a comparison from a recording of one robot.

    `label`: 'A' or 'B'. `selection`: topics to read, relative to the robot. `tick`: called once
    for the raw bytes, then once for each topic.
    """
    channels: dict[str, SignalChannel] = {}
    topics: dict[str, ComparedTopic] = {}
    remarks = []
    raw = read_raw_facts(flight, selection)
    tick()
    names = [topic for topic in flight.topics if topic in selection]
    read = read_topics(flight, names)
    for topic in names:
        try:
            own = {
                each.name: each for each in iterate_channels(flight, topic, read.pop(topic, None))
            }
        except BadInput as fault:
            remarks.append(f"Topic '{topic}' is left out: {fault}")
            own = {}
        channels |= own
        # All channels of a topic have the same times
        time = next((each.time for each in own.values()), np.empty(0))
        frame, digest, twice = raw.get(topic, ('', '', 0))
        topics[topic] = ComparedTopic(
            topic, flight.message_type(topic), frame, time, digest, twice
        )
        tick()
    remarks = [*flight.bag.losses, *remarks]  # some damage is detected only while reading
    where = str(flight.bag.path)
    return ComparedFlight(
        label,
        where,
        flight.robot,
        flight.start,
        channels,
        topics,
        tuple(remarks),
        flight.provenance,
        lambda topic: flight.bag.iterate_values(flight.absolute_name(topic)),
    )


def has_equal_messages(a: ComparedFlight, b: ComparedFlight, pair: tuple[str, str]) -> bool:
    """Return whether a topic of A and one of B have the same messages, each value to the bit."""
    one, two = a.topics[pair[0]], b.topics[pair[1]]
    if not one.digest or not two.digest:
        return False
    if one.digest == two.digest:
        return True
    # What the middleware leaves in the padding may differ
    return all(starmap(eq, zip_longest(a.iterate_values(pair[0]), b.iterate_values(pair[1]))))


def read_raw_facts(
    flight: RecordedFlight, selection: Collection[str]
) -> dict[str, tuple[str, str, int]]:
    """Return frame, digest and number of repeated messages of each topic, from the raw bytes."""
    prefix = f'/{flight.robot}/' if flight.robot else '/'
    names = [prefix + topic for topic in flight.topics if topic in selection]
    frames: dict[str, str] = {}
    digests = {name: blake2b(digest_size=16) for name in names}
    before: dict[str, tuple[int, bytes]] = {}
    twice = dict.fromkeys(names, 0)
    for name, log_time, data in flight.bag.iterate_messages(names):
        if name not in frames:
            frames[name] = read_frame_id(flight, name, data)
        # The length separates messages: 'ab' + 'c' must not hash like 'a' + 'bc'.
        digests[name].update(len(data).to_bytes(8, 'little'))
        digests[name].update(data)
        # Same log time too: constant data may legitimately repeat byte for byte
        twice[name] += before.get(name) == (log_time, data)
        before[name] = log_time, data
    return {
        name.removeprefix(prefix): (frames[name], digests[name].hexdigest(), twice[name])
        for name in names
        if name in frames
    }


def read_frame_id(flight: RecordedFlight, name: str, data: bytes) -> str:
    """Return the frame of a message without the robot's name; '' if it has none."""
    try:
        header = getattr(flight.bag.decode(name, data), 'header', None)
    except (BadInput, KeyError):
        return ''
    return str(getattr(header, 'frame_id', '')).removeprefix(f'{flight.robot}/')


def build_compared_flight(
    signals: Iterable[SignalChannel], label: str, start: int = 0, frame: str = ''
) -> ComparedFlight:
    """
    Build one side of a comparison from channels that come from no bag.

    `start` is time 0 of the channels on the clock of the stamps [ns]; all topics get `frame`.
    """
    by_name = {each.name: each for each in signals}
    topics: dict[str, ComparedTopic] = {}
    for each in by_name.values():
        topics.setdefault(each.topic, ComparedTopic(each.topic, '', frame, each.time))
    return ComparedFlight(label, label, '', start, by_name, topics)
