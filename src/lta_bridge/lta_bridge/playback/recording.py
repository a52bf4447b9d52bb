"""
Open a bag for playback: one robot's messages of the topic table, in the order of their time.

The bag's clock is the time of the recorded stamps. LTA's recorder uses it for the log times. The
log times of other recorders are shifted, so that the first stamped message is logged at its time
of publication.
"""

from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
import struct
from typing import BinaryIO, final, NamedTuple

from lta_bridge.bag.mcap_file import PROVENANCE
from lta_bridge.bag.version_1 import refuse_old_bag
from lta_bridge.log_time_assigner import read_stamp
from lta_bridge.provenance import extract_robot_origin
from lta_config.errors import BadInput, unknown_name_error
from lta_config.limits import READER_MEMORY
from lta_config.topics import TopicTable
from mcap.exceptions import McapError
from mcap.reader import make_reader, McapReader
from mcap.records import Channel, Message, Metadata, Schema
from mcap.stream_reader import StreamReader
from mcap.summary import Summary
from mcap.well_known import MessageEncoding
from mcap.writer import MCAP0_MAGIC
from zstandard import ZstdError

ADVICE = 'give a rosbag2 folder or an .mcap file'
# Errors that the library raises for truncated or damaged files.
BROKEN = (McapError, struct.error, EOFError, LookupError, ValueError, ZstdError)


def build_size_error(file: Path) -> BadInput:
    """Return the error for a file without an index that does not fit into memory."""
    return BadInput(
        f"'{file}' has no index, so it must be loaded into memory, but it is damaged or needs "
        f'more than the limit of {READER_MEMORY >> 20} MB; run `lta bag recover` to copy its '
        'undamaged part to a file with an index.'
    )


@final
class LoggedMessage(NamedTuple):
    """One message as logged: absolute topic, log time [ns], bytes."""

    topic: str
    time_ns: int
    data: bytes


def read_topic_types(files: list[Path]) -> tuple[dict[str, str], dict[str, str]]:
    """
    Return the message type of each topic of a bag, and the bag's provenance.

    Raise `BadInput` if a file cannot be read or is no MCAP.
    """
    types: dict[str, str] = {}
    provenance: dict[str, str] = {}
    for file in files:
        try:
            with file.open('rb') as stream:
                if stream.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
                    raise BadInput(f"'{file}' is not an MCAP recording; {ADVICE}.")
                file_types, origin = read_summary(stream) or scan_unfinished_file(stream)
        except OSError as error:
            raise BadInput(f"'{file}' cannot be read ({error.strerror}); {ADVICE}.") from error
        except MemoryError:
            raise build_size_error(file) from None
        types |= file_types
        provenance |= origin
    return types, provenance


def open_indexed_file(stream: BinaryIO) -> tuple[McapReader, Summary] | None:
    """Return a finished file's reader and summary; None without a summary."""
    stream.seek(0)
    with suppress(*BROKEN, MemoryError):
        reader = make_reader(stream)
        summary = reader.get_summary()
        if summary is not None:
            return reader, summary
    return None


def read_summary(stream: BinaryIO) -> tuple[dict[str, str], dict[str, str]] | None:
    """Return types and origin from a file's summary; None without a summary."""
    opened = open_indexed_file(stream)
    if opened is None:
        return None
    reader, summary = opened
    types = {
        channel.topic: summary.schemas[channel.schema_id].name
        for channel in summary.channels.values()
        if channel.schema_id in summary.schemas and is_cdr(channel)
    }
    provenance: dict[str, str] = {}
    with suppress(*BROKEN, MemoryError):
        for record in reader.iter_metadata():
            provenance |= record.metadata if record.name == PROVENANCE else {}
    return types, provenance


def is_cdr(channel: Channel) -> bool:
    """Return whether a channel's messages are CDR, as in ROS 2."""
    return str(channel.message_encoding) == MessageEncoding.CDR


def scan_unfinished_file(stream: BinaryIO) -> tuple[dict[str, str], dict[str, str]]:
    """Return types and origin from the readable records of a file without a summary."""
    types: dict[str, str] = {}
    provenance: dict[str, str] = {}
    schemas: dict[int, str] = {}
    for record in iterate_records(stream):
        if isinstance(record, Schema):
            schemas[record.id] = record.name
        elif isinstance(record, Channel) and is_cdr(record):
            types[record.topic] = schemas.get(record.schema_id, '')
        elif isinstance(record, Metadata) and record.name == PROVENANCE:
            provenance |= record.metadata
    return types, provenance


def iterate_records(stream: BinaryIO) -> Iterator[object]:
    """Yield the records of an unfinished file up to the first damage."""
    stream.seek(0)
    # An unfinished file ends in a partial record: everything before it is valid
    with suppress(*BROKEN):
        yield from StreamReader(stream).records


def iterate_by_time(
    file: Path, topics: Collection[str], since_ns: int | None
) -> Iterator[LoggedMessage]:
    """
    Yield a file's messages of some topics by log time.

    `file`: an .mcap file. `topics`: absolute names. `since_ns`: the first log time [ns]. Raise
    `BadInput` if a finished file turns out to be damaged.
    """
    with file.open('rb') as stream:
        opened = open_indexed_file(stream)
        if opened is None:
            try:
                # Without an index the whole file must be sorted in memory
                messages = sorted(
                    iterate_unfinished(stream, topics, since_ns or 0),
                    key=lambda item: item.time_ns,
                )
            except MemoryError:
                raise build_size_error(file) from None
            yield from messages
            return
        try:
            for _, channel, message in opened[0].iter_messages(topics, starting_at=since_ns):
                yield LoggedMessage(channel.topic, message.log_time, message.data)
        except (*BROKEN, MemoryError) as error:
            why = str(error) or f'a chunk needs more than {READER_MEMORY >> 20} MB of memory'
            raise BadInput(
                f"'{file}' is damaged ({why}); repair it with `lta bag recover`."
            ) from error


def iterate_unfinished(
    stream: BinaryIO, topics: Collection[str], since_ns: int
) -> Iterator[LoggedMessage]:
    """Yield the messages of an unfinished file in the order of the file."""
    names: dict[int, str] = {}
    for record in iterate_records(stream):
        if isinstance(record, Channel) and record.topic in topics:
            names[record.id] = record.topic
        elif isinstance(record, Message) and record.channel_id in names:
            message = LoggedMessage(names[record.channel_id], record.log_time, record.data)
            yield from [message] if message.time_ns >= since_ns else []


class RecordedMessage(NamedTuple):
    """One message: relative topic, time on the bag's clock [ns], bytes as recorded."""

    topic: str
    time_ns: int
    data: bytes


@final
class RobotBagRecording:
    """
    One robot's part of a bag; see `open_recording`.

    Attributes
    ----------
    path : Path
        The bag.
    robot : str
        Its namespace in the bag; '' where topics have none.
    topics : frozenset of str
        Relative names of the table's topics that the bag has.
    strange : tuple of str
        Messages about topics that cannot be played.
    provenance : dict of str to str
        Origin of the robot's data.

    """

    def __init__(
        self, path: Path, files: list[Path], robot: str, table: TopicTable, own: str = ''
    ) -> None:
        self.path = path
        self._files = files
        channels, provenance = read_topic_types(files)
        refuse_old_bag(path, channels, provenance)
        robots = sorted({parts[0] for parts in split_topic_names(channels, table)})
        self.robot = choose_robot(path, robot or (own if own in robots else ''), robots)
        self.provenance = extract_robot_origin(provenance, self.robot)
        mine = {
            name: full
            for owner, name, full in split_topic_names(channels, table)
            if owner == self.robot
        }
        self.strange = tuple(
            f"the topic '{full}' is not played, because its type is '{channels[full]}' instead of "
            f"'{table[name].type}'"
            for name, full in mine.items()
            if channels[full] != table[name].type
        )
        self._names = {
            full: name for name, full in mine.items() if channels[full] == table[name].type
        }
        self.topics = frozenset(self._names.values())
        # iterate_messages, used to find the shift, adds it already
        self._shift = 0
        self._shift = self._find_clock_shift(table)

    def iterate_messages(
        self, topics: Collection[str], begin_ns: int | None = None
    ) -> Iterator[RecordedMessage]:
        """
        Yield messages in the order of the bag's clock.

        `topics`: relative names; those that the bag lacks are ignored. `begin_ns`: where to begin,
        on the bag's clock [ns].
        """
        full_names = [full for full, name in self._names.items() if name in topics]
        since = None if begin_ns is None else max(0, begin_ns - self._shift)
        for file in self._files if full_names else []:
            for full, log_time, data in iterate_by_time(file, full_names, since):
                yield RecordedMessage(self._names[full], log_time + self._shift, data)

    def _find_clock_shift(self, table: TopicTable) -> int:
        """Return the offset from log times to the bag's clock. [ns]"""
        rhythmic = [name for name in self.topics if table[name].stamped and table[name].period_ns]
        for name, time_ns, data in self.iterate_messages(rhythmic):
            if stamp := read_stamp(data):
                # A message is published its latency after its stamp
                return stamp + table[name].latency_ns - time_ns
        return 0


def open_recording(path: Path, robot: str, table: TopicTable, own: str = '') -> RobotBagRecording:
    """
    Open a bag for playing.

    Parameters
    ----------
    path : Path
        A rosbag2 folder or an .mcap file.
    robot : str
        Namespace in the bag; may be empty where it has only one, or `own`.
    table : TopicTable
        What can be played.
    own : str
        Namespace of the player, the default if `robot` is empty.

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
    # The newest file of a split bag is empty if the recorder was killed during the split.
    files = [file for file in files if not file.is_file() or file.stat().st_size] or files
    if not files:
        raise BadInput(f"'{path}' contains no MCAP recording; {ADVICE}.")
    return RobotBagRecording(path, files, robot, table, own)


def split_topic_names(names: Mapping[str, str], table: TopicTable) -> list[tuple[str, str, str]]:
    """Return robot, relative name and full name of each topic that is in the table."""
    parts = []
    for full in names:
        plain = full.strip('/')
        robot, _, name = plain.partition('/')
        # Global topics such as /clock belong to no robot
        if plain in table.topics:
            parts.append(('', plain, full))
        elif name in table.topics:
            parts.append((robot, name, full))
    return parts


def choose_robot(path: Path, robot: str, robots: list[str]) -> str:
    """Return the robot to play: the given one, or the only one."""
    if not robots:
        raise BadInput(
            f"'{path}' has none of the topics listed in docs/topics.md; choose another bag."
        )
    if robot and robot not in robots:
        raise unknown_name_error('robot', robot, robots)
    if not robot and len(robots) > 1:
        raise BadInput(
            f"'{path}' has several robots ({', '.join(robots)}); name the one to play with the "
            'parameter robot.'
        )
    return robot or robots[0]
