"""Read the message definitions stored in a bag, of known and unknown types."""

from dataclasses import replace

from lta_bridge.bag.schemas import load_jazzy_types, MessageDefinition
from lta_data.bag.mcap_file.type_definition import MISDEFINED, parse_definition
from lta_data.bag.recover import build_definition
from mcap.records import Channel, Schema
from rosbags.typesys import get_typestore, Stores
from rosbags.typesys.store import Typestore


def read_bag_definition(channel: Channel, schema: Schema | None) -> MessageDefinition:
    """Return a topic's definition from an MCAP file, with its REP-2016 hash if possible."""
    definition = build_definition(channel, schema)
    if definition.rihs01 or definition.encoding != 'ros2msg':
        return definition
    types = get_typestore(Stores.EMPTY)
    try:
        types.register(
            parse_definition(definition.text, definition.type_name, definition.encoding)
        )
        return replace(definition, rihs01=types.hash_rihs01(definition.type_name))
    except MISDEFINED:
        return definition  # unreadable, but kept as it is


def find_store_definition(type_name: str, types: Typestore, notes: list[str]) -> MessageDefinition:
    """Return a type's definition from a store; empty if it is unknown."""
    for store in (types, load_jazzy_types()):
        if type_name in store.fielddefs:
            text, _ = store.generate_msgdef(type_name, ros_version=2)
            return MessageDefinition(type_name, text, store.hash_rihs01(type_name))
    notes.append(
        f"Neither the bag nor ROS 2 Jazzy defines '{type_name}'; its messages are copied "
        'undecoded.'
    )
    return MessageDefinition(type_name, '', '')
