# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Frames of the light board's link as anybody may send them, with a checksum of our own."""

from lta_bridge.teensy._generated import mavlink

KINDS = {kind.msgname: kind for kind in mavlink.mavlink_map.values()}


def crc(data: bytes) -> bytes:
    """CRC-16/MCRF4XX bit by bit: polynomial 0x1021 reflected, begun with ones."""
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0x8408 if value & 1 else 0)
    return value.to_bytes(2, 'little')


def field_lengths(name: str) -> dict[str, int]:
    """Return the lengths of a message's fields, 0 for a single value."""
    kind = KINDS[name]
    return dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))


def build_frame(name: str, turn=0, system=1, component=191, **values) -> bytes:
    """Return the frame of a message by its name in the XML; fields that are left out are zero."""
    zeros = {field: [0] * length or 0 for field, length in field_lengths(name).items()}
    link = mavlink.MAVLink(None, system, component)
    link.seq = turn % 256
    return KINDS[name](**zeros | values).pack(link)


def frame_bytes(number: int, payload: bytes, seed: int, system=1, component=191) -> bytes:
    """Return the frame of any message and payload; `seed`: its CRC_EXTRA."""
    body = bytes((len(payload), 0, 0, 0, system, component)) + number.to_bytes(3, 'little')
    return b'\xfd' + body + payload + crc(body + payload + bytes([seed]))


def sign_frame(frame: bytes, seed: int) -> bytes:
    """Return the frame with a 13 byte signature, which the bridge skips."""
    body = frame[1:2] + b'\1' + frame[3:-2]
    return b'\xfd' + body + crc(body + bytes([seed])) + bytes(range(13))
