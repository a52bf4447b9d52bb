"""
Parse MAVLink 2 frames from a stream of bytes.

After a wrong checksum the parser advances by one byte only, so that a truncated frame does not
take the next one with it, as the length in a damaged header could. The checksum of a message that
is not in the dialect cannot be verified; it is accepted if another frame follows directly, and
counted separately.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

from lta_bridge.teensy.dialect import MESSAGES
from lta_bridge.teensy.message import CHECKSUM, HEADER, MARKER, MavlinkMessage, SIGNATURE, SIGNED
import numpy as np

OLD_MARKER = 0xFE  # first byte of a MAVLink 1 frame, which is not supported


@final
@dataclass(frozen=True, slots=True)
class MavlinkFrame:
    """A received message with its fields and its sender."""

    message: MavlinkMessage
    record: np.void
    system: int
    component: int


@final
class FrameParser:
    """
    Parse frames and count errors.

    Attributes `frames`, `crc_errors`, `unknown`, `stray`: valid frames, frames with a wrong
    checksum, messages not in the dialect, and bytes that belong to none of these.
    """

    def __init__(self) -> None:
        self._held = bytearray()
        self.frames = self.crc_errors = self.unknown = self.stray = 0

    def parse_frames(self, data: bytes) -> Iterator[MavlinkFrame]:
        """Add received bytes and yield the complete frames."""
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
                    # A marker byte within other data: continue behind it
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
        # Bytes 7 to 9 of a MAVLink 2 header: the message number
        return MESSAGES.get(int.from_bytes(self._held[at + 7 : at + HEADER], 'little'))

    def _find_frame_end(self, at: int) -> int | None:
        """Return the end of a frame; `at` if none starts there, None if it is incomplete."""
        held = self._held
        if len(held) - at < HEADER:
            return None
        length, flags = held[at + 1], held[at + 2]
        # By the specification, a frame with unknown incompatibility flags must be dropped
        if flags & ~SIGNED:
            return at
        end = at + HEADER + length + CHECKSUM + (SIGNATURE if flags else 0)
        if self._find_message(at) is not None:
            return None if len(held) < end else end
        if len(held) <= end:
            return None
        # The CRC of an unknown message cannot be checked, so require a frame right behind it
        return end if held[end] in (MARKER, OLD_MARKER) else at

    def _parse_frame(self, at: int, end: int) -> MavlinkFrame | None:
        """Return a frame if it is valid and in the dialect; otherwise count it."""
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
        return MavlinkFrame(message, record, held[at + 5], held[at + 6])  # system, component
