"""
Serialise many messages of one type at once from a CDR template.

Messages of one imported topic differ only in their numbers; texts and list lengths are equal. So
one message is laid out, and the others are copies of it with numbers written at fixed offsets. The
format is classic CDR (XCDR1 of DDS-XTypes), little endian, with zero padding.
"""

from collections.abc import Mapping, Sequence
import struct
from typing import Any, final

from lta_bridge.bag.schemas import load_jazzy_types
import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype

ENCAPSULATION = b'\x00\x01\x00\x00'  # CDR, little endian, no options
BASE = len(ENCAPSULATION)
TYPES = {
    'bool': '?',
    'byte': 'u1',
    'char': 'u1',
    'octet': 'u1',
}  # ROS type -> numpy type, where the names differ
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
        self._constants = constants
        self._lengths = lengths or {}
        self._bytes = bytearray(ENCAPSULATION)
        self.places: dict[str, tuple[int, np.dtype[Any]]] = {}
        self._lay_message(type_name, '')
        self._align(4)

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

    def _lay_message(self, type_name: str, prefix: str) -> None:
        """Lay out all fields of a message."""
        for name, (node, detail) in load_jazzy_types().fielddefs[type_name][1]:
            path = f'{prefix}{name}'
            if node == Nodetype.NAME:
                self._lay_message(str(detail), f'{path}.')
            elif node == Nodetype.BASE:
                self._lay_base(str(detail[0]), path)
            else:
                item, length = detail[0], int(detail[1])
                self._lay_items(str(item[1][0]), path, node == Nodetype.ARRAY, length)

    def _lay_base(self, kind: str, path: str) -> None:
        """Lay out one text or number."""
        if kind == 'string':
            self._lay_text(str(self._constants.get(path, '')))
            return
        # Little-endian, as the encapsulation says
        number = np.dtype(TYPES.get(kind, kind)).newbyteorder('<')
        self._align(number.itemsize)
        # Offset from the start of the message, encapsulation included
        self.places[path] = (len(self._bytes), number)
        self._bytes += np.array(self._constants.get(path, 0), dtype=number).tobytes()

    def _lay_items(self, kind: str, path: str, fixed: bool, length: int) -> None:
        """Lay out an array, or the length and items of a sequence."""
        texts = self._constants.get(path, ())
        if not fixed:
            length = len(texts) if isinstance(texts, Sequence) and texts else 0
            length = length or self._lengths.get(path, 0)
            self._align(4)
            # A sequence begins with its length; a fixed array does not
            self._bytes += struct.pack('<I', length)
        for index in range(length):
            if kind == 'string' and isinstance(texts, Sequence):
                self._lay_text(texts[index])
            else:
                self._lay_base(kind, f'{path}[{index}]')

    def _lay_text(self, text: str) -> None:
        data = text.encode()
        self._align(4)
        self._bytes += struct.pack('<I', len(data) + 1) + data + b'\0'

    def _align(self, size: int) -> None:
        """Pad with zeros to a multiple of `size`, counted from the end of the encapsulation."""
        self._bytes += bytes(-(len(self._bytes) - BASE) % size)
