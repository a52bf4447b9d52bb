"""One of the two flights: its channels on its own clock, and what is known of each topic."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import final

from lta_config.errors import BadInput
from lta_data.bag.channels import iterate_channels, read_topics, SignalChannel
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.compare.sampling import Array
import numpy as np


@final
@dataclass(frozen=True, slots=True)
class ComparedTopic:
    """
    One topic of a flight.

    Attributes
    ----------
    name, type_name : str
        Relative to the robot; the message type.
    frame : str
        `frame_id` of its first message; '' where it has none.
    time : ndarray, shape (n,)
        In the order of recording, since the start of the flight. [s]
    digest : str
        Of all its messages, byte for byte; '' where they are not at hand.
    repeated : int
        Messages that are the one before once more, at the same time.

    """

    name: str
    type_name: str
    frame: str
    time: Array
    digest: str = ''
    repeated: int = 0


@final
@dataclass(frozen=True, slots=True)
class ComparedFlight:
    """
    A flight, ready to be compared.

    Attributes
    ----------
    label : str
        'A' or 'B'.
    path, robot : str
        Where it comes from.
    start : int
        Time 0 of its channels, on the clock of its stamps. [ns]
    channels : dict of str to Channel
        By name.
    topics : dict of str to Recorded
        By name, relative to the robot.
    remarks : tuple of str
        What could not be read.
    provenance : dict of str to str
        What the recorder was told.

    """

    label: str
    path: str
    robot: str
    start: int
    channels: Mapping[str, SignalChannel]
    topics: Mapping[str, ComparedTopic]
    remarks: tuple[str, ...] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)

    @property
    def span(self) -> tuple[float, float]:
        """First and last instant of any channel. [s]"""
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
    Return a recorded flight as a side.

    Parameters
    ----------
    flight : Flight
        The recording of one robot.
    label : str
        'A' or 'B'.
    wanted : collection of str
        Topics to read, relative to the robot.
    tick : callable
        Called once for each topic, and once for all their raw bytes.

    """
    found: dict[str, SignalChannel] = {}
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
        found |= own
        time = next((each.time for each in own.values()), np.empty(0))
        frame, digest, twice = raw.get(topic, ('', '', 0))
        topics[topic] = ComparedTopic(
            topic, flight.message_type(topic), frame, time, digest, twice
        )
        tick()
    remarks = [*flight.bag.losses, *remarks]  # some damage shows only where it is read
    where = str(flight.bag.path)
    return ComparedFlight(
        label, where, flight.robot, flight.start, found, topics, tuple(remarks), flight.provenance
    )


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
            frames[name] = read_frame(flight, name, data)
        digests[name].update(len(data).to_bytes(8, 'little'))
        digests[name].update(data)
        twice[name] += before.get(name) == (log_time, data)
        before[name] = log_time, data
    return {
        name.removeprefix(prefix): (frames[name], digests[name].hexdigest(), twice[name])
        for name in names
        if name in frames
    }


def read_frame(flight: RecordedFlight, name: str, data: bytes) -> str:
    """Return the frame of a message; '' where it has none or cannot be read."""
    try:
        header = getattr(flight.bag.decode(name, data), 'header', None)
    except (BadInput, KeyError):
        return ''
    return str(getattr(header, 'frame_id', ''))


def build_compared_flight(
    signals: Iterable[SignalChannel], label: str, start: int = 0, frame: str = ''
) -> ComparedFlight:
    """
    Return channels that come from no bag as a side.

    Parameters
    ----------
    found : iterable of Channel
        Whatever there is.
    label : str
        'A' or 'B'.
    start : int
        Time 0 of the channels on the clock of the stamps. [ns]
    frame : str
        Of all topics.

    """
    by_name = {each.name: each for each in signals}
    topics: dict[str, ComparedTopic] = {}
    for each in by_name.values():
        topics.setdefault(each.topic, ComparedTopic(each.topic, '', frame, each.time))
    return ComparedFlight(label, label, '', start, by_name, topics)
