"""Message definitions that go into a bag, so that it can be read without ROS and without us."""

from dataclasses import dataclass
from functools import cache
from typing import final

from lta_config.errors import BadInput
from rosbags.typesys import get_typestore, Stores
from rosbags.typesys.store import Typestore


@final
@dataclass(frozen=True, slots=True)
class MessageDefinition:
    """
    A message type: its whole text (ros2msg, parts joined by 80 '=') and its REP-2016 hash.

    A definition taken from elsewhere may be in another encoding, its bytes as surrogates where
    they are no UTF-8; so may its messages.
    """

    type_name: str
    text: str
    rihs01: str
    encoding: str = 'ros2msg'
    message_encoding: str = 'cdr'


@cache
def load_jazzy_types() -> Typestore:
    """Return the message types of ROS 2 Jazzy."""
    return get_typestore(Stores.ROS2_JAZZY)


def is_jazzy_type(type_name: str) -> bool:
    """Tell whether a message type is one of ROS 2 Jazzy's common interfaces."""
    return type_name in load_jazzy_types().fielddefs


@cache
def generate_definition(type_name: str) -> MessageDefinition:
    """
    Return the definition of a message type of ROS 2 Jazzy.

    Parameters
    ----------
    type_name : str
        Full name, for example 'sensor_msgs/msg/Imu'.

    Raises
    ------
    BadInput
        If ROS 2 Jazzy has no such type.

    """
    types = load_jazzy_types()
    if not is_jazzy_type(type_name):
        raise BadInput(
            f"Message type '{type_name}' is not part of ROS 2 Jazzy's common interfaces; "
            "record a type such as 'sensor_msgs/msg/Imu'."
        )
    text, _ = types.generate_msgdef(type_name, ros_version=2)
    return MessageDefinition(type_name, text, types.hash_rihs01(type_name))
