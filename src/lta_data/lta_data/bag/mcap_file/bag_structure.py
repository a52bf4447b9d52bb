"""Represent the topics and files of a bag, and read the message indexes of a file."""

from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.limits import NOTE_BYTES
from lta_data.bag.mcap_file.compression import DamagedRecord
from lta_data.bag.mcap_file.contents import McapContents, MessageRegion, read_at
from lta_data.bag.mcap_file.rhythm import MessageIntervals, read_ordered_times
from mcap.records import Channel


@final
@dataclass(frozen=True, slots=True)
class BagTopic:
    """
    One recorded topic.

    `undecodable` is the reason why its messages are kept but cannot be decoded, as a clause.
    """

    name: str
    type_name: str
    count: int
    undecodable: str | None = None


class RecordingFile(NamedTuple):
    """One file of a bag."""

    file: Path
    contents: McapContents
    refused: BadInput | None = None


def find_message_type(contents: McapContents, channel: Channel) -> str:
    """Return the message type of a channel; empty if unknown."""
    schema = contents.schemas.get(channel.schema_id)
    return '' if schema is None else schema.name


def read_chunk_index(stream: BinaryIO, place: MessageRegion) -> bytes:
    """Return the message indexes of a chunk; empty if the summary gives a wrong place."""
    offset, length = place.index
    try:
        return read_at(stream, offset, length) if length <= NOTE_BYTES else b''
    except DamagedRecord:
        return b''


def read_indexed_rhythm(part: RecordingFile) -> MessageIntervals:
    """Return the timing of the messages of a finished file, from the indexes alone."""
    rhythm = MessageIntervals()
    with part.file.open('rb') as stream:
        for place in part.contents.places:
            rhythm.add_times(*read_ordered_times(read_chunk_index(stream, place)))
    return rhythm
