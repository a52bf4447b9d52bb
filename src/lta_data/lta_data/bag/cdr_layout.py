# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Derive the layout of serialised messages, once for all messages with the same layout.

In CDR (DDS-XTypes' XCDR1, as used by ROS 2) a number is aligned to its size, counted from behind
the four bytes of encapsulation. So two messages of one type have the same layout if they have the
same length and byte order, and all texts and sequences have the same lengths. Such messages,
stacked as rows, are one numpy array of a structured type.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
import struct
from typing import Any, Final, final, NamedTuple

from lta_data.bag.columns import name_column
import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype

ENCAPSULATION: Final = 4  # bytes before the message
LARGEST_PADDING: Final = 3  # largest padding behind the message, to a multiple of four bytes
BYTE_ORDERS: Final = {
    b'\x00\x00': '>',
    b'\x00\x01': '<',
}  # representation identifier -> byte order
CODES: Final = {  # ROS type -> numpy type
    'bool': '?',
    'byte': 'i1',
    'char': 'u1',
    'int8': 'i1',
    'uint8': 'u1',
    'int16': 'i2',
    'uint16': 'u2',
    'int32': 'i4',
    'uint32': 'u4',
    'int64': 'i8',
    'uint64': 'u8',
    'float32': 'f4',
    'float64': 'f8',
}
TEXT: Final = 'S'
MOST_LEAVES: Final = 4096  # larger messages are read just as fast one by one

Description = tuple[Any, Any]  # as rosbags describes a field's type
Fields = Callable[[str], Sequence[tuple[str, Description]]]


class CdrLeaf(NamedTuple):
    """
    One value or array in a message.

    `code` is its numpy type without byte order; `offset` counts from the first byte of the
    encapsulation; `length` is that of an array or text, None for a single number.
    """

    path: str
    code: str
    offset: int
    length: int | None


class LayoutMismatch(Exception):
    """A message that does not fit its definition, or is too large for a layout."""


@final
@dataclass(slots=True)
class CdrLayout:
    """The layout of a message."""

    size: int  # of the whole message [bytes]
    order: str  # byte order in numpy's notation
    # What becomes columns, in the order of the definition
    leaves: list[CdrLeaf] = field(default_factory=list)
    # Byte arrays, which do not become columns: data of images and point clouds
    packed: list[CdrLeaf] = field(default_factory=list)
    # Offset and value of each length word
    lengths: list[tuple[int, int]] = field(default_factory=list)
    ends: list[int] = field(default_factory=list)  # offsets of the terminating zeros of texts

    def find_matching_messages(self, table: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Return which messages of this size, shape (n, size), have this layout."""
        fits = np.ones(len(table), dtype=np.bool_)
        for offset, value in self.lengths:
            fits &= self.extract_values(table, CdrLeaf('', 'u4', offset, None)) == value
        for offset in self.ends:
            # CDR strings end with a zero byte
            fits &= table[:, offset] == 0
        return fits

    def extract_values(self, table: NDArray[np.uint8], leaf: CdrLeaf) -> NDArray[Any]:
        """
        Return a leaf, other than a text, of messages with this layout, as a view.

        `table`, shape (n, size): one message per row; each row contiguous. The result has shape
        (n,) or (n, length): in the byte order of the message.
        """
        kind = np.dtype(self.order + leaf.code)
        if leaf.length == 0:
            return np.empty((len(table), 0), kind)
        shape = (len(table), leaf.length or 1)
        strides = (table.strides[0], kind.itemsize)
        # A view into the messages, since fields of a packed table are not aligned for numpy
        values: NDArray[Any] = np.ndarray(
            shape, kind, table.data, offset=leaf.offset, strides=strides
        )
        return values[:, 0] if leaf.length is None else values


def derive_layout(type_name: str, data: bytes, fields: Fields) -> CdrLayout:
    """
    Derive the layout of a message.

    Parameters
    ----------
    data : bytes
        The message as CDR with its encapsulation.
    fields : callable
        Returns the fields of a message type: name and rosbags' description of the type.

    Raises
    ------
    LayoutMismatch
        If the message does not fit the definition; decoding it as an object gives the reason.

    """
    order = BYTE_ORDERS.get(data[:2])
    if order is None or len(data) < ENCAPSULATION:
        raise LayoutMismatch
    layout = CdrLayout(len(data), order)
    walk = LayoutParser(layout, data, fields)
    try:
        walk.parse_message(type_name, '', True)
    except (struct.error, KeyError, RecursionError) as error:
        raise LayoutMismatch from error
    # More bytes than padding: the definition does not describe this message
    if walk.at + ENCAPSULATION + LARGEST_PADDING < len(data):
        raise LayoutMismatch
    return layout


@final
class LayoutParser:
    """Parses one message and records the offset of each field."""

    def __init__(self, layout: CdrLayout, data: bytes, fields: Fields) -> None:
        self.at = 0  # offset behind the encapsulation, from which CDR aligns
        self._layout = layout
        self._data = data
        self._fields = fields
        self._word = struct.Struct(layout.order + 'I')

    def parse_message(self, type_name: str, path: str, is_column: bool) -> None:
        """Parse a message or a nested message."""
        for name, described in self._fields(type_name):
            column = name_column(type_name, name)
            inside = f'{path}.{column}' if path else column
            self._parse_field(described, inside, is_column and column != '')

    def _parse_field(self, described: Description, path: str, is_column: bool) -> None:
        node, detail = described
        if node is Nodetype.NAME:
            self.parse_message(detail, path, is_column)
        elif node is Nodetype.BASE:
            self._parse_single_value(detail[0], path, is_column)
        else:
            (kind, inner), count = detail
            if node is Nodetype.SEQUENCE:
                count = self._parse_length()
            if kind is Nodetype.BASE and inner[0] != 'string':
                self._parse_array(inner[0], count, path, is_column)
                return
            # A length beyond the message is damage; do not loop over it.
            if count > len(self._data):
                raise LayoutMismatch
            for index in range(count):
                self._parse_field((kind, inner), f'{path}[{index}]', is_column)

    def _parse_single_value(self, name: str, path: str, is_column: bool) -> None:
        if name == 'string':
            count = self._parse_length() - 1
            self._add_leaf(
                CdrLeaf(path, TEXT, self.at + ENCAPSULATION, count), count + 1, is_column
            )
            if count < 0:
                raise LayoutMismatch
            self._layout.ends.append(self.at + ENCAPSULATION - 1)
            return
        size = np.dtype(CODES[name]).itemsize
        self._align(size)
        self._add_leaf(CdrLeaf(path, CODES[name], self.at + ENCAPSULATION, None), size, is_column)

    def _parse_array(self, name: str, count: int, path: str, is_column: bool) -> None:
        size = np.dtype(CODES[name]).itemsize
        # An empty sequence has no padding.
        if count:
            self._align(size)
        leaf = CdrLeaf(path, CODES[name], self.at + ENCAPSULATION, count)
        # uint8 arrays are packed, such as pixels, and become no columns
        if leaf.code == 'u1':
            self._layout.packed.append(leaf)
            is_column = False
        self._add_leaf(leaf, size * count, is_column)

    def _parse_length(self) -> int:
        self._align(4)
        offset = self.at + ENCAPSULATION
        (length,) = self._word.unpack_from(self._data, offset)
        self._layout.lengths.append((offset, length))
        self.at += 4
        return int(length)

    def _align(self, size: int) -> None:
        # CDR aligns each primitive to its own size
        self.at += -self.at % size

    def _add_leaf(self, leaf: CdrLeaf, size: int, is_column: bool) -> None:
        """Add a leaf and advance behind it."""
        self.at += size
        leaves = self._layout.leaves
        if self.at + ENCAPSULATION > len(self._data) or len(leaves) >= MOST_LEAVES:
            raise LayoutMismatch
        if is_column:
            leaves.append(leaf)
