"""
MAVLink 2 frames out of any stream of bytes.

What does not check is left one byte at a time, so that a frame which was cut short costs itself
alone: readers that skip as far as a broken head claims lose the next one as well. A message that
the dialect does not have cannot be checked; it is believed where another frame follows it at once,
and counted apart, because it is no loss.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

from lta_bridge.teensy.dialect import MESSAGES
from lta_bridge.teensy.message import CHECKSUM, HEADER, MARKER, MavlinkMessage, SIGNATURE, SIGNED
import numpy as np

OLD_MARKER = 0xFE  # begins a frame of MAVLink 1, which nothing here speaks


@final
@dataclass(frozen=True, slots=True)
class MavlinkFrame:
    """A message that came, its fields, and who sent it."""

    message: MavlinkMessage
    record: np.void
    system: int
    component: int


@final
class FrameParser:
    """
    The receiving end of a link.

    Attributes
    ----------
    frames, crc_errors, unknown, stray : int
        Good frames, frames whose checksum is wrong, messages that the dialect does not have, and
        bytes that belong to none of these.

    """

    def __init__(self) -> None:
        self._held = bytearray()
        self.frames = self.crc_errors = self.unknown = self.stray = 0

    def parse_frames(self, data: bytes) -> Iterator[MavlinkFrame]:
        """Yield the frames that are whole now."""
        held = self._held
        held += data
        at = 0
        try:
            while (begin := held.find(MARKER, at)) >= 0:
                self.stray += begin - at
                at = begin
                if (end := self._find_frame_end(at)) is None:
                    return
                if end == at:
                    self.stray += 1
                    at += 1
                elif (frame := self._parse_frame(at, end)) is not None:
                    at = end
                    yield frame
                elif self._find_message(at) is None:
                    at = end
                else:
                    at += 1
            self.stray += len(held) - at
            at = len(held)
        finally:
            del held[:at]

    def _find_message(self, at: int) -> MavlinkMessage | None:
        return MESSAGES.get(int.from_bytes(self._held[at + 7 : at + HEADER], 'little'))

    def _find_frame_end(self, at: int) -> int | None:
        """Return where a frame ends, its begin if none begins there, None if more must come."""
        held = self._held
        if len(held) - at < HEADER:
            return None
        length, flags = held[at + 1], held[at + 2]
        if flags & ~SIGNED:
            return at
        end = at + HEADER + length + CHECKSUM + (SIGNATURE if flags else 0)
        if self._find_message(at) is not None:
            return None if len(held) < end else end
        if len(held) <= end:
            return None
        return end if held[end] in (MARKER, OLD_MARKER) else at

    def _parse_frame(self, at: int, end: int) -> MavlinkFrame | None:
        """Return a frame if it is one of the dialect's and checks; count it otherwise."""
        message = self._find_message(at)
        if message is None:
            self.unknown += 1
            return None
        held = self._held
        close = at + HEADER + held[at + 1]
        if message.checksum(held[at:close]) != int.from_bytes(held[close : close + 2], 'little'):
            self.crc_errors += 1
            return None
        self.frames += 1
        record = message.parse_payload(held[at + HEADER : close])
        return MavlinkFrame(message, record, held[at + 5], held[at + 6])
