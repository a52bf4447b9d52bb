"""Represent one side of a comparison: its channels, and the facts of its topics."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from hashlib import blake2b
from itertools import starmap, zip_longest
from operator import eq
from typing import final

from lta_config.errors import BadInput
from lta_data.bag.channels import iterate_channels, read_topics, SignalChannel
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.compare.sampling import Array
import numpy as np


@final
@dataclass(frozen=True, slots=True)
class ComparedTopic:
    """One topic of a flight."""

    name: str  # relative to the robot
    type_name: str
    frame: str  # `frame_id` of its first message; '' if it has none
    time: Array  # in the order of recording, since the start of the flight, shape (n,) [s]
    digest: str = ''  # hash of all its messages; '' if the raw bytes are not available


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
        frame, digest = raw.get(topic, ('', ''))
        topics[topic] = ComparedTopic(topic, flight.message_type(topic), frame, time, digest)
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
) -> dict[str, tuple[str, str]]:
    """Return frame and digest of each topic, from the raw bytes."""
    prefix = f'/{flight.robot}/' if flight.robot else '/'
    names = [prefix + topic for topic in flight.topics if topic in selection]
    frames: dict[str, str] = {}
    digests = {name: blake2b(digest_size=16) for name in names}
    for name, _, data in flight.bag.iterate_messages(names):
        if name not in frames:
            frames[name] = read_frame_id(flight, name, data)
        # The length separates messages: 'ab' + 'c' must not hash like 'a' + 'bc'.
        digests[name].update(len(data).to_bytes(8, 'little'))
        digests[name].update(data)
    return {
        name.removeprefix(prefix): (frames[name], digests[name].hexdigest())
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
