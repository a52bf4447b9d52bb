"""
Decode CDR to messages of rclpy: the same as its own decoder returns, several times as fast.

The function that reads a type is generated once. It unpacks the fixed fields between two texts or
sequences by one `struct` layout, of which there is one for each alignment of the begin, and fills
the slots of the messages without their constructors.
"""

from array import array
from collections.abc import Callable, Iterator
from functools import cache
from itertools import count
from struct import error, Struct
from typing import Any, final

from lta_graph.cdr_encoder import ALIGNMENT, HEADER, import_item_class, NUMBERS, parse_field
import numpy as np
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.serialization import deserialize_message

# Returns the message at an offset, and the offset of its end
Read = Callable[[memoryview, int], tuple[Any, int]]


def decode_cdr(data: bytes, kind: Any) -> Any:  # noqa: ANN401 - a generated class
    """
    Return the message of a class that CDR with its encapsulation header holds.

    Raise `ValueError` if it holds none, also for a sequence that is longer than the data, which
    rclpy returns empty.
    """
    read = _build_reader(kind)
    # Two bytes of options follow the encoding
    if read is None or data[:2] != HEADER[:2]:
        return _deserialize(data, kind)
    body = memoryview(data)[len(HEADER) :]
    try:
        message, end = read(body, 0)
    except (error, ValueError) as fault:
        raise ValueError(f'it is no message of type {kind.__name__} ({fault})') from fault
    if end > len(body):
        raise ValueError(f'it ends within a message of type {kind.__name__}')
    return message


def _deserialize(data: bytes, kind: Any) -> Any:  # noqa: ANN401 - a generated class
    """Return a message by rclpy, for rare fields and other byte orders."""
    try:
        return deserialize_message(data, kind)
    except rclpy_implementation.RMWError as fault:
        raise ValueError(f'it is no message of type {kind.__name__} ({fault})') from fault


@cache
def _build_reader(kind: Any) -> Read | None:  # noqa: ANN401 - a generated class
    """Return the function that reads a message type; None if it has fields of a rare type."""
    try:
        return MessageReader(kind).build_function()
    except TypeError:
        return None


@final
class MessageReader:
    """Write the function that reads a message class; `TypeError` for fields of rare types."""

    def __init__(self, kind: Any) -> None:  # noqa: ANN401 - a generated class
        self._numbers: Iterator[int] = count()
        self._space: dict[str, Any] = {
            'array': array, 'frombuffer': np.frombuffer, 'new': object.__new__,
        }  # fmt: skip
        # Lines that unpack, and those that fill the messages afterwards
        self._lines: list[str] = []
        self._filling: list[str] = []
        # Variables and codes of the fixed fields since the last text or sequence
        self._run: list[tuple[str, str, int]] = []
        self._message = self._add_message(kind)
        self._end_run()

    def build_function(self) -> Read:
        """Return the function."""
        lines = (
            'def read(body, at):',
            *self._lines,
            *self._filling,
            f'return {self._message}, at',
        )
        exec('\n    '.join(lines), self._space)
        return self._space['read']  # type: ignore[no-any-return]

    def _name(self, value: Any = None) -> str:  # noqa: ANN401 - whatever the function needs
        """Return a new variable name; the function reads `value` by it, if given."""
        name = f'v{next(self._numbers)}'
        if value is not None:
            self._space[name] = value
        return name

    def _add_message(self, kind: Any) -> str:  # noqa: ANN401 - a generated class
        """Read a message; return its variable."""
        message = self._name()
        self._filling.append(f'{message} = new({self._name(kind)})')
        if '_check_fields' in kind.__slots__:  # what the constructor sets beside the fields
            self._filling.append(f'{message}._check_fields = {kind()._check_fields}')
        for name, described in kind.get_fields_and_field_types().items():
            field = self._add_field(*parse_field(described))
            self._filling.append(f'{message}._{name} = {field}')
        return message

    def _add_field(self, is_sequence: bool, item: str, size: int) -> str:
        """Read a field; return the expression of its value."""
        if '/' in item and not is_sequence and not size:
            return self._add_message(import_item_class(item))
        if item in NUMBERS and not is_sequence:
            return self._add_array(item, size) if size else self._add_fixed(NUMBERS[item])
        if item == 'string' and not is_sequence and not size:
            return self._add_text()
        length = str(size) if size else self._add_fixed('I')
        self._end_run()
        if item in NUMBERS:
            return self._add_numbers(item, length)
        if item != 'string' and '/' not in item:
            raise TypeError(f'The field type {item} cannot be decoded.')
        return self._add_list(item, length)

    def _add_fixed(self, code: str, width: int | None = None) -> str:
        """Add a field of fixed size to the present run."""
        name = self._name()
        self._run.append((name, code, width or Struct(f'<{code}').size))
        return name

    def _add_array(self, item: str, size: int) -> str:
        """Add an array of fixed size, which rclpy holds as an array of numpy or as a list."""
        code = NUMBERS[item]
        width = Struct(f'<{code}').size
        if code in 'c?':
            return f'[{", ".join(self._add_fixed(code) for _ in range(size))}]'
        values = self._add_fixed(f'{size * width}s', width)
        kind = np.dtype({'float': 'float32', 'double': 'float64'}.get(item, item))
        return f'frombuffer({values}, {self._name(kind)}).copy()'

    def _add_text(self) -> str:
        length = self._add_fixed('I')
        self._end_run()
        text = self._name()
        read = self._name(_cut_text)
        self._lines.append(f'{text} = {read}(body[at : at + {length}])')
        self._lines.append(f'at += {length}')
        return text

    def _add_numbers(self, item: str, length: str) -> str:
        """Add a sequence of numbers, which rclpy holds as `array.array` or as a list."""
        code = NUMBERS[item]
        width, values = Struct(f'<{code}').size, self._name()
        # Nothing is aligned for an empty sequence
        if width > 1:
            self._lines.append(f'at += -at % {width} if {length} else 0')
        end = f'at + {width} * {length}'
        if code == 'c':
            self._lines.append(f'{values} = [bytes([x]) for x in body[at : {end}]]')
        elif code == '?':
            self._lines.append(f'{values} = list(map(bool, body[at : {end}]))')
        else:
            self._lines.append(f"{values} = array('{code}')")
            self._lines.append(f'{values}.frombytes(body[at : {end}])')
        self._lines.append(f'at = {end}')
        return values

    def _add_list(self, item: str, length: str) -> str:
        """Add texts or messages."""
        read = self._name(_read_text if item == 'string' else _read_item(item))
        values, value = self._name(), self._name()
        self._lines.append(f'{values} = []')
        self._lines.append(f'for _ in range({length}):')
        self._lines.append(f'    {value}, at = {read}(body, at)')
        self._lines.append(f'    {values}.append({value})')
        return values

    def _end_run(self) -> None:
        """Unpack the fixed fields of the present run."""
        if not self._run:
            return
        layouts = [_build_layout(self._run, phase) for phase in range(ALIGNMENT)]
        unpack = self._name([layout.unpack_from for layout in layouts])
        sizes = self._name([layout.size for layout in layouts])
        names = ', '.join(name for name, _, _ in self._run)
        phase = self._name()
        self._lines.append(f'{phase} = at % {ALIGNMENT}')
        self._lines.append(f'{names}, = {unpack}[{phase}](body, at)')
        self._lines.append(f'at += {sizes}[{phase}]')
        self._run.clear()


def _build_layout(run: list[tuple[str, str, int]], phase: int) -> Struct:
    """Return the layout of fixed fields that begin at an offset modulo `ALIGNMENT`."""
    words, at = ['<'], phase
    for _, code, width in run:
        words.append(f'{-at % width}x{code}')
        at += -at % width + Struct(f'<{code}').size
    return Struct(''.join(words))


def _read_item(item: str) -> Read:
    """Return the function that reads the messages of a sequence."""
    return MessageReader(import_item_class(item)).build_function()


def _read_text(body: memoryview, at: int) -> tuple[str, int]:
    """Return a text of a sequence."""
    at += -at % 4
    begin = at + 4
    end = begin + int.from_bytes(body[at:begin], 'little')
    if end > len(body):
        raise ValueError('a text is longer than the data')
    return _cut_text(body[begin:end]), end


def _cut_text(data: memoryview) -> str:
    """Return a text up to its closing zero; as in rclpy, what is no UTF-8 is replaced."""
    return str(data, 'utf-8', 'replace').partition('\0')[0]
