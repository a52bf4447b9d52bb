# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Open a bag for playback: one robot's messages of the topic table, in the order of their time.

The bag's clock is the time of the recorded stamps. LTA's recorder uses it for the log times. The
log times of other recorders are shifted, so that the first stamped message is logged at its time
of publication.
"""

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
import struct
from typing import final, NamedTuple

from lta_bag.mcap_file.output import PROVENANCE
from lta_bag.provenance import extract_robot_origin
from lta_bag.version_1 import refuse_old_bag
from lta_bridge.log_time_assigner import read_stamp
from lta_config.errors import BadInput, unknown_name_error
from lta_config.limits import READER_MEMORY
from lta_config.topics import TopicTable
from mcap.exceptions import McapError
from mcap.reader import make_reader, McapReader
from mcap.summary import Summary
from mcap.well_known import MessageEncoding
from mcap.writer import MCAP0_MAGIC
from zstandard import ZstdError

BAG_FORMS = 'give a rosbag2 folder or an .mcap file'
# Errors that the library raises for truncated or damaged files.
DAMAGE_ERRORS = (McapError, struct.error, EOFError, LookupError, ValueError, ZstdError)


@final
class LoggedMessage(NamedTuple):
    """One message as logged: absolute topic, log time [ns], bytes."""

    topic: str
    time_ns: int
    data: bytes


@contextmanager
def open_indexed_file(file: Path) -> Iterator[tuple[McapReader, Summary]]:
    """
    Open a finished MCAP file, and give its reader and summary.

    Raise `BadInput` if it cannot be read, is no MCAP, or turns out to be damaged or unfinished.
    """
    try:
        with file.open('rb') as stream:
            if stream.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
                raise BadInput(f"'{file}' is not an MCAP recording; {BAG_FORMS}.")
            stream.seek(0)
            reader = make_reader(stream)
            summary = reader.get_summary()
            if summary is None:
                raise McapError('its recording was cut short')
            yield reader, summary
    except BadInput:
        raise
    except OSError as error:
        raise BadInput(f"'{file}' cannot be read ({error.strerror}); {BAG_FORMS}.") from error
    except (*DAMAGE_ERRORS, MemoryError) as error:
        why = str(error) or f'a chunk needs more than {READER_MEMORY >> 20} MB of memory'
        raise BadInput(
            f"'{file}' is damaged or unfinished ({why}); copy it with `lta import`."
        ) from error


def read_topic_types(files: list[Path]) -> tuple[dict[str, str], dict[str, str]]:
    """Return the message type of each topic of a bag, and the bag's provenance."""
    types: dict[str, str] = {}
    provenance: dict[str, str] = {}
    for file in files:
        with open_indexed_file(file) as (reader, summary):
            types |= {
                channel.topic: summary.schemas[channel.schema_id].name
                for channel in summary.channels.values()
                # Messages of ROS 2 are CDR
                if channel.schema_id in summary.schemas
                and str(channel.message_encoding) == MessageEncoding.CDR
            }
            for record in reader.iter_metadata():
                provenance |= record.metadata if record.name == PROVENANCE else {}
    return types, provenance


def iterate_by_time(
    file: Path, topics: Collection[str], since_ns: int | None
) -> Iterator[LoggedMessage]:
    """
    Yield a file's messages of some topics by log time.

    `file`: an .mcap file. `topics`: absolute names. `since_ns`: the first log time [ns]. Raise
    `BadInput` if the file turns out to be damaged.
    """
    with open_indexed_file(file) as (reader, _):
        for _, channel, message in reader.iter_messages(topics, starting_at=since_ns):
            yield LoggedMessage(channel.topic, message.log_time, message.data)


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
        """Return the offset from log times to the bag's clock [ns]."""
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
        raise BadInput(f"'{path}' does not exist; {BAG_FORMS}.")
    # The newest file of a split bag is empty if the recorder was killed during the split.
    files = [file for file in files if not file.is_file() or file.stat().st_size] or files
    if not files:
        raise BadInput(f"'{path}' contains no MCAP recording; {BAG_FORMS}.")
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
