# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Message definitions to store in a bag, so that it can be read without ROS."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from operator import itemgetter
from types import SimpleNamespace
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.message_files import find_message_file, list_message_files
import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import get_types_from_msg, get_typestore, Stores, TypesysError
from rosbags.typesys.store import Typestore


@final
@dataclass(frozen=True, slots=True)
class MessageDefinition:
    """
    A message type: its full text (ros2msg, parts joined by 80 '=') and its REP-2016 hash.

    A definition copied from another bag may have other encodings. Bytes that are not UTF-8 are
    kept as surrogate escapes.
    """

    type_name: str
    text: str
    rihs01: str
    encoding: str = 'ros2msg'
    message_encoding: str = 'cdr'


@cache
def load_jazzy_types() -> Typestore:
    """Return the message types of ROS 2 Jazzy and of lta_msgs."""
    types = get_typestore(Stores.ROS2_JAZZY)
    for name, path in list_message_files().items():
        types.register(get_types_from_msg(path.read_text('utf-8'), name))
    return types


def is_defined_type(type_name: str) -> bool:
    """Return whether a message type is of ROS 2 Jazzy, of lta_msgs or of an installed package."""
    types = load_jazzy_types()
    if type_name not in types.fielddefs and (path := find_message_file(type_name)):
        try:
            own = get_types_from_msg(path.read_text('utf-8-sig', errors='replace'), type_name)
            if all(map(is_defined_type, _list_parts(own[type_name][1]))):
                types.register(own)
        except (OSError, RecursionError, TypesysError):
            # A file that no recorder can read, or a message that holds itself, is left out
            return False
    return type_name in types.fielddefs


def _list_parts(fields: Any) -> Iterator[str]:
    """Yield the types of the messages in a message."""
    for _, (kind, described) in fields:
        inner, item = (kind, described) if kind < Nodetype.ARRAY else described[0]
        if inner == Nodetype.NAME:
            yield item


@cache
def generate_definition(type_name: str) -> MessageDefinition:
    """
    Return the definition of a message type, such as 'sensor_msgs/msg/Imu'.

    Raise `BadInput` if `is_defined_type` does not hold.
    """
    types = load_jazzy_types()
    if not is_defined_type(type_name):
        raise BadInput(
            f"Message type '{type_name}' cannot be recorded, because it is neither in ROS 2 "
            "Jazzy's common interfaces nor in an installed package; source its workspace."
        )
    text, _ = types.generate_msgdef(type_name, ros_version=2)
    return MessageDefinition(type_name, text, types.hash_rihs01(type_name))


Convert = Callable[[Any], Any]


def encode_message(message: Any, type_name: str) -> bytes:
    """Return a message as CDR, padded to a multiple of four as the middleware does."""
    data = load_jazzy_types().serialize_cdr(_find_adapter(type_name)(message), type_name)
    return bytes(data) + bytes(-len(data) % 4)


def _keep(value: Any) -> Any:
    return value


@cache
def _find_adapter(type_name: str) -> Convert:
    """
    Return what makes a message of rclpy one of rosbags; `_keep` if it is both.

    They differ in sequences of numbers and in octets.
    """
    fields = load_jazzy_types().fielddefs[type_name][1]
    adapters = {name: _find_field_adapter(*field) for name, field in fields}
    if all(adapt is _keep for adapt in adapters.values()):
        return _keep
    return lambda message: SimpleNamespace(
        **{name: adapt(getattr(message, name)) for name, adapt in adapters.items()}
    )


def _find_field_adapter(kind: Nodetype, described: Any) -> Convert:
    if kind == Nodetype.NAME:
        return _find_adapter(described)
    if kind == Nodetype.BASE:
        return itemgetter(0) if described[0] in ('byte', 'octet') else _keep
    inner, item = described[0]
    if inner == Nodetype.NAME:
        adapt = _find_adapter(item)
        return _keep if adapt is _keep else lambda values: [adapt(value) for value in values]
    # Arrays of fixed size are arrays of numpy in both
    return np.asarray if kind == Nodetype.SEQUENCE and item[0] != 'string' else _keep
