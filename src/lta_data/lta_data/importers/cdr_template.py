"""
Serialise many messages of one type at once from a CDR template.

Messages of one imported topic differ only in their numbers; texts and list lengths are equal. So
one message is serialised, and the others are copies of it with numbers written at the offsets that
the layout for reading has (`lta_data.bag.cdr_layout`).
"""

from collections.abc import Mapping, Sequence
from typing import Any, final

from lta_bridge.bag.schemas import load_jazzy_types
from lta_data.bag.cdr_layout import CODES, derive_layout, TEXT
import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype

Constants = Mapping[str, Sequence[str] | str | float]


@final
class CdrTemplate:
    """
    The bytes of one message of a ROS 2 Jazzy type, and the offsets of its numbers.

    Parameters
    ----------
    type_name : str
        For example 'nav_msgs/msg/Odometry'.
    constants : mapping of str to text, number or list of texts
        Values equal in all messages, by path: 'header.frame_id', 'name'.
    lengths : mapping of str to int
        Lengths of numeric lists by path; 0 by default.

    Attributes
    ----------
    places : dict of str to (int, dtype)
        Offset and type of each number by path: 'pose.pose.position.x', 'effort[0]'.

    """

    def __init__(
        self, type_name: str, constants: Constants, lengths: Mapping[str, int] | None = None
    ) -> None:
        types = load_jazzy_types()
        message = _build_message(type_name, '', constants, lengths or {})
        data = bytes(types.serialize_cdr(message, type_name))
        self._bytes = data + bytes(-len(data) % 4)

        def list_fields(name: str) -> list[tuple[str, Any]]:
            return types.fielddefs[name][1]

        self.places = {
            leaf.path if leaf.length is None else f'{leaf.path}[{index}]': (
                leaf.offset + index * kind.itemsize, kind
            )
            for leaf in derive_layout(type_name, self._bytes, list_fields).leaves
            if leaf.code != TEXT
            for kind in [np.dtype('<' + leaf.code)]
            for index in range(1 if leaf.length is None else leaf.length)
        }  # fmt: skip

    @property
    def size(self) -> int:
        """Size of every message. [bytes]"""
        return len(self._bytes)

    def serialize_messages(self, count: int, numbers: Mapping[str, Any]) -> bytes:
        """
        Return `count` messages, one after the other.

        `numbers` are arrays of shape (count,) or () by path; other fields are as in the template.
        """
        kind = np.dtype(
            {
                'names': list(numbers),
                'formats': [self.places[path][1] for path in numbers],
                'offsets': [self.places[path][0] for path in numbers],
                'itemsize': self.size,
            }
        )
        raw: NDArray[np.uint8] = np.tile(np.frombuffer(self._bytes, dtype=np.uint8), count)
        rows = raw.view(kind)
        for path, values in numbers.items():
            # A structured view writes all messages at once.
            rows[path] = values
        return raw.tobytes()


def _build_message(
    type_name: str, prefix: str, constants: Constants, lengths: Mapping[str, int]
) -> object:
    """Return a message with the constants, and zeros or nothing in its other fields."""
    types = load_jazzy_types()
    values: dict[str, Any] = {}
    for name, (node, detail) in types.fielddefs[type_name][1]:
        path = f'{prefix}{name}'
        if node == Nodetype.NAME:
            values[name] = _build_message(str(detail), f'{path}.', constants, lengths)
        elif node == Nodetype.BASE:
            is_text = detail[0] == 'string'
            values[name] = constants.get(path, '' if is_text else 0)
        elif detail[0][1][0] == 'string':
            values[name] = [*constants.get(path, ())]  # type: ignore[misc]
        else:
            count = int(detail[1]) if node == Nodetype.ARRAY else lengths.get(path, 0)
            values[name] = np.zeros(count, CODES[detail[0][1][0]])
    return types.types[type_name](**values)
