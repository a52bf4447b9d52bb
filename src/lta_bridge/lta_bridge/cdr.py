"""
Messages as CDR, to the byte as the middleware sends them.

Classic CDR (DDS-XTypes' XCDR1), little endian, behind four bytes of encapsulation: a number stands
at a multiple of its size, counted from behind the encapsulation; the gaps are zero, and so is what
fills the end to a multiple of four. rclpy's own `serialize_message` leaves whatever the memory
held in the gaps and gives the largest size that the type can have, so its bytes do not repeat.

Knows no ROS: a message is anything that tells its fields as rosidl's Python classes do.
"""

from collections.abc import Callable, Hashable, Iterable
from functools import cache
import re
import struct
from typing import Any, cast

import numpy as np

ENCAPSULATION = b'\x00\x01\x00\x00'
BASE = len(ENCAPSULATION)
NUMBERS = {  # by rosidl's name of the type: code of struct
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
    _pad_to_multiple(out, 4)
    return bytes(out)


def _write_message(out: bytearray, message: Any) -> None:  # noqa: ANN401 - a generated class
    for name, write in _list_fields(type(message)):  # type: ignore[arg-type]
        write(out, getattr(message, name))


@cache
def _list_fields(kind: Hashable) -> tuple[tuple[str, Writer], ...]:
    """Return the fields of a message type in order, each with its writer."""
    types = cast('Any', kind).get_fields_and_field_types()
    return tuple((name, _select_writer(text)) for name, text in types.items())


def _select_writer(text: str) -> Writer:
    """Return what writes a value of a type, named as rosidl names it."""
    array, sequence = _ARRAY.fullmatch(text), _SEQUENCE.fullmatch(text)
    if sequence is not None:
        return _build_sequence_writer(_build_items_writer(sequence.group(1)))
    if array is not None:
        return _build_items_writer(array.group(1))
    if text in NUMBERS:
        return _build_number_writer(NUMBERS[text])
    return _write_text if text.startswith('string') else _write_message


def _pad_to_multiple(out: bytearray, size: int) -> None:
    """Fill up with zeros to a multiple of a size, counted from behind the encapsulation."""
    out.extend(bytes(-(len(out) - BASE) % size))


def _build_number_writer(code: str) -> Writer:
    pack = struct.Struct(f'<{code}')

    def write(out: bytearray, value: Any) -> None:  # noqa: ANN401 - a number, or one byte
        _pad_to_multiple(out, pack.size)
        out.extend(pack.pack(value[0] if isinstance(value, bytes) else value))

    return write


def _write_text(out: bytearray, value: str) -> None:
    data = value.encode()
    _pad_to_multiple(out, 4)
    out.extend(_LENGTH.pack(len(data) + 1) + data + b'\0')


def _build_sequence_writer(write_items: Writer) -> Writer:
    """Return what writes the number of items before them."""

    def write(out: bytearray, value: Any) -> None:  # noqa: ANN401 - a sequence of any kind
        _pad_to_multiple(out, 4)
        out.extend(_LENGTH.pack(len(value)))
        if len(value):
            write_items(out, value)

    return write


def _build_items_writer(text: str) -> Writer:
    """Return what writes items of one type, one behind the other."""
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
