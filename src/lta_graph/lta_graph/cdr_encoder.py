"""
Encode messages as CDR with reproducible bytes.

Padding is zero. rclpy's `serialize_message` leaves uninitialized memory there, so its bytes vary.
The end is padded to a multiple of four, as rmw does.

A message is packed by `struct` in few calls: the fields between two sequences of messages are one
layout, which depends on the lengths of their texts and arrays, and is built once for each. The
function that reads the fields is generated, which is faster than a loop over their names.
"""

from collections.abc import Callable
from functools import cache, lru_cache
from importlib import import_module
from operator import attrgetter
import re
from struct import Struct
from typing import Any, final

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


# Appends the bytes of some fields of a message, which begin at an offset modulo `ALIGNMENT`, and
# returns that of the end
Encode = Callable[[Any, int, list[bytes]], int]


def encode_cdr(message: Any) -> bytes:  # noqa: ANN401 - a generated class
    """Return a message of rclpy as CDR with its encapsulation header."""
    parts = [HEADER]
    phase = 0
    kind: Any = type(message)
    for encode in _list_parts(kind):
        phase = encode(message, phase, parts)
    parts.append(bytes(-phase % 4))
    return b''.join(parts)


@final
class FlatFields:
    """
    Fields without sequences of messages, those of nested messages among them.

    `fields`: path of the attribute and description of each.
    """

    def __init__(self, fields: list[tuple[str, str]]) -> None:
        # Code, alignment and size of each field; a size of None varies
        self._fields: list[tuple[str, int, int | None]] = []
        self._layouts: dict[tuple[int, ...], Struct] = {}
        # Of the generated function: its lines, the packed values, and the sizes of what varies
        self._lines: list[str] = []
        self._values: list[str] = []
        self._sizes: list[str] = []
        self._owners = {'': 'message'}  # variable of each nested message by its path
        for index, (path, described) in enumerate(fields):
            self._add_field(f'x{index}', self._read_attribute(path), described)

    def build_encoder(self) -> Encode:
        """Return the function that encodes the fields."""
        lines = (
            'def encode(message, phase, parts):',
            *self._lines,
            f'key = ({", ".join(("phase", *self._sizes))},)',
            'layout = layouts.get(key) or build_layout(key)',
            f'parts.append(layout.pack({", ".join(self._values)}))',
            f'return (phase + layout.size) % {ALIGNMENT}',
        )
        space: dict[str, Any] = {
            'layouts': self._layouts,
            'build_layout': self._build_layout,
            'encode_text': _encode_text,
            'encode_texts': _encode_texts,
            'encode_numbers': _encode_numbers,
        }
        exec('\n    '.join(lines), space)
        return space['encode']  # type: ignore[no-any-return]

    def _read_attribute(self, path: str) -> str:
        """Return the expression of an attribute; the messages that hold it are read once."""
        owner, _, name = path.rpartition('.')
        if owner not in self._owners:
            holder = self._read_attribute(owner)
            variable = f'm{len(self._owners)}'
            self._lines.append(f'{variable} = {holder}')
            self._owners[owner] = variable
        return f'{self._owners[owner]}.{name}'

    def _add_field(self, own: str, value: str, described: str) -> None:
        opened, item, size = parse_field(described)
        if item == 'string':
            if size:
                raise TypeError(f'The field type {described} cannot be encoded.')
            self._fields.append(('s', 4 if opened else 1, None))
            self._add_blob(own, value, 'encode_texts' if opened else 'encode_text', varies=True)
            return
        code = NUMBERS[item]
        width = Struct(f'<{code}').size
        if not opened and not size:
            self._fields.append((code, width, width))
            self._values.append(value)
            return
        self._fields.append(('s', width, None if opened else width * size))
        self._add_blob(own, value, 'encode_numbers', varies=opened)

    def _add_blob(self, own: str, value: str, convert: str, *, varies: bool) -> None:
        """Add the line that encodes a text or an array; if its size varies, pack its length."""
        self._lines.append(f'{own}, n{own} = {convert}({value})')
        if varies:
            self._sizes.append(f'len({own})')
            self._values.append(f'n{own}')
        self._values.append(own)

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
            for encode in self._item:
                phase = encode(item, phase, parts)
        return phase


@cache
def _list_parts(kind: Any) -> list[Encode]:  # noqa: ANN401 - a generated class
    """Return the encoders of a message type; cached, since types are inspected for long."""
    parts: list[Encode] = []
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
                parts.append(FlatFields(flat).build_encoder())
                flat.clear()
            parts.append(MessageSequence(path, inner, opened).encode)

    collect(kind, '')
    if flat:
        parts.append(FlatFields(flat).build_encoder())
    return parts


def parse_field(described: str) -> tuple[bool, str, int]:
    """Return whether a field is a sequence, the type of its items, and its fixed size or 0."""
    match = FIELD.fullmatch(described)
    if match is None:
        raise TypeError(f'The field type {described} cannot be encoded.')
    return match['open'] is not None, match['item'], int(match['size'] or 0)


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
