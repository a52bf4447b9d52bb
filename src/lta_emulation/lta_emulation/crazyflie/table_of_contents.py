"""Tables of contents of a Crazyflie: log variables and parameters."""

from collections.abc import Callable, Sequence
import struct
from typing import Generic, NamedTuple, TypeVar
import zlib

Entry = TypeVar('Entry', bound='LogVariable | FirmwareParameter')

# Type numbers of the two tables are not the same (firmware: log.h, param.h).
LOG_TYPES = {1: 'B', 2: 'H', 3: 'I', 4: 'b', 5: 'h', 6: 'i', 7: 'f', 8: 'e'}
PARAMETER_TYPES = {
    0x08: 'B', 0x09: 'H', 0x0A: 'I', 0x0B: 'Q', 0x00: 'b', 0x01: 'h', 0x02: 'i', 0x03: 'q',
    0x05: 'e', 0x06: 'f', 0x07: 'd',
}  # fmt: skip
BASIC = 0x0F  # bits of a parameter's type that define its encoding
EXTENDED, CORE, READ_ONLY = 0x10, 0x20, 0x40


class LogVariable(NamedTuple):
    """A variable that can be logged: `group.name`, its type, and where its value comes from."""

    name: str
    kind: int


class FirmwareParameter(NamedTuple):
    """A parameter: `group.name`, its type with flags, and its value at the start."""

    name: str
    kind: int
    default: float


class TableOfContents(Generic[Entry]):
    """
    One table, served on channel 0 of ports 2 and 5.

    `entries`: in the order of their numbers. `limits`: bytes that follow the CRC in the table's
    header.
    """

    def __init__(self, entries: Sequence[Entry], limits: bytes = b'') -> None:
        self.entries = tuple(entries)
        self._limits = limits
        self.numbers = {entry.name: number for number, entry in enumerate(self.entries)}

    @property
    def crc(self) -> int:
        """Checksum of the table; cflib caches tables by it."""
        # Not the firmware's checksum, but one that changes with the table is sufficient
        return zlib.crc32(repr(self.entries).encode())

    def answer_request(self, question: bytes) -> bytes | None:
        """Return the answer to a request of version 2; None if the request is unknown."""
        # Requests of version 2: 3 is the header of the table, 2 an entry
        if question[:1] == b'\x03':
            return struct.pack('<BHI', 3, len(self.entries), self.crc) + self._limits
        if question[:1] != b'\x02':
            return None
        number = int.from_bytes(question[1:3], 'little')
        if number >= len(self.entries):
            return b'\x02'
        entry = self.entries[number]
        group, name = entry.name.split('.')
        return struct.pack('<BHB', 2, number, entry.kind) + f'{group}\0{name}\0'.encode()


def pack_value(kind: str, value: float) -> bytes:
    """Return one value as the firmware packs it: integers wrap, floats stay."""
    if kind in 'efd':
        return struct.pack('<' + kind, value)
    width = struct.calcsize(kind)
    # Two's complement of the lowest bytes
    bits = int(value) & ((1 << 8 * width) - 1)
    return bits.to_bytes(width, 'little')


Reader = Callable[[str], float]
