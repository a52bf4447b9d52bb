"""
Encode messages of rclpy for a bag, by rosbags.

The same message has the same bytes, with zeros as padding. rclpy's own `serialize_message` leaves
old memory there, and some more behind the end, with which rosbags refuses the message.
"""

from collections.abc import Callable
from functools import cache
from operator import itemgetter
from types import SimpleNamespace
from typing import Any

from lta_bridge.bag.schemas import load_jazzy_types
import numpy as np
from rosbags.interfaces import Nodetype

Convert = Callable[[Any], Any]


def encode_message(message: Any, type_name: str) -> bytes:  # noqa: ANN401 - a generated class
    """Return a message as CDR, padded to a multiple of four as the middleware does."""
    data = load_jazzy_types().serialize_cdr(_find_adapter(type_name)(message), type_name)
    return bytes(data) + bytes(-len(data) % 4)


def _keep(value: Any) -> Any:  # noqa: ANN401 - of any field
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


def _find_field_adapter(kind: Nodetype, described: Any) -> Convert:  # noqa: ANN401 - of rosbags
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
