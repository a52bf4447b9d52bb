"""Recover a damaged recording: write the intact part to a new bag and report the losses."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
import shutil
from typing import Any, cast, final

from lta_bridge.bag.metadata import OfferedQos
from lta_bridge.bag.schemas import MessageDefinition
from lta_bridge.bag.writer import BagWriter
from lta_config.errors import BadInput
from lta_config.files import parse_yaml
from lta_data.bag.bag_folder import find_bag_files, find_listed_files, read_metadata
from lta_data.bag.mcap_file.contents import parse_topic_metadata
from lta_data.bag.reader import Bag, read_bag
from lta_report.formatting import format_count
from mcap.records import Channel, Schema

RECOVERED_FROM = 'recovered_from'  # keys of the provenance
LOSSES = 'recovered_without'
MOST_NOTED = 20  # losses listed in the provenance


@final
@dataclass(frozen=True, slots=True)
class Recovery:
    """Result of a recovery."""

    # The original, and the new bag
    source: str
    path: str
    messages: int  # messages in the new bag
    topics: dict[str, int]  # the same by topic
    size: int  # size of the original's files [bytes]
    lost_bytes: int  # unusable part of the original
    missing: dict[str, int]  # messages that metadata.yaml or the index counts besides, by topic
    # Messages of the reader, one sentence each
    losses: list[str]
    remarks: list[str]

    def describe_losses(self) -> list[str]:
        """Return what was saved and what was lost, in sentences."""
        verb = 'was' if self.messages == 1 else 'were'
        lines = [
            f'{format_count(self.messages, "message")} of '
            f'{format_count(len(self.topics), "topic")} {verb} saved to {self.path}.',
            *self.losses,
            *self.remarks,
        ]
        if self.lost_bytes:
            lines.append(f'{self.lost_bytes} of {self.size} bytes of the recording are lost.')
        for topic, count in sorted(self.missing.items()):
            lines.append(f'{topic} lacks {format_count(count, "message")}.')
        if not self.lost_bytes and not self.missing:
            lines.append('No message is known to be lost.')
        return lines


def recover_bag(
    source: Path, out: Path, at: Callable[[int, int], None] = lambda done, total: None
) -> Recovery:
    """
    Write the intact part of a recording to a new, complete, indexed bag.

    Parameters
    ----------
    source : Path
        A rosbag2 folder or an .mcap file; it is only read.
    out : Path
        Folder of the new bag; created if missing, refused if not empty.
    at : callable
        Called with the bytes read so far, and the total.

    Raises
    ------
    BadInput
        If there is nothing to recover, the recording is intact, or a folder cannot be used.
    StorageFault
        If the disk is full.

    """
    bag = read_bag(source)
    if not any(topic.count for topic in bag.topics.values()):
        raise BadInput(f"'{source}' contains no intact message; there is nothing to recover.")
    refuse_inside(source, out)
    if is_finished(bag):
        total = sum(1 for _ in bag.iterate_records(at=lambda done: at(done, bag.size)))
        if bag.is_complete:
            raise BadInput(
                f"'{source}' is intact: all {total} messages are readable; use it as it is."
            )
    fresh = not out.exists()
    try:
        return write_recovered_bag(bag, out, at)
    except KeyboardInterrupt:
        # Ctrl-C leaves nothing behind, but never deletes a folder of the user.
        if fresh:
            shutil.rmtree(out, ignore_errors=True)
        raise


def is_finished(bag: Bag) -> bool:
    """Return whether a recording looks complete: summaries, files and metadata.yaml."""
    described = True
    if bag.path.is_dir():
        metadata = read_metadata(bag.path)
        described = find_listed_files(bag.path, metadata) == find_bag_files(bag.path, metadata)
    return bag.is_complete and bag.is_indexed and described and not bag.remarks


def refuse_inside(source: Path, out: Path) -> None:
    """Raise BadInput if the new bag would be inside the original."""
    folder = source.resolve()
    if folder.is_dir() and out.resolve().is_relative_to(folder):
        raise BadInput(
            f"The new folder '{out}' is inside the recording itself, which must not change; "
            'choose another folder.'
        )


def write_recovered_bag(bag: Bag, out: Path, at: Callable[[int, int], None]) -> Recovery:
    """Write the new bag; see `recover_bag`."""
    counts: Counter[str] = Counter()
    expected = sum(topic.count for topic in bag.topics.values())
    note = {RECOVERED_FROM: f'{bag.path.resolve()} ({bag.size} bytes, {expected} messages seen)'}
    if bag.losses:
        note[LOSSES] = ' '.join(bag.losses[:MOST_NOTED])
    with BagWriter(out, bag.provenance | note) as writer:
        for topic, (channel, schema) in bag.channels.items():
            writer.add_topic(topic, build_definition(channel, schema), parse_qos_profiles(channel))
        for topic, record in bag.iterate_records(at=lambda done: at(done, bag.size)):
            writer.write(topic, record.data, record.log_time, record.publish_time)
            counts[topic] += 1
    lost = [loss for part in bag.parts for loss in part.contents.lost]
    return Recovery(
        source=str(bag.path),
        path=str(out),
        messages=counts.total(),
        topics={topic: counts[topic] for topic in sorted(bag.topics)},
        size=bag.size,
        lost_bytes=sum(loss.length for loss in lost),
        missing=count_missing(bag, counts),
        losses=list(bag.losses),
        remarks=list(bag.remarks),
    )


def count_missing(bag: Bag, saved: Counter[str]) -> dict[str, int]:
    """Return how many messages metadata.yaml or the index counts beyond the saved ones."""
    described = read_metadata(bag.path) if bag.path.is_dir() else {}
    counts = {topic: entry.count for topic, entry in bag.topics.items()}
    for entry in parse_topic_metadata(described):
        if entry.topic in counts:
            counts[entry.topic] = max(counts[entry.topic], entry.messages)
    return {topic: n - saved[topic] for topic, n in counts.items() if n > saved[topic]}


def build_definition(channel: Channel, schema: Schema | None) -> MessageDefinition:
    """Return a topic's definition as stored in the recording."""
    kind = channel.metadata.get('topic_type_hash', '')
    if schema is None:
        return MessageDefinition('', '', kind, '', channel.message_encoding)
    text = schema.data.decode(errors='surrogateescape')
    return MessageDefinition(schema.name, text, kind, schema.encoding, channel.message_encoding)


def parse_qos_profiles(channel: Channel) -> list[OfferedQos]:
    """Return the QoS that a topic's publishers offered; empty if unknown, or in numbers."""
    text = channel.metadata.get('offered_qos_profiles', '')
    try:
        listed: Any = parse_yaml(text, 'the QoS') if text else []
    except BadInput:
        return []
    named = isinstance(listed, list) and all(
        isinstance(one, dict) and isinstance(one.get('history'), str) for one in listed
    )
    return cast('list[OfferedQos]', listed) if named else []
