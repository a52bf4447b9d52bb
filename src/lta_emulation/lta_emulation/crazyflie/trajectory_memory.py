# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Emulate the memory of the high-level commander (port 4, crtp_mem.c); it is not flown."""

import errno
import struct
from typing import Final, final

MEMORY_SETTINGS, MEMORY_READ, MEMORY_WRITE = 0, 1, 2  # channels
COUNT, DETAILS = 1, 2  # requests on channel 0
TRAJECTORY: Final = 0x12  # type of memory (mem.h)
MEMORY_SIZE: Final = 4096  # bytes


@final
class TrajectoryMemory:
    """The only memory that the drone has, number 0."""

    def __init__(self) -> None:
        self.content = bytearray(MEMORY_SIZE)

    def answer_packet(self, channel: int, data: bytes, size: int) -> bytes | None:
        """Return the answer to a packet of `size` bytes in the buffer; None for no answer."""
        if channel == MEMORY_SETTINGS and data[0] == COUNT:
            return bytes([COUNT, 1])
        if channel == MEMORY_SETTINGS and data[0] == DETAILS:
            # An unknown number gets the number alone
            info = struct.pack('<BI8x', TRAJECTORY, MEMORY_SIZE) if data[1] == 0 else b''
            return data[:2] + info
        if channel not in (MEMORY_READ, MEMORY_WRITE):
            return None
        number, begin = struct.unpack_from('<BI', data)
        end = begin + (data[5] if channel == MEMORY_READ else size - 5)
        if number != 0 or not begin <= end <= MEMORY_SIZE:
            return data[:5] + bytes([errno.EIO])
        if channel == MEMORY_READ:
            return data[:5] + b'\0' + bytes(self.content[begin:end])
        self.content[begin:end] = data[5:size]
        return data[:5] + b'\0'
