"""
A bag to play: one robot's messages of the topic table, in the order of the bag's own clock.

The bag's clock is the time of the recorded stamps. Ours log by it already; where a recorder of
others logged by another clock, its log times are shifted so that the first stamped message was
logged when it was published.
"""

from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, final, NamedTuple

from lta_bridge.bag.records import PROVENANCE
from lta_bridge.bookkeeping import stamp_of
from lta_bridge.provenance import part
from lta_config.errors import BadInput, unknown
from lta_config.topics import TopicTable
from mcap.exceptions import InvalidMagic, McapError
from mcap.reader import make_reader, McapReader
from mcap.records import Channel, Message, Metadata, Schema
from mcap.stream_reader import StreamReader
from mcap.well_known import MessageEncoding

ADVICE = 'give a rosbag2 folder or an .mcap file'
Found = tuple[Schema | None, Channel, Message]


class Recorded(NamedTuple):
    """One message: relative topic, time on the bag's clock [ns], bytes as recorded."""

    topic: str
    time_ns: int
    data: bytes


@final
class Recording:
    """
    One robot's part of a bag; see `open_recording`.

    Attributes
    ----------
    path : Path
        The bag.
    robot : str
        Its namespace in the bag; '' where topics have none.
    topics : frozenset of str
        The table's topics that the bag has, relative.
    strange : tuple of str
        Sentences on topics that cannot be played.
    provenance : dict of str to str
        Where the robot's data come from.

    """

    def __init__(self, path: Path, files: list[Path], robot: str, table: TopicTable) -> None:
        self.path = path
        self._files = files
        channels, told = announced(files)
        self.robot = chosen(path, robot, sorted({found[0] for found in split(channels, table)}))
        self.provenance = part(told, self.robot)
        mine = {name: full for owner, name, full in split(channels, table) if owner == self.robot}
        self.strange = tuple(
            f"'{full}' is of type '{channels[full]}', not {table[name].type}, and is left out"
            for name, full in mine.items()
            if channels[full] != table[name].type
        )
        self._names = {
            full: name for name, full in mine.items() if channels[full] == table[name].type
        }
        self.topics = frozenset(self._names.values())
        self._shift = 0
        self._shift = self._found_shift(table)

    def messages(self, topics: Collection[str], begin_ns: int | None = None) -> Iterator[Recorded]:
        """
        Yield messages in the order of the bag's clock.

        Parameters
        ----------
        topics : collection of str
            Relative names; those that the bag lacks are passed over.
        begin_ns : int, optional
            Where to begin, on the bag's clock. [ns]

        """
        wanted = [full for full, name in self._names.items() if name in topics]
        since = None if begin_ns is None else max(0, begin_ns - self._shift)
        for file in self._files if wanted else []:
            for _, channel, message in ordered(file, wanted, since):
                name = self._names[channel.topic]
                yield Recorded(name, message.log_time + self._shift, message.data)

    def _found_shift(self, table: TopicTable) -> int:
        """Return what to add to a log time for the time on the bag's clock. [ns]"""
        rhythmic = [name for name in self.topics if table[name].stamped and table[name].period_ns]
        for name, time_ns, data in self.messages(rhythmic):
            if stamp := stamp_of(data):
                return stamp + table[name].latency_ns - time_ns
        return 0


def open_recording(path: Path, robot: str, table: TopicTable) -> Recording:
    """
    Open a bag for playing.

    Parameters
    ----------
    path : Path
        A rosbag2 folder or an .mcap file.
    robot : str
        Namespace in the bag; may be empty where it has only one.
    table : TopicTable
        What can be played.

    Raises
    ------
    BadInput
        If there is no bag that can be played, or it has several robots and none is named.

    """
    if path.is_file():
        files = [path]
    elif path.is_dir():
        # bag_2 before bag_10
        files = sorted(path.glob('*.mcap'), key=lambda file: (len(file.name), file.name))
    else:
        raise BadInput(f"'{path}' does not exist; {ADVICE}.")
    if not files:
        raise BadInput(f"'{path}' holds no recording in MCAP; {ADVICE}.")
    return Recording(path, files, robot, table)


def announced(files: list[Path]) -> tuple[dict[str, str], dict[str, str]]:
    """Return the message type of each topic of a bag, and what the bag tells of its origin."""
    types: dict[str, str] = {}
    told: dict[str, str] = {}
    for file in files:
        try:
            with file.open('rb') as stream:
                found, origin = whole(stream) or torn(stream)
        except InvalidMagic:
            raise BadInput(f"'{file}' is not a recording in MCAP; {ADVICE}.") from None
        except OSError as error:
            raise BadInput(f"'{file}' cannot be read ({error.strerror}); {ADVICE}.") from error
        types |= found
        told |= origin
    return types, told


def whole(stream: BinaryIO) -> tuple[dict[str, str], dict[str, str]] | None:
    """Return types and origin by a file's summary; None where it has none."""
    try:
        reader = make_reader(stream)
        summary = reader.get_summary()
        if summary is None:
            return None
        types = {
            channel.topic: summary.schemas[channel.schema_id].name
            for channel in summary.channels.values()
            if channel.schema_id in summary.schemas
            and channel.message_encoding == MessageEncoding.CDR
        }
        return types, origin(reader)
    except InvalidMagic:
        stream.seek(0)
        return None
    except McapError:
        return None


def origin(reader: McapReader) -> dict[str, str]:
    """Return what a file tells of its origin."""
    return {
        key: value
        for record in reader.iter_metadata()
        if record.name == PROVENANCE
        for key, value in record.metadata.items()
    }


def torn(stream: BinaryIO) -> tuple[dict[str, str], dict[str, str]]:
    """Return types and origin of a file without a summary, as far as it goes."""
    types, told = {}, {}
    for record in records(stream):
        if isinstance(record, tuple):
            schema, channel, _ = record
            types[channel.topic] = '' if schema is None else schema.name
        else:
            told |= record
    return types, told


def records(stream: BinaryIO) -> Iterator[Found | dict[str, str]]:
    """Yield messages and origins of an unfinished file in their order, to its first damage."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    stream.seek(0)
    with suppress(McapError, EOFError):
        for record in StreamReader(stream).records:
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Metadata) and record.name == PROVENANCE:
                yield record.metadata
            elif isinstance(record, Message) and record.channel_id in channels:
                channel = channels[record.channel_id]
                if channel.message_encoding == MessageEncoding.CDR:
                    yield schemas.get(channel.schema_id), channel, record


def ordered(file: Path, topics: list[str], since_ns: int | None) -> Iterator[Found]:
    """Yield a file's messages of some topics by log time; `BadInput` where it is damaged."""
    with file.open('rb') as stream:
        reader = None
        with suppress(McapError):
            found = make_reader(stream)
            reader = found if found.get_summary() is not None else None
        if reader is None:  # cut short: all of it must be at hand to be put in order
            items = [item for item in records(stream) if isinstance(item, tuple)]
            chosen_ones = [item for item in items if item[1].topic in topics]
            early = since_ns or 0
            yield from sorted(
                (item for item in chosen_ones if item[2].log_time >= early),
                key=lambda item: item[2].log_time,
            )
            return
        try:
            yield from reader.iter_messages(topics, starting_at=since_ns)
        except McapError as error:
            raise BadInput(
                f"'{file}' is damaged ({error}); mend it with `lta bag recover`."
            ) from error


def split(names: Mapping[str, str], table: TopicTable) -> list[tuple[str, str, str]]:
    """Return robot, relative name and full name of each topic that stands in the table."""
    found = []
    for full in names:
        plain = full.strip('/')
        robot, _, name = plain.partition('/')
        if plain in table.topics:
            found.append(('', plain, full))
        elif name in table.topics:
            found.append((robot, name, full))
    return found


def chosen(path: Path, robot: str, found: list[str]) -> str:
    """Return the robot to play: the one that is named, or the only one."""
    if not found:
        raise BadInput(f"'{path}' has no topic that LTA knows; see docs/topics.md.")
    if robot and robot not in found:
        raise unknown('robot', robot, found)
    if not robot and len(found) > 1:
        raise BadInput(
            f"'{path}' holds several robots ({', '.join(found)}); name the one to play."
        )
    return robot or found[0]
