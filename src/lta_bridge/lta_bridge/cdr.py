"""
Serialize messages to CDR with reproducible bytes, by rosbags.

rosbags writes zeros as padding. rclpy's `serialize_message` leaves uninitialized memory there and
returns the type's largest size, so its bytes vary. The end is padded to a multiple of four, as
rmw does.

rosbags reads the fields of rclpy's messages like those of its own classes, with two exceptions: a
sequence of numbers must be a numpy array, and an octet a number. rclpy has `array.array` or list,
and bytes.
"""

from collections.abc import Callable, Mapping
from functools import cache
from types import SimpleNamespace
from typing import Any

from lta_bridge.bag.schemas import load_jazzy_types
import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.serde.utils import ndtype

Convert = Callable[[Any], Any]


def encode_cdr(message: Any) -> bytes:  # noqa: ANN401 - a generated class
    """Return a message of rclpy as CDR with its encapsulation header."""
    name = _name_type(type(message))
    return _write_cdr(_convert_message(message, name), name)


def reencode_cdr(data: bytes, type_name: str) -> bytes:
    """
    Return CDR as `encode_cdr` writes it.

    Raises
    ------
    SerdeError
        If the data are no message of the type.

    """
    return _write_cdr(load_jazzy_types().deserialize_cdr(data, type_name), type_name)


def _write_cdr(message: object, type_name: str) -> bytes:
    data = load_jazzy_types().serialize_cdr(message, type_name, little_endian=True)
    return bytes(data) + bytes(-len(data) % 4)


def _name_type(kind: type) -> str:
    """Return the name of a message class, such as 'sensor_msgs/msg/Imu'."""
    package, part, *_ = kind.__module__.split('.')
    return f'{package}/{part}/{kind.__name__}'


def _convert_message(message: Any, type_name: str) -> Any:  # noqa: ANN401 - a generated class
    """Return an object with the fields that rosbags expects; the message itself if it has them."""
    conversions = _list_conversions(type_name)
    if not conversions:
        return message
    fields = {name: getattr(message, name) for name in message.get_fields_and_field_types()}
    fields |= {name: convert(fields[name]) for name, convert in conversions.items()}
    return SimpleNamespace(**fields)


# Types are inspected once: this is called for every message
@cache
def _list_conversions(type_name: str) -> Mapping[str, Convert]:
    """Return how to convert the fields of a type that rosbags takes in another form than rclpy."""
    _, fields = load_jazzy_types().fielddefs[type_name]
    each = {name: _choose_conversion(description) for name, description in fields}
    return {name: convert for name, convert in each.items() if convert is not None}


def _choose_conversion(description: Any) -> Convert | None:  # noqa: ANN401 - as rosbags nests it
    """Return the function that converts a field, or None if the field needs none."""
    node, about = description
    if node == Nodetype.NAME:
        name = str(about)
        return (lambda value: _convert_message(value, name)) if _list_conversions(name) else None
    if node == Nodetype.BASE:
        # rclpy represents an octet as bytes of length one
        return (lambda value: value[0]) if about[0] in ('byte', 'octet') else None
    item = about[0]
    convert = _choose_conversion(item)
    if item[0] == Nodetype.BASE and item[1][0] != 'string':
        dtype = np.dtype(ndtype(item[1][0]))
        if convert is not None:
            return lambda value: np.frombuffer(b''.join(value), dtype=dtype)
        return lambda value: np.asarray(value, dtype=dtype)
    return None if convert is None else lambda value: [convert(one) for one in value]
