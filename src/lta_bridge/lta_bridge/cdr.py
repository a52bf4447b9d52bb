"""
Serialize messages to CDR with reproducible bytes.

The format is classic CDR (XCDR1 of DDS-XTypes), little endian, with a four-byte encapsulation
header. Each number is aligned to its size, counted from the end of the header. Padding is zero,
also at the end, which is padded to a multiple of four. rclpy's `serialize_message` leaves
uninitialized memory in the padding and returns the type's largest size, so its bytes vary.

ROS is not imported: a message is any object with rosidl's `get_fields_and_field_types`.
"""

from collections.abc import Callable, Hashable, Iterable
from functools import cache
import re
import struct
from typing import Any, cast

import numpy as np

ENCAPSULATION = b'\x00\x01\x00\x00'  # CDR, little endian, no options
BASE = len(ENCAPSULATION)
NUMBERS = {  # rosidl type name to `struct` format
    'boolean': '?',
    'octet': 'B',
    'uint8': 'B',
    'int8': 'b',
    'uint16': 'H',
    'int16': 'h',
    'uint32': 'I',
    'int32': 'i',
    'uint64': 'Q',
    'int64': 'q',
    'float': 'f',
    'double': 'd',
}
_ARRAY = re.compile(r'(.+)\[(\d+)\]')
_SEQUENCE = re.compile(r'sequence<([^,>]+)(?:, *\d+)?>')
_LENGTH = struct.Struct('<I')

Writer = Callable[[bytearray, Any], None]


def encode_cdr(message: Any) -> bytes:  # noqa: ANN401 - a generated class
    """Return a message as CDR with its encapsulation header."""
    out = bytearray(ENCAPSULATION)
    _write_message(out, message)
    # As rmw does, but always with zeros
    _pad_to_multiple(out, 4)
    return bytes(out)


def _write_message(out: bytearray, message: Any) -> None:  # noqa: ANN401 - a generated class
    for name, write in _list_fields(type(message)):  # type: ignore[arg-type]
        write(out, getattr(message, name))


# Types are inspected once: this is called for every message
@cache
def _list_fields(kind: Hashable) -> tuple[tuple[str, Writer], ...]:
    """Return the fields of a message type in order, each with its write function."""
    types = cast('Any', kind).get_fields_and_field_types()
    return tuple((name, _select_writer(text)) for name, text in types.items())


def _select_writer(text: str) -> Writer:
    """Return the function that writes a value of a rosidl type."""
    array, sequence = _ARRAY.fullmatch(text), _SEQUENCE.fullmatch(text)
    if sequence is not None:
        return _build_sequence_writer(_build_items_writer(sequence.group(1)))
    if array is not None:
        return _build_items_writer(array.group(1))
    if text in NUMBERS:
        return _build_number_writer(NUMBERS[text])
    return _write_text if text.startswith('string') else _write_message


def _pad_to_multiple(out: bytearray, size: int) -> None:
    """Pad with zeros to a multiple of a size, counted from the end of the header."""
    out.extend(bytes(-(len(out) - BASE) % size))


def _build_number_writer(code: str) -> Writer:
    pack = struct.Struct(f'<{code}')

    def write(out: bytearray, value: Any) -> None:  # noqa: ANN401 - a number, or one byte
        _pad_to_multiple(out, pack.size)
        # rclpy represents an octet as bytes of length one
        out.extend(pack.pack(value[0] if isinstance(value, bytes) else value))

    return write


def _write_text(out: bytearray, value: str) -> None:
    data = value.encode()
    _pad_to_multiple(out, 4)
    out.extend(_LENGTH.pack(len(data) + 1) + data + b'\0')  # the length counts the final zero


def _build_sequence_writer(write_items: Writer) -> Writer:
    """Return a function that writes the number of items, then the items."""

    def write(out: bytearray, value: Any) -> None:  # noqa: ANN401 - a sequence of any kind
        _pad_to_multiple(out, 4)
        out.extend(_LENGTH.pack(len(value)))
        if len(value):  # an empty sequence is not padded to the alignment of its items
            write_items(out, value)

    return write


def _build_items_writer(text: str) -> Writer:
    """Return a function that writes consecutive items of one type."""
    if text not in NUMBERS:
        one = _select_writer(text)

        def write_each(out: bytearray, value: Iterable[Any]) -> None:
            for item in value:
                one(out, item)

        return write_each
    kind = np.dtype(f'<{NUMBERS[text]}')

    def write_numbers(out: bytearray, value: Any) -> None:  # noqa: ANN401 - numbers of any kind
        _pad_to_multiple(out, kind.itemsize)
        out.extend(np.asarray(value, dtype=kind).tobytes())

    return write_numbers
