"""
Decode messages faster than rclpy, to the same objects.

rclpy makes each part of a message with default values, and replaces them by the parts that were
received: 44 us for an `Odometry`. A function that is generated once per type fills the slots of
the classes directly, in 4 us. Only the plain CDR that rmw_fastrtps writes is decoded here;
anything else goes through rclpy, with its errors.
"""

from array import array
from collections.abc import Callable
from functools import cache
from importlib import import_module
import struct
from typing import Any, Final

import numpy as np
from rclpy.serialization import deserialize_message
from rosidl_parser.definition import (
    AbstractString,
    Array,
    BasicType,
    NamespacedType,
)

CODES: Final = {
    'boolean': '?', 'octet': 'c', 'int8': 'b', 'uint8': 'B', 'int16': 'h', 'uint16': 'H',
    'int32': 'i', 'uint32': 'I', 'int64': 'q', 'uint64': 'Q', 'float': 'f', 'double': 'd',
}  # fmt: skip
HEAD: Final = 4  # bytes before the content, which alignment counts from
PLAIN: Final = b'\x00\x01'  # little-endian CDR


@cache
def build_decoder(kind: type) -> Callable[[bytes], Any]:
    """
    Return the function that decodes the messages of a type.

    The objects are those of `rclpy.serialization.deserialize_message`, which decodes what is not
    plain little-endian CDR, and raises the errors of damaged messages.
    """
    source = _DecoderSource()
    result = source.add_message(kind)
    lines = ['def decode(data):', '    p = 0', *source.lines]
    lines += ['    if p > len(data):', '        raise ValueError', f'    return {result}']
    space = source.names
    exec(compile('\n'.join(lines), f'<decoder of {kind.__name__}>', 'exec'), space)
    decode = space['decode']

    def decode_message(data: bytes) -> Any:  # noqa: ANN401 - a generated class
        if data[:2] == PLAIN:
            try:
                return decode(memoryview(data)[HEAD:])
            except (struct.error, ValueError):
                pass
        return deserialize_message(data, kind)

    return decode_message


class _DecoderSource:
    """
    Source of a decoder: `p` is the position in `data`, known modulo `step` as `rest`.

    Numbers that follow each other are read by one call, with the padding between them.
    """

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.names: dict[str, Any] = {'array': array, 'frombuffer': np.frombuffer}
        self._indent = '    '
        self._count = 0
        self._step, self._rest = 8, 0
        self._format, self._targets = '<', []  # of the numbers to read next

    def add_message(self, kind: type) -> str:
        """Add the fields of a message, and return the variable with it."""
        fields = [
            (slot, self._add_value(value))
            for slot, value in zip(kind.__slots__, kind.SLOT_TYPES, strict=False)
        ]
        self._read_numbers()
        message, make = self._name('m'), self._name('new')
        self.names[make], self.names[f'{make}_type'] = kind.__new__, kind
        self._write(f'{message} = {make}({make}_type)')
        for slot, variable in fields:
            self._write(f'{message}.{slot} = {variable}')
        if '_check_fields' in kind.__slots__:
            self._write(f'{message}._check_fields = {kind()._check_fields}')
        return message

    def _add_value(self, kind: Any) -> str:  # noqa: ANN401 - a type of rosidl_parser
        if isinstance(kind, BasicType):
            return self._add_number(CODES[kind.typename])
        if isinstance(kind, NamespacedType):
            return self.add_message(getattr(import_module('.'.join(kind.namespaces)), kind.name))
        if isinstance(kind, AbstractString):
            return self._add_string()
        fixed = isinstance(kind, Array)
        count = str(kind.size) if fixed else self._add_number('I')
        self._read_numbers()
        code = CODES.get(getattr(kind.value_type, 'typename', ''), '')
        # rclpy has lists of strings, messages, booleans and octets
        if not code or code in '?c':
            return self._add_loop(kind.value_type, count)
        return self._add_numbers(code, count, fixed)

    def _add_number(self, code: str) -> str:
        size = struct.calcsize(code)
        if self._step % size:
            self._align(size)
        self._format += f'{-self._rest % size}x{code}'
        self._rest = (self._rest + -self._rest % size + size) % self._step
        self._targets.append(variable := self._name('n'))
        return variable

    def _read_numbers(self) -> None:
        if not self._targets:
            return
        reader = self._name('read')
        form = struct.Struct(self._format)
        self.names[reader] = form.unpack_from
        self._write(f'{", ".join(self._targets)}, = {reader}(data, p)')
        self._write(f'p += {form.size}')
        self._format, self._targets = '<', []

    def _align(self, size: int) -> None:
        """Read on at a multiple of a size."""
        self._read_numbers()
        self._write(f'p += -p % {size}')
        self._step, self._rest = size, 0

    def _add_string(self) -> str:
        count, text = self._add_number('I'), self._name('s')
        self._read_numbers()
        # The count includes the NUL at the end
        self._write(f"{text} = str(data[p : p + {count} - 1], 'utf-8')")
        self._write(f'p += {count}')
        self._step, self._rest = 1, 0
        return text

    def _add_numbers(self, code: str, count: str, fixed: bool) -> str:
        """Add an array of numbers: rclpy has numpy arrays of fixed, `array` of other lengths."""
        size, variable = struct.calcsize(code), self._name('a')
        if fixed:
            self._align(size)
            self._write(f"{variable} = frombuffer(data, '<{code}', {count}, p).copy()")
        else:
            self._write(f'if {count}:')
            self._write(f'    p += -p % {size}')
            self._write(f"{variable} = array('{code}', bytes(data[p : p + {size} * {count}]))")
        self._write(f'p += {size} * {count}')
        self._step, self._rest = (size, 0) if fixed else (1, 0)
        return variable

    def _add_loop(self, kind: Any, count: str) -> str:  # noqa: ANN401 - as above
        items = self._name('l')
        self._write(f'{items} = []')
        self._write(f'for _ in range({count}):')
        self._indent += '    '
        self._step, self._rest = 1, 0
        item = self._add_value(kind)
        self._read_numbers()
        self._write(f'{items}.append({item})')
        self._indent = self._indent[:-4]
        self._step, self._rest = 1, 0
        return items

    def _name(self, prefix: str) -> str:
        self._count += 1
        return f'{prefix}{self._count}'

    def _write(self, line: str) -> None:
        self.lines.append(self._indent + line)
