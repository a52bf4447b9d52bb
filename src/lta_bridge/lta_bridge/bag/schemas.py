"""Message definitions to store in a bag, so that it can be read without ROS."""

from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from typing import final

from lta_config.compilation.source_file import StoredResults
from lta_config.errors import BadInput
from lta_config.message_files import list_message_files
from rosbags.typesys import get_types_from_msg, get_typestore, Stores
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


def is_jazzy_type(type_name: str) -> bool:
    """Return whether a message type is one of ROS 2 Jazzy's common interfaces or of lta_msgs."""
    return type_name in load_jazzy_types().fielddefs


@cache
def generate_definition(type_name: str) -> MessageDefinition:
    """
    Return the definition of a message type, such as 'sensor_msgs/msg/Imu'.

    Raise `BadInput` if neither ROS 2 Jazzy nor lta_msgs has such a type.
    """

    def generate() -> list[str]:
        types = load_jazzy_types()
        if not is_jazzy_type(type_name):
            raise BadInput(
                f"Message type '{type_name}' cannot be recorded, because it is not part of ROS 2 "
                "Jazzy's common interfaces; record only types such as 'sensor_msgs/msg/Imu'."
            )
        text, _ = types.generate_msgdef(type_name, ros_version=2)
        return [text, types.hash_rihs01(type_name)]

    stored = _open_stored_definitions()
    text, rihs01 = stored.recall(generate, type_name)
    stored.store()
    return MessageDefinition(type_name, text, rihs01)


@cache
def _open_stored_definitions() -> StoredResults:
    """Return the definitions on disk: to load all types takes as long as to fly a second."""
    own = (name.encode() + path.read_bytes() for name, path in list_message_files().items())
    return StoredResults('definitions', version('rosbags').encode(), *own)
