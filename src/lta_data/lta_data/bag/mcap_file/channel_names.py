"""Restore topics and types of channels whose records are lost, from metadata.yaml."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
import re
from typing import Final, final, NamedTuple

from lta_bridge.bag.schemas import generate_definition
from lta_config.errors import BadInput
from lta_data.bag.mcap_file.contents import McapContents
from lta_data.bag.mcap_file.decoder import READABLE
from mcap.records import Channel, Schema

# Schema encodings of https://mcap.dev/spec/registry; '' is none.
ENCODINGS: Final = (*READABLE, 'ros1msg', 'omgidl', 'protobuf', 'flatbuffer', 'jsonschema', '')
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
    Name the channels of a scanned file whose channel records are lost.

    Modifies `contents`. `metadata_topics` are the topics of metadata.yaml, in order.
    """
    choose_rivals(contents, metadata_topics)
    repair_encodings(contents)
    for channel in contents.channels.values():
        schema = contents.schemas.get(channel.schema_id)
        type_name = next(
            (entry.type_name for entry in metadata_topics if entry.topic == channel.topic), ''
        )
        if schema is None and channel.schema_id and type_name:
            contents.schemas[channel.schema_id] = build_ros_schema(channel.schema_id, type_name)
            contents.remarks.append(
                f"The recording lacks the message definition of '{type_name}'; the standard ROS "
                'definition is used instead.'
            )
    names = {entry.topic for entry in metadata_topics}
    odd = {id for id, other in contents.channels.items() if names and other.topic not in names}
    for id in sorted(odd | set(contents.counts) - set(contents.channels)):
        name_channel(contents, id, odd, metadata_topics)


def choose_rivals(contents: McapContents, metadata_topics: Sequence[TopicMetadata]) -> None:
    """If two copies of a channel differ, take the one in metadata.yaml."""
    names = {entry.topic for entry in metadata_topics}
    for rival in contents.rivals:
        if rival.topic in names and contents.channels[rival.id].topic not in names:
            contents.channels[rival.id] = rival


def repair_encodings(contents: McapContents) -> None:
    """Correct encodings that do not exist: schema and channel records are not under a CRC."""
    for id, schema in contents.schemas.items():
        if schema.encoding not in ENCODINGS and re.fullmatch(r'\w+/msg/\w+', schema.name):
            contents.remarks.append(
                f"The message definition of '{schema.name}' has the unknown encoding "
                f"'{schema.encoding}', which is probably damaged; it is interpreted as a ROS "
                'message definition.'
            )
            contents.schemas[id] = replace(schema, encoding='ros2msg')
        if schema.encoding in READABLE and not is_utf8(schema.data):
            contents.remarks.append(
                f"The message definition of '{schema.name}' is damaged; the standard ROS "
                'definition is used instead.'
            )
            contents.schemas[id] = build_ros_schema(id, schema.name)
    for id, channel in contents.channels.items():
        definition = contents.schemas.get(channel.schema_id)
        if definition and definition.encoding in READABLE and channel.message_encoding != 'cdr':
            contents.remarks.append(
                f"Topic '{channel.topic}' has a ROS type, but declares the encoding "
                f"'{channel.message_encoding}', which is probably damaged; its messages are "
                'decoded as CDR.'
            )
            contents.channels[id] = replace(channel, message_encoding='cdr')


def is_utf8(data: bytes) -> bool:
    """Return whether bytes are valid UTF-8."""
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


def name_channel(
    contents: McapContents, id: int, odd: set[int], metadata_topics: Sequence[TopicMetadata]
) -> None:
    """Name one channel by its position in metadata.yaml, otherwise by its number."""
    topics_by_id = {i: channel.topic for i, channel in contents.channels.items() if i not in odd}
    open_names = [entry for entry in metadata_topics if entry.topic not in topics_by_id.values()]
    in_order = all(
        metadata_topics[i - 1].topic == topics_by_id[i]
        for i in topics_by_id
        if 0 < i <= len(metadata_topics)
    )
    unnamed = len(set(contents.counts) - set(topics_by_id))
    match = None
    # If the known channels are numbered as in metadata.yaml, so are the others.
    if in_order and 0 < id <= len(metadata_topics) and metadata_topics[id - 1] in open_names:
        match = metadata_topics[id - 1]
    elif len(open_names) == unnamed == 1:
        match = open_names[0]
    if match is None:
        if id not in contents.channels:
            contents.channels[id] = Channel(id, NAMELESS.format(id), 'cdr', {}, 0)
            contents.remarks.append(
                f'The recording does not contain the topic name of channel {id}; its messages are '
                f"kept under the topic '{NAMELESS.format(id)}'."
            )
        return
    odd.discard(id)
    schema = next((s for s in contents.schemas.values() if s.name == match.type_name), None)
    if schema is None:
        schema = build_ros_schema(max(contents.schemas, default=0) + 1, match.type_name)
        contents.schemas[schema.id] = schema
    contents.channels[id] = Channel(id, match.topic, 'cdr', {}, schema.id)
    contents.remarks.append(
        f'The topic name of channel {id} is missing or damaged in the recording; it is taken from '
        f"metadata.yaml: '{match.topic}'."
    )


def build_ros_schema(id: int, type_name: str) -> Schema:
    """Return the ROS definition of a type, or an empty schema for an unknown type."""
    try:
        text, encoding = generate_definition(type_name).text.encode(), 'ros2msg'
    except BadInput:
        text, encoding = b'', ''
    return Schema(id=id, data=text, encoding=encoding, name=type_name)
