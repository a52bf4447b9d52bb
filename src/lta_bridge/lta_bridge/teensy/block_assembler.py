# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Receive the light board's messages: find frames in torn bytes, and join them to blocks."""

from collections.abc import Iterator
from typing import final, NamedTuple

from lta_bridge.teensy._generated import mavlink
import numpy as np
from numpy.typing import NDArray

CHECKSUM = 2  # bytes behind the payload
# The generated decoder would accept wrong checksums where this variable of the environment is set
mavlink.MAVLINK_IGNORE_CRC = 0


@final
class FrameParser:
    """
    Parse frames and count errors.

    Attributes `frames`, `crc_errors`, `unknown`, `stray`: valid frames, frames with a wrong
    checksum, messages not in the dialect, and bytes that belong to none of these.
    """

    def __init__(self) -> None:
        self._held = bytearray()
        self._decoder = mavlink.MAVLink(None)
        self.frames = self.crc_errors = self.unknown = self.stray = 0

    def parse_frames(self, data: bytes) -> Iterator[mavlink.MAVLink_message]:
        """Add received bytes and yield the messages of the complete frames."""
        held = self._held
        held += data
        at = 0
        try:
            while (begin := held.find(mavlink.PROTOCOL_MARKER_V2, at)) >= 0:
                self.stray += begin - at
                at = begin
                if (end := self._find_frame_end(at)) is None:
                    return
                if end == at:
                    # A marker byte within other data: continue behind it
                    self.stray += 1
                    at += 1
                    continue
                try:
                    message = self._decoder.decode(held[at:end])
                except mavlink.MAVError:
                    self.crc_errors += 1
                    at += 1
                    continue
                at = end
                if isinstance(message, mavlink.MAVLink_unknown):
                    self.unknown += 1
                else:
                    self.frames += 1
                    yield message
            self.stray += len(held) - at
            at = len(held)
        finally:
            del held[:at]

    def _find_frame_end(self, at: int) -> int | None:
        """Return the end of a frame; `at` if none starts there, None if it is incomplete."""
        held = self._held
        start = at + mavlink.HEADER_LEN_V2
        if len(held) < start:
            return None
        length, flags = held[at + 1], held[at + 2]
        # By the specification, a frame with unknown incompatibility flags must be dropped
        if flags & ~mavlink.MAVLINK_IFLAG_SIGNED:
            return at
        end = start + length + CHECKSUM + (mavlink.MAVLINK_SIGNATURE_BLOCK_LEN if flags else 0)
        # Bytes 7 to 9 of the header: the message number
        if int.from_bytes(held[at + 7 : start], 'little') in mavlink.mavlink_map:
            return None if len(held) < end else end
        if len(held) <= end:
            return None
        # The checksum of an unknown message means nothing here: require a frame right behind it
        follows = held[end] in (mavlink.PROTOCOL_MARKER_V1, mavlink.PROTOCOL_MARKER_V2)
        return end if follows else at


ROW_WRAP = 2**32  # row numbers wrap here
RESTART_RUN = (
    5  # consecutive messages with old row numbers after which the board counts as restarted
)


class BoardLightBlock(NamedTuple):
    """Samples of all diodes, shape (samples, diodes), and the board's time of the first [ns]."""

    board_ns: int
    samples: NDArray[np.uint16]


@final
class BlockAssembler:
    """
    Collect rows into blocks.

    Parameters
    ----------
    samples : int
        Rows in a block.
    sample_rate : float
        Row rate by the board's clock. [Hz]

    Attributes
    ----------
    rows, lost, old : int
        Rows received, lost, and received twice or too late.
    whole, torn : int
        Complete blocks, and blocks dropped for lost rows.
    restarts : int
        Number of restarts of the board's row counter.

    """

    def __init__(self, samples: int, sample_rate: float) -> None:
        self._samples = samples
        self._row_ns = 1e9 / sample_rate
        self._expected: int | None = None
        self._filled: NDArray[np.uint16] | None = None
        self._have = 0
        self._board_ns = 0
        self._suspects = 0
        self.rows = self.lost = self.old = self.whole = self.torn = self.restarts = 0

    def add_rows(
        self, board_ns: int, sequence: int, rows: NDArray[np.uint16]
    ) -> Iterator[BoardLightBlock]:
        """
        Add consecutive rows and yield the blocks that they complete.

        `board_ns`: board time of the first row [ns]. `sequence`: number of the first row, modulo
        2^32. `rows`, shape (n, diodes): ADC counts.
        """
        if not self._accept_rows(sequence, len(rows)):
            return
        self._expected = (sequence + len(rows)) % ROW_WRAP
        self.rows += len(rows)
        at = 0
        while at < len(rows):
            if self._filled is None or self._filled.shape[1] != rows.shape[1]:
                self._filled = np.empty((self._samples, rows.shape[1]), np.uint16)
                self._have = 0
            if self._have == 0:
                # The message's time is that of its first row; this block starts `at` rows later
                self._board_ns = board_ns + round(at * self._row_ns)
            count = min(self._samples - self._have, len(rows) - at)
            self._filled[self._have : self._have + count] = rows[at : at + count]
            self._have += count
            at += count
            if self._have == self._samples:
                self.whole += 1
                # The receiver keeps this array, so the next block gets a new one
                yield BoardLightBlock(self._board_ns, self._filled)
                self._filled = None

    def _accept_rows(self, sequence: int, count: int) -> bool:
        """Return whether rows are new; after a gap, drop the partial block."""
        expected = sequence if self._expected is None else self._expected
        # Serial number arithmetic: the upper half of the range means "older"
        ahead = (sequence - expected) % ROW_WRAP
        if ahead >= ROW_WRAP // 2:
            self._suspects += 1
            if self._suspects < RESTART_RUN:
                self.old += count
                return False
            self.restart_row_count()
            ahead = 0
        self._suspects = 0
        if ahead:
            self.lost += ahead
            self._drop_partial_block()
        return True

    def restart_row_count(self) -> None:
        """Start counting anew with the next rows, because the board was reset."""
        self.restarts += 1
        self._expected = None
        self._drop_partial_block()

    def _drop_partial_block(self) -> None:
        self.torn += bool(self._filled is not None and self._have)
        self._filled = None
