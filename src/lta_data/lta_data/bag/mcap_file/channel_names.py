"""Restore topics and types of channels whose records are lost, from metadata.yaml."""

from collections.abc import Mapping, Sequence
from typing import final, NamedTuple

from lta_bridge.bag.schemas import generate_definition
from lta_config.errors import BadInput
from lta_data.bag.mcap_file.contents import McapContents
from mcap.records import Channel, Schema

NAMELESS = '/channel_{}'  # cannot collide with a robot's topic, which has a namespace


@final
class TopicMetadata(NamedTuple):
    """The entry of a topic in metadata.yaml; 0 messages if there is no count."""

    topic: str
    type_name: str
    messages: int


def parse_topic_metadata(described: Mapping[str, object]) -> list[TopicMetadata]:
    """Return the topics in `rosbag2_bagfile_information`; malformed entries are skipped."""
    listed = described.get('topics_with_message_count')
    entries = []
    for entry in listed if isinstance(listed, list) else []:
        topic = entry.get('topic_metadata') if isinstance(entry, dict) else None
        if not isinstance(topic, dict):
            continue
        name, type_name, count = topic.get('name'), topic.get('type'), entry.get('message_count')
        if isinstance(name, str) and isinstance(type_name, str):
            entries.append(TopicMetadata(name, type_name, count if isinstance(count, int) else 0))
    return entries


def complete_names(contents: McapContents, metadata_topics: Sequence[TopicMetadata]) -> None:
    """
    Name the channels of a scanned file whose records are lost, with the chunk that held them.

    Modifies `contents`. `metadata_topics` are the topics of metadata.yaml, in order.
    """
    types = {entry.topic: entry.type_name for entry in metadata_topics}
    for channel in contents.channels.values():
        type_name = types.get(channel.topic)
        if type_name and channel.schema_id and channel.schema_id not in contents.schemas:
            contents.schemas[channel.schema_id] = build_ros_schema(channel.schema_id, type_name)
            contents.remarks.append(
                f"The recording lacks the message definition of '{type_name}'; the standard ROS "
                'definition is used instead.'
            )
    # If the known channels are numbered as in metadata.yaml, so are the others
    channels, entries = contents.channels, dict(enumerate(metadata_topics, start=1))
    if any(entries[id].topic != channels[id].topic for id in entries.keys() & channels):
        entries = {}
    for id in sorted(set(contents.counts) - set(contents.channels)):
        name_channel(contents, id, entries.get(id))


def name_channel(contents: McapContents, id: int, entry: TopicMetadata | None) -> None:
    """Name one channel by its entry in metadata.yaml, otherwise by its number."""
    if entry is None:
        contents.channels[id] = Channel(id, NAMELESS.format(id), 'cdr', {}, 0)
        contents.remarks.append(
            f'The recording does not contain the topic name of channel {id}; its messages are '
            f"kept under the topic '{NAMELESS.format(id)}'."
        )
        return
    schema = next((s for s in contents.schemas.values() if s.name == entry.type_name), None)
    if schema is None:
        schema = build_ros_schema(max(contents.schemas, default=0) + 1, entry.type_name)
        contents.schemas[schema.id] = schema
    contents.channels[id] = Channel(id, entry.topic, 'cdr', {}, schema.id)
    contents.remarks.append(
        f'The topic name of channel {id} is missing in the recording; it is taken from '
        f"metadata.yaml: '{entry.topic}'."
    )


def build_ros_schema(id: int, type_name: str) -> Schema:
    """Return the ROS definition of a type, or an empty schema for an unknown type."""
    try:
        text, encoding = generate_definition(type_name).text.encode(), 'ros2msg'
    except BadInput:
        text, encoding = b'', ''
    return Schema(id=id, data=text, encoding=encoding, name=type_name)
