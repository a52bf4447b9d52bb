"""
A recording on the disk: what is in it, and its messages one after the other.

Opens finished bags by their summary, and unfinished or damaged ones by what is whole in them.
Memory stays within one chunk whatever the size of the bag.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

from lta_analysis.bag.chunks import Damaged, messages, RECORD, unpacked
from lta_analysis.bag.contents import Contents, read_at
from lta_analysis.bag.decoder import Decoder
from lta_analysis.bag.folder import ADVICE, bag_files, described_provenance
from lta_analysis.bag.scan import damage, scan
from lta_analysis.bag.summary import read_summary
from lta_bridge.bag.records import MAGIC
from lta_config.errors import BadInput, unknown
from mcap.records import Channel, Schema


@final
@dataclass(frozen=True, slots=True)
class Topic:
    """One recorded topic: absolute name, message type, number of messages."""

    name: str
    type_name: str
    count: int


@final
class Bag:
    """
    An opened recording; see `read_bag`.

    Attributes
    ----------
    path : Path
        What was opened.
    topics : dict of str to Topic
        The recorded topics by absolute name.
    provenance : dict of str to str
        Where the data come from, as the recorder was told.
    start, end : int or None
        First and last log time; None without messages. [ns]
    size : int
        Size of the MCAP files. [bytes]
    losses : list of str
        What is missing, one sentence each; grows if reading meets damage.

    """

    def __init__(self, path: Path, parts: list[tuple[Path, Contents]]) -> None:
        self.path = path
        self._parts = parts
        self.size = sum(file.stat().st_size for file, _ in parts)
        self.losses = [loss for _, contents in parts for loss in contents.losses]
        self.provenance = described_provenance(path) if path.is_dir() else {}
        for _, contents in parts:
            self.provenance |= contents.provenance
        self.start = min((c.start for _, c in parts if c.start is not None), default=None)
        self.end = max((c.end for _, c in parts if c.end is not None), default=None)
        self._schemas: dict[str, Schema] = {}
        self.topics: dict[str, Topic] = {}
        for _, contents in parts:
            self._add_topics(contents)
        self._decoder = Decoder(self._schemas)

    @property
    def complete(self) -> bool:
        """Whether the recording was finished and nothing in it is known to be missing."""
        return not self.losses

    def messages(self, topics: Collection[str] | None = None) -> Iterator[tuple[str, int, bytes]]:
        """
        Yield topic, log time in ns and CDR bytes in the order of recording.

        Parameters
        ----------
        topics : collection of str, optional
            Absolute names; all topics if None.

        Raises
        ------
        BadInput
            If a topic is not in the bag.

        """
        wanted = set(self.topics if topics is None else topics)
        for name in sorted(wanted - set(self.topics)):
            raise unknown('topic', name, list(self.topics))
        for file, contents in self._parts:
            yield from self._part_messages(file, contents, wanted)

    def decode(self, topic: str, data: bytes) -> object:
        """Return a message of a topic as an object; `BadInput` if it cannot be read."""
        return self._decoder.decode(self.topics[topic].type_name, data)

    def fields(self, type_name: str) -> list[tuple[str, Any]]:
        """Return the fields of a type of messages in the bag; see `Decoder.fields`."""
        return self._decoder.fields(type_name)

    def _add_topics(self, contents: Contents) -> None:
        """Take note of the topics of one file."""
        for channel in contents.channels.values():
            schema = contents.schemas.get(channel.schema_id)
            type_name = type_of(contents, channel)
            known = self.topics.get(channel.topic)
            if known is not None and known.type_name != type_name:
                self.losses.append(
                    f"Topic '{channel.topic}' has messages of type '{known.type_name}' and of "
                    f"'{type_name}'; the latter are left out."
                )
                continue
            if schema is not None:
                self._schemas.setdefault(type_name, schema)
            count = contents.counts[channel.id] + (0 if known is None else known.count)
            self.topics[channel.topic] = Topic(channel.topic, type_name, count)

    def _part_messages(
        self, file: Path, contents: Contents, wanted: set[str]
    ) -> Iterator[tuple[str, int, bytes]]:
        """Yield the messages of one file."""
        names = {
            id: channel.topic
            for id, channel in contents.channels.items()
            if channel.topic in wanted
            and self.topics[channel.topic].type_name == type_of(contents, channel)
        }
        channels = frozenset(names)
        with file.open('rb') as stream:
            for place in contents.places:
                if place.channels is not None and not channels & place.channels:
                    continue
                try:
                    data = read_at(stream, place.offset, place.length)
                    data = unpacked(data[RECORD.size :]) if place.packed else data
                    for channel, log_time, message in messages(data, channels):
                        yield names[channel], log_time, message
                except Damaged:
                    self._note(damage(place.offset, place.length))

    def _note(self, loss: str) -> None:
        """Remember a loss once, however often it is met."""
        if loss not in self.losses:
            self.losses.append(loss)


def type_of(contents: Contents, channel: Channel) -> str:
    """Return the message type of a channel; empty where the file does not say."""
    schema = contents.schemas.get(channel.schema_id)
    return '' if schema is None else schema.name


def read_bag(path: Path | str) -> Bag:
    """
    Open a recording.

    Parameters
    ----------
    path : Path or str
        A rosbag2 folder or an .mcap file; finished, cut short or damaged.

    Raises
    ------
    BadInput
        If there is no recording at `path`.

    """
    path = Path(path)
    try:
        return Bag(path, [(file, file_contents(file)) for file in bag_files(path)])
    except OSError as error:
        raise BadInput(f"'{path}' cannot be read ({error.strerror}); {ADVICE}.") from error


def file_contents(file: Path) -> Contents:
    """Return the contents of one MCAP file, from its summary if that can be relied on."""
    size = file.stat().st_size
    if size == 0:
        raise BadInput(f"'{file}' is empty; nothing was recorded.")
    with file.open('rb') as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise BadInput(f"'{file}' is not a recording in MCAP; {ADVICE}.")
        return read_summary(stream, size) or scan(stream, size)
