# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Emulate the log blocks: variables sent together in periodic packets (port 5)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
import errno
import struct
from typing import final, Generic, NamedTuple, TypeVar
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


BLOCKS, VARIABLES, BYTES = 16, 128, 26  # firmware: log.c
TICK_MS = 10  # unit of the period in a start command


@final
@dataclass(slots=True)
class EmulatedLogBlock:
    """One block."""

    fields: list[tuple[int, int]] = field(default_factory=list)  # number and type of each variable
    period_ms: int = 0  # period of the packets; 0 while stopped [ms]
    due_ms: int = 0  # due time of the next packet [ms]
    once: bool = False  # whether a single packet is due now, in addition

    @property
    def size(self) -> int:
        """Bytes of its values."""
        return sum(struct.calcsize(LOG_TYPES[kind]) for _, kind in self.fields)


@final
class LogBlocks:
    """
    The log subsystem.

    Attribute `refuse`: an errno with which every block is refused; 0 for none. For tests.
    """

    def __init__(self, contents: TableOfContents[LogVariable]) -> None:
        self._contents = contents
        self.blocks: dict[int, EmulatedLogBlock] = {}
        self.refuse = 0

    def run_command(self, data: bytes, size: int, now_ms: int) -> bytes:
        """
        Execute a settings packet; return command, block and errno.

        `data`: all 30 bytes of the buffer: only variables are counted by the packet's length.
        `size`: size of the packet in the buffer [bytes]. `now_ms`: time by the drone's clock [ms].
        """
        what, number = data[0], data[1]
        # For fewer than two bytes the firmware's count of variables exceeds its buffer.
        variables = data[2:size] if size >= 2 else data[2:]
        # Command numbers of the firmware (log.c); 6 to 8 are those of version 2
        done = {
            5: lambda: self.reset(),
            6: lambda: self._create_block(number, variables),
            7: lambda: self._append_variables(number, variables),
            2: lambda: self._delete_block(number),
            3: lambda: self._start_block(number, TICK_MS * data[2], now_ms),
            8: lambda: self._start_block(number, int.from_bytes(data[2:4], 'little'), now_ms),
            4: lambda: self._stop_block(number),
        }.get(what)
        return bytes([what, number, errno.ENOEXEC if done is None else done()])

    def reset(self) -> int:
        """Delete all blocks, as the firmware does after a second without radio."""
        self.blocks.clear()
        return 0

    def _create_block(self, number: int, data: bytes) -> int:
        if self.refuse:
            return self.refuse
        if number in self.blocks:
            return errno.EEXIST
        if len(self.blocks) == BLOCKS:
            return errno.ENOMEM
        self.blocks[number] = EmulatedLogBlock()
        return self._append_variables(number, data)

    def _append_variables(self, number: int, data: bytes) -> int:
        block = self.blocks.get(number)
        if block is None:
            return errno.ENOENT
        # For more than nine variables cflib fills the packet, which leaves a surplus byte.
        for place in range(0, len(data) - 2, 3):
            # The low nibble is the type in the log packet; the high one is the storage type
            kind, which = data[place] & 0x0F, int.from_bytes(data[place + 1 : place + 3], 'little')
            if kind not in LOG_TYPES:
                return errno.ENOENT
            if block.size + struct.calcsize(LOG_TYPES[kind]) > BYTES:
                return errno.E2BIG
            if sum(len(one.fields) for one in self.blocks.values()) == VARIABLES:
                return errno.ENOMEM
            if which >= len(self._contents.entries):
                return errno.ENOENT
            block.fields.append((which, kind))
        return 0

    def _delete_block(self, number: int) -> int:
        return 0 if self.blocks.pop(number, None) else errno.ENOENT

    def _start_block(self, number: int, period_ms: int, now_ms: int) -> int:
        block = self.blocks.get(number)
        if block is None:
            return errno.ENOENT
        if period_ms == 0:  # period 0: send once
            block.once = True
            return 0
        block.period_ms, block.due_ms = period_ms, now_ms + period_ms
        return 0

    def _stop_block(self, number: int) -> int:
        block = self.blocks.get(number)
        if block is None:
            return errno.ENOENT
        block.period_ms = 0
        return 0

    def take_due_packets(self, now_ms: int, read: Reader) -> list[bytes]:
        """Return the data packets that are due; missed ones are skipped."""
        packets = []
        for number, block in self.blocks.items():
            if block.once:
                block.once = False
                packets.append(self._build_packet(number, block, now_ms, read))
            if block.period_ms and now_ms >= block.due_ms:
                # Number of missed periods; the next packet stays on the original time grid
                late = (now_ms - block.due_ms) // block.period_ms
                stamp = block.due_ms + late * block.period_ms
                block.due_ms += (late + 1) * block.period_ms
                packets.append(self._build_packet(number, block, stamp, read))
        return packets

    def _build_packet(
        self, number: int, block: EmulatedLogBlock, stamp_ms: int, read: Reader
    ) -> bytes:
        # The stamp has 24 bits of milliseconds and wraps after 4.7 hours
        head = bytes([number]) + (stamp_ms & 0xFFFFFF).to_bytes(3, 'little')
        values = [
            pack_value(LOG_TYPES[kind], read(self._contents.entries[which].name))
            for which, kind in block.fields
        ]
        return head + b''.join(values)
