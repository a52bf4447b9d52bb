"""
Encode messages as CDR with reproducible bytes.

Padding is zero. rclpy's `serialize_message` leaves uninitialized memory there, so its bytes vary.
The end is padded to a multiple of four, as rmw does.

A message is packed by `struct` in few calls: the fields between two sequences of messages are one
layout, which depends on the lengths of their texts and arrays, and is built once for each.
"""

from collections.abc import Callable
from functools import cache, lru_cache
from importlib import import_module
from operator import attrgetter
import re
from struct import Struct
from typing import Any, final, Protocol

HEADER = b'\0\1\0\0'  # encapsulation: CDR, little-endian
ALIGNMENT = 8  # bytes of the largest number
NUMBERS = {
    'boolean': '?',
    'octet': 'c',
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
# A field as rclpy describes it: `T`, `T[3]`, `sequence<T>` or `sequence<T, 3>`
FIELD = re.compile(r'(?P<open>sequence<)?(?P<item>[\w/]+)(?:, \d+)?>?(?:\[(?P<size>\d+)\])?')


class CdrPart(Protocol):
    """Some consecutive fields of a message type."""

    def encode(self, message: Any, phase: int, parts: list[bytes]) -> int:  # noqa: ANN401
        """Append the bytes that begin at an offset modulo `ALIGNMENT`; return that of the end."""
        ...


def encode_cdr(message: Any) -> bytes:  # noqa: ANN401 - a generated class
    """Return a message of rclpy as CDR with its encapsulation header."""
    parts = [HEADER]
    phase = 0
    kind: Any = type(message)
    for part in _list_parts(kind):
        phase = part.encode(message, phase, parts)
    parts.append(bytes(-phase % 4))
    return b''.join(parts)


@final
class FlatFields:
    """
    Fields without sequences of messages, those of nested messages among them.

    `fields`: path of the attribute and description of each.
    """

    def __init__(self, fields: list[tuple[str, str]]) -> None:
        self._get = attrgetter(*(path for path, _ in fields))
        self._several = len(fields) > 1
        # Code, alignment and size of each field; a size of None varies
        self._fields: list[tuple[str, int, int | None]] = []
        # Index of each array or text, and the function that returns its bytes and length
        self._blobs: list[tuple[int, Callable[[Any], tuple[bytes, int]], bool]] = []
        for index, (_, described) in enumerate(fields):
            self._add_field(index, described)
        self._layouts: dict[tuple[int, ...], Struct] = {}

    def _add_field(self, index: int, described: str) -> None:
        opened, item, size = parse_field(described)
        if item == 'string':
            if size:
                raise TypeError(f'The field type {described} cannot be encoded.')
            self._fields.append(('s', 4 if opened else 1, None))
            self._blobs.append((index, _encode_texts if opened else _encode_text, True))
            return
        code = NUMBERS[item]
        width = Struct(f'<{code}').size
        if not opened and not size:
            self._fields.append((code, width, width))
            return
        self._fields.append(('s', width, None if opened else width * size))
        self._blobs.append((index, _encode_numbers, opened))

    def encode(self, message: Any, phase: int, parts: list[bytes]) -> int:  # noqa: ANN401
        """Append the bytes of the fields."""
        found = self._get(message)
        values: list[Any] = []
        key = [phase]
        begin = 0
        for index, convert, varies in self._blobs:
            data, length = convert(found[index] if self._several else found)
            values += found[begin:index] if self._several else ()
            if varies:
                key.append(len(data))
                values.append(length)
            values.append(data)
            begin = index + 1
        values += found[begin:] if self._several else () if self._blobs else (found,)
        known = tuple(key)
        layout = self._layouts.get(known) or self._build_layout(known)
        parts.append(layout.pack(*values))
        return (phase + layout.size) % ALIGNMENT

    def _build_layout(self, key: tuple[int, ...]) -> Struct:
        """Return the layout from the phase of its begin and the sizes of what varies."""
        begin, *sizes = key
        words, at, left = ['<'], begin, iter(sizes)

        def align(width: int) -> None:
            nonlocal at
            words.append(f'{-at % width}x')
            at += -at % width

        for code, width, fixed in self._fields:
            size = fixed
            if size is None:
                align(4)
                words.append('I')
                at += 4
                size = next(left)
            # Nothing is aligned for an empty sequence
            if size:
                align(width)
            words.append(f'{size}s' if code == 's' else code)
            at += size
        layout = self._layouts[key] = Struct(''.join(words))
        return layout


@final
class MessageSequence:
    """One field that holds messages: a sequence or an array of fixed size."""

    def __init__(self, path: str, kind: Any, counted: bool) -> None:  # noqa: ANN401 - generated
        self._get = attrgetter(path)
        self._item = _list_parts(kind)
        self._counted = counted

    def encode(self, message: Any, phase: int, parts: list[bytes]) -> int:  # noqa: ANN401
        """Append the bytes of the messages."""
        items = self._get(message)
        if self._counted:
            gap = bytes(-phase % 4)
            parts.append(gap + len(items).to_bytes(4, 'little'))
            phase = (phase + len(gap) + 4) % ALIGNMENT
        for item in items:
            for part in self._item:
                phase = part.encode(item, phase, parts)
        return phase


@cache
def _list_parts(kind: Any) -> list[CdrPart]:  # noqa: ANN401 - a generated class
    """Return the parts of a message type; cached, since types are inspected for long."""
    parts: list[CdrPart] = []
    flat: list[tuple[str, str]] = []

    def collect(kind: Any, prefix: str) -> None:  # noqa: ANN401 - a generated class
        for name, described in kind.get_fields_and_field_types().items():
            # The slot behind the property, whose getter is a function of Python
            path = f'{prefix}_{name}'
            opened, item, size = parse_field(described)
            if '/' not in item:
                flat.append((path, described))
                continue
            inner = import_item_class(item)
            if not opened and not size:
                collect(inner, f'{path}.')
                continue
            if flat:
                parts.append(FlatFields(flat.copy()))
                flat.clear()
            parts.append(MessageSequence(path, inner, opened))

    collect(kind, '')
    if flat:
        parts.append(FlatFields(flat))
    return parts


def parse_field(described: str) -> tuple[bool, str, int]:
    """Return whether a field is a sequence, the type of its items, and its fixed size or 0."""
    found = FIELD.fullmatch(described)
    if found is None:
        raise TypeError(f'The field type {described} cannot be encoded.')
    return found['open'] is not None, found['item'], int(found['size'] or 0)


def import_item_class(item: str) -> Any:  # noqa: ANN401 - a generated class
    """Return the class of a nested message, whose type is as `parse_field` returns it."""
    package, _, message = item.partition('/')
    return getattr(import_module(f'{package}.msg'), message)


@lru_cache(maxsize=1000)
def _encode_text(text: str) -> tuple[bytes, int]:
    data = text.encode() + b'\0'
    return data, len(data)


def _encode_texts(texts: list[str]) -> tuple[bytes, int]:
    return _join_texts(tuple(texts)), len(texts)


@lru_cache(maxsize=1000)
def _join_texts(texts: tuple[str, ...]) -> bytes:
    """Return texts with their lengths; it begins at a multiple of four."""
    joined = b''
    for text in texts:
        data, size = _encode_text(text)
        joined += bytes(-len(joined) % 4) + size.to_bytes(4, 'little') + data
    return joined


def _encode_numbers(numbers: Any) -> tuple[bytes, int]:  # noqa: ANN401 - as rclpy holds them
    # numpy or array.array, but lists for octets and for flags
    if hasattr(numbers, 'tobytes'):
        return numbers.tobytes(), len(numbers)
    if not numbers or isinstance(numbers[0], bytes):
        return b''.join(numbers), len(numbers)
    return bytes(numbers), len(numbers)
