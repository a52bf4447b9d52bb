# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Transmission faults of the frames of an emulated light board."""

from dataclasses import dataclass

from lta_bridge.teensy._generated import mavlink
from lta_emulation.teensy.emulated_board import COMPONENT, SYSTEM


class ForeignMessage(mavlink.MAVLink_message):
    """A valid message that is not in the dialect, with a word of 32 bits."""

    def __init__(self, word: int) -> None:
        super().__init__(12345, 'FOREIGN')
        self._word = word

    def pack(self, mav: mavlink.MAVLink, force_mavlink1: bool = False) -> bytes:
        """Return its frame."""
        seed = 7  # of the checksum; any number, as no other side knows the message
        return self._pack(mav, seed, self._word.to_bytes(4, 'little'), force_mavlink1)


@dataclass(frozen=True, slots=True)
class FrameFaults:
    """Transmission faults of every n-th light frame; 0 is never."""

    # Lost; one bit flipped; truncated after a third; followed by an unknown message
    drop: int = 0
    corrupt: int = 0
    cut: int = 0
    foreign: int = 0

    def __call__(self, turn: int, frame: bytes) -> bytes:
        """Return the bytes that arrive of a frame, counted from 1."""
        if _is_every_nth(turn, self.drop):
            return b''
        if _is_every_nth(turn, self.corrupt):
            middle = len(frame) // 2
            # One flipped bit must be detected by the checksum
            return frame[:middle] + bytes((frame[middle] ^ 1,)) + frame[middle + 1 :]
        if _is_every_nth(turn, self.cut):
            return frame[: len(frame) // 3]
        if _is_every_nth(turn, self.foreign):
            # A parser must skip valid messages of an unknown type
            return frame + ForeignMessage(turn).pack(mavlink.MAVLink(None, SYSTEM, COMPONENT))
        return frame


def _is_every_nth(turn: int, every: int) -> bool:
    return every > 0 and turn % every == 0
