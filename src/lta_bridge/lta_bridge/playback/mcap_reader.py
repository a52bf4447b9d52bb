"""
Read the MCAP files of a bag in the order of log time, with the mcap library.

A finished file is read by its index. A truncated file has none: its whole records are loaded into
memory and sorted.

The library trusts the sizes stated in a file. To read an untrusted file, limit the memory of the
process (`limit_memory`).
"""

from collections.abc import Collection, Iterator
from contextlib import suppress
from pathlib import Path
import struct
from typing import BinaryIO, final, NamedTuple

from lta_bridge.bag.mcap_file import PROVENANCE
from lta_config.errors import BadInput
from lta_config.limits import READER_MEMORY
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
