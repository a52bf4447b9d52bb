"""The parts of a bag: its topics and its files, and what a file tells without being read."""

from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.limits import NOTE_BYTES
from lta_data.bag.mcap_file.contents import Contents, Loss, Place, read_at
from lta_data.bag.mcap_file.packing import Damaged
from lta_data.bag.mcap_file.rhythm import entries, in_order, Rhythm
from mcap.records import Channel


@final
@dataclass(frozen=True, slots=True)
class Topic:
    """
    One recorded topic: absolute name, message type, number of messages.

    `undecodable` says in a half-sentence why its messages are kept but cannot be decoded.
    """

    name: str
    type_name: str
    count: int
    undecodable: str | None = None


class Part(NamedTuple):
    """One file of a bag."""

    file: Path
    contents: Contents
    refused: BadInput | None = None


def type_of(contents: Contents, channel: Channel) -> str:
    """Return the message type of a channel; empty where the file does not say."""
    schema = contents.schemas.get(channel.schema_id)
    return '' if schema is None else schema.name


def index_of(stream: BinaryIO, place: Place) -> bytes:
    """Return the message indexes of a chunk; empty where the summary is wrong about them."""
    offset, length = place.index
    try:
        return read_at(stream, offset, length) if length <= NOTE_BYTES else b''
    except Damaged:
        return b''


def lost_chunk(stream: BinaryIO, place: Place) -> Loss:
    """Return the loss of a chunk that the summary knows; its message indexes tell what it held."""
    loss = Loss(place.offset, place.length, 1, start=place.start, end=place.end)
    for channel, listed in entries(index_of(stream, place)):
        loss.counts[channel] += len(listed)
    return loss


def indexed_rhythm(part: Part) -> Rhythm:
    """Return when the messages of a finished file were recorded, without reading them."""
    rhythm = Rhythm()
    with part.file.open('rb') as stream:
        for place in part.contents.places:
            rhythm.feed(*in_order(index_of(stream, place)))
    return rhythm
