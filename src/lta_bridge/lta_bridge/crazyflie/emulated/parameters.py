"""Parameters: read, written and set by name (port 2)."""

import errno
import struct
from typing import final

from lta_bridge.crazyflie.emulated.contents import (
    BASIC,
    Contents,
    packer,
    Parameter,
    PARAMETER_TYPES,
    READ_ONLY,
)

READ, WRITE, OTHER = 1, 2, 3  # channels


@final
class Parameters:
    """
    The parameters' values.

    Parameters
    ----------
    contents : Contents
        What there is.

    """

    def __init__(self, contents: Contents[Parameter]) -> None:
        self._contents = contents
        self.values = {entry.name: entry.default for entry in contents.entries}

    def answer(self, channel: int, data: bytes) -> bytes | None:
        """Return what is answered on one of the three channels; None for no answer."""
        if channel == READ and len(data) >= 2:
            return self._read(data[:2])
        if channel == WRITE and len(data) >= 2:
            return self._write(data[:2], data[2:])
        if channel == OTHER and data:
            return self._other(data)
        return None

    def _entry(self, number: bytes) -> Parameter | None:
        which = int.from_bytes(number, 'little')
        entries = self._contents.entries
        return entries[which] if which < len(entries) else None

    def _packed(self, entry: Parameter) -> bytes:
        return packer(PARAMETER_TYPES[entry.kind & BASIC], self.values[entry.name])

    def _read(self, number: bytes) -> bytes:
        entry = self._entry(number)
        if entry is None:
            return number + bytes([errno.ENOENT])
        return number + b'\0' + self._packed(entry)

    def _write(self, number: bytes, value: bytes) -> bytes | None:
        entry = self._entry(number)
        if entry is None:
            return number + bytes([errno.ENOENT])
        if entry.kind & READ_ONLY or not self._store(entry, value):
            return None  # as the firmware: no word at all
        return number + self._packed(entry)

    def _store(self, entry: Parameter, value: bytes) -> bool:
        kind = '<' + PARAMETER_TYPES[entry.kind & BASIC]
        if len(value) < struct.calcsize(kind):
            return False
        (self.values[entry.name],) = struct.unpack_from(kind, value)
        return True

    def _other(self, data: bytes) -> bytes | None:
        what, number = data[0], data[1:3]
        if what == 0:
            return self._set_by_name(data)
        entry = self._entry(number)
        if len(number) < 2:
            return None
        if entry is None:
            return data[:3] + bytes([errno.ENOENT])
        default = packer(PARAMETER_TYPES[entry.kind & BASIC], entry.default)
        answers = {2: b'\x01', 3: b'\0', 5: b'\0', 7: b'\0\x01', 4: b'\0' + default}
        return data[:3] + answers.get(what, b'\0' + default)

    def _set_by_name(self, data: bytes) -> bytes:
        group, _, rest = data[1:].partition(b'\0')
        name, _, value = rest.partition(b'\0')
        which = self._contents.numbers.get(f'{group.decode("latin")}.{name.decode("latin")}')
        entry = None if which is None else self._contents.entries[which]
        done = entry is not None and not entry.kind & READ_ONLY and self._store(entry, value[1:])
        return data[: 3 + len(group) + len(name)] + bytes([0 if done else errno.ENOENT])
