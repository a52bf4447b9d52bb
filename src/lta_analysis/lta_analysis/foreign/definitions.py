"""The message definitions that a bag brings along, whether or not we know the type."""

from lta_bridge.bag.schemas import Definition, jazzy
from rosbags.typesys import get_types_from_idl, get_types_from_msg, get_typestore, Stores
from rosbags.typesys.base import TypesysError
from rosbags.typesys.store import Typestore

FAULTS = (TypesysError, SyntaxError, KeyError, ValueError)


def from_bag(type_name: str, text: str, encoding: str, notes: list[str]) -> Definition:
    """
    Return a type's definition as the bag has it.

    Parameters
    ----------
    type_name : str
        For example 'sensor_msgs/msg/Imu'.
    text, encoding : str
        The definition, in 'ros2msg' or 'ros2idl'.
    notes : list of str
        Gets a sentence where the definition cannot be read.

    """
    types = get_typestore(Stores.EMPTY)
    try:
        if encoding == 'ros2idl':
            types.register(get_types_from_idl(text))
            text, _ = types.generate_msgdef(type_name, ros_version=2)
        else:
            types.register(get_types_from_msg(text, type_name))
        return Definition(type_name, text, types.hash_rihs01(type_name))
    except FAULTS:
        note = (
            f"The definition of '{type_name}' cannot be read; its messages are kept as they are."
        )
        notes += [note] if note not in notes else []
        return Definition(type_name, text, '')


def from_store(type_name: str, types: Typestore, notes: list[str]) -> Definition:
    """Return a type's definition from a store, or an empty one where nobody has it."""
    for store in (types, jazzy()):
        if type_name in store.fielddefs:
            text, _ = store.generate_msgdef(type_name, ros_version=2)
            return Definition(type_name, text, store.hash_rihs01(type_name))
    notes.append(
        f"Neither the bag nor ROS 2 Jazzy defines '{type_name}'; its messages are kept as bytes."
    )
    return Definition(type_name, '', '')
