# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Serialised messages with another stamp."""

import struct

STAMP = struct.Struct('<iI')
BEGIN = 4  # bytes of the CDR header before the stamp of a message with a header


def shift_stamp(data: bytes, by_ns: int) -> bytes:
    """Return a little-endian message with a header whose stamp is later [ns]."""
    seconds, nanoseconds = STAMP.unpack_from(data, BEGIN)
    moved = divmod(seconds * 10**9 + nanoseconds + by_ns, 10**9)
    return data[:BEGIN] + STAMP.pack(*moved) + data[BEGIN + STAMP.size :]
