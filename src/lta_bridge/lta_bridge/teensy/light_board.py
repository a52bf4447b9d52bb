# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Protocol of the light board: parse received bytes into timed blocks, compose outgoing messages.

This module is independent of the transport and of ROS. The caller passes received bytes to
`receive_bytes` and sends the bytes of `compose_due_messages`.
"""

from collections.abc import Iterator
import io
import math
from typing import final, NamedTuple

from lta_bridge.teensy._generated import mavlink
from lta_bridge.teensy.block_assembler import BlockAssembler, FrameParser
from lta_bridge.teensy.board_clock import BoardClock, ClockExchange
from lta_bridge.teensy.port import SenderFilter
from lta_config.topics import AdcBlockShape
from lta_vlc.demodulation import Peaks
from lta_vlc.spectral.spectrum import signal_to_noise
import numpy as np
from numpy.typing import NDArray

DIALECT_VERSION = 1  # version of LTA's MAVLink messages
SYSTEM, COMPONENT = 255, 191  # MAVLink: a ground station, its onboard computer
BEAT_NS = 1_000_000_000  # between heartbeats
ASK_NS = 250_000_000  # between time requests
EAGER_NS = 20_000_000  # between time requests before the clock is synchronized
BLOCK_LIFE_NS = LARGEST_LEAD_NS = (
    10_000_000_000  # plausible age of a first sample, and lead of its stamp
)
REORDERED_NS = 100_000_000  # reordering of datagrams; farther back, the board has restarted
ANSWER_NS = 1_000_000_000  # age at which an answer to a time request is useless
OPEN_REQUESTS = 8  # open time requests at most, and queued answers to the board's requests
OF_LIGHT = (
    mavlink.MAVLink_lta_light_block_message,
    mavlink.MAVLink_lta_light_peaks_message,
    mavlink.MAVLink_lta_light_status_message,
)
CONTROLLER, NO_AUTOPILOT, ACTIVE, PROTOCOL = 18, 8, 4, 3  # of MAVLink's common.xml
MOST_COUNTS = 65535.0  # largest reading of a 16-bit ADC
BLOCK_VALUES = max(mavlink.MAVLink_lta_light_block_message.array_lengths)  # values in a message


class LightPeaks(NamedTuple):
    """Peaks that the board detected in one block, and graph time of its first sample [ns]."""

    stamp_ns: int
    peaks: Peaks


class LightBlock(NamedTuple):
    """One ADC block, shape (samples, diodes), and graph time of its first sample [ns]."""

    stamp_ns: int
    samples: NDArray[np.uint16]


@final
class LightBoard:
    """
    A light board at the other end of a link.

    Parameters
    ----------
    light : AdcBlockShape
        Layout of a block in the topic table.
    diodes : int
        Number of diodes of the vehicle.
    finds_peaks : bool
        Whether the board shall detect the peaks itself and send no samples.
    bits : int or None
        Resolution of the vehicle's converter; None to accept any.
    vehicle : int or None
        Hash of the vehicle's diodes; None to accept any. A board that does not know its own is
        accepted.

    Attributes
    ----------
    framing, clock, blocks
        The frame parser, the board's clock, and the block assembler.
    undated : int
        Blocks dropped because the board's time was unknown or implausible.
    sender : SenderFilter
        The MAVLink system and component to accept; others may share the link.
    heard_ns : int
        Arrival of the board's last message; before its first light, of any time answer; 0 before
        both. [ns]
    unfit : int
        Unusable light messages.
    unanswered : int
        Time requests of the board that were too frequent to answer.
    overruns : int
        Rows dropped by the board.
    commit, vehicle : int
        Of its firmware: commit, and hash of the diodes; 0 is unknown.
    peaks : int
        Windows with peaks detected by the board.

    """

    def __init__(
        self,
        light: AdcBlockShape,
        diodes: int,
        finds_peaks: bool = False,
        bits: int | None = None,
        vehicle: int | None = None,
    ) -> None:
        self._light, self._diodes, self._finds_peaks = light, diodes, finds_peaks
        self._bits, self._vehicle = bits, vehicle
        self.commit = self.vehicle = 0
        self._due = io.BytesIO()  # bytes to send
        self._link = mavlink.MAVLink(self._due, SYSTEM, COMPONENT)
        self._request_times: list[int] = []
        self._next_beat = self._next_ask = self._looked_ns = 0
        self._replies = 0  # answers among the bytes to send
        self.sender = SenderFilter()
        self.framing = FrameParser()
        self.clock = BoardClock()
        self.blocks = BlockAssembler(light.samples, light.sample_rate.si)
        self.undated = self.heard_ns = self.overruns = self.peaks = 0
        self.unfit = self.unanswered = 0
        self._newest_ns = 0  # of the board's times
        self._resets = 0  # of its clock, as of then
        self._unlike = self._unfit = ''  # by its status, and by the light that it sends

    @property
    def fault(self) -> str:
        """Why the blocks cannot be used, in one sentence; empty if they can."""
        return self._unlike or self._unfit

    def receive_bytes(self, data: bytes, now_ns: int) -> Iterator[LightBlock | LightPeaks]:
        """Add received bytes with their arrival [ns]; yield the blocks that they complete."""
        for message in self.framing.parse_frames(data):
            if not self._is_from_board(message, now_ns):
                continue
            match message:
                case mavlink.MAVLink_lta_light_block_message():
                    yield from self._take_rows(message, now_ns)
                case mavlink.MAVLink_timesync_message():
                    self._take_time(message, now_ns)
                case mavlink.MAVLink_lta_light_status_message():
                    self._take_status(message)
                case mavlink.MAVLink_lta_light_peaks_message():
                    yield from self._take_peaks(message, now_ns)

    def _is_from_board(self, message: mavlink.MAVLink_message, now_ns: int) -> bool:
        """Return whether the board sent a message; its first light message identifies it."""
        source, board = (message.get_srcSystem(), message.get_srcComponent()), self.sender.who
        if isinstance(message, OF_LIGHT):
            accepted = self.sender.accept_sender(source, now_ns)
        else:
            # Before the board is known, any time exchange may be its own: it speeds up the start
            is_time = isinstance(message, mavlink.MAVLink_timesync_message)
            accepted = source == board or (board is None and is_time)
        if accepted:
            self.heard_ns = now_ns
        return accepted

    def compose_due_messages(self, now_ns: int) -> bytes:
        """Return the bytes to send now: answers, heartbeat, time request."""
        if now_ns < self._looked_ns - REORDERED_NS:  # our own clock was set back
            self._next_beat = self._next_ask = now_ns
            self.clock.discard_exchanges()
        self._looked_ns = now_ns
        if now_ns >= self._next_beat:
            self._next_beat = now_ns + BEAT_NS
            self._link.heartbeat_send(
                type=CONTROLLER,
                autopilot=NO_AUTOPILOT,
                base_mode=0,
                custom_mode=0,
                system_status=ACTIVE,
                mavlink_version=PROTOCOL,
            )
        if now_ns >= self._next_ask:
            self._next_ask = now_ns + (ASK_NS if self.clock.is_synchronized else EAGER_NS)
            # Keep the newest requests only, since lost answers would let the list grow
            self._request_times = [*self._request_times[1 - OPEN_REQUESTS :], now_ns]
            self._link.timesync_send(tc1=0, ts1=now_ns)
        due = self._due.getvalue()
        self._due.seek(0)
        self._due.truncate()
        self._replies = 0
        return due

    def _take_rows(
        self, message: mavlink.MAVLink_lta_light_block_message, now_ns: int
    ) -> Iterator[LightBlock]:
        board_ns, diodes, rows = message.time_usec * 1000, message.diodes, message.rows
        self._detect_restart(board_ns)
        self._unfit = self._describe_rows_fault(diodes, rows)
        if self._unfit:
            self.unfit += 1
            return
        # The message has room for BLOCK_VALUES values; the rest is unused
        samples = np.array(message.samples[: diodes * rows], np.uint16).reshape(rows, diodes)
        for block in self.blocks.add_rows(board_ns, message.sequence, samples):
            stamp = self._to_graph_time(block.board_ns, now_ns)
            if stamp is not None:
                yield LightBlock(stamp, block.samples)

    def _describe_rows_fault(self, diodes: int, rows: int) -> str:
        if self._finds_peaks:
            return (
                'The light board sends samples instead of peaks; start without light_peaks:=true, '
                'or build its firmware for peaks.'
            )
        if not 0 < diodes * rows <= BLOCK_VALUES:
            return (
                f'The light board sends {rows} rows of {diodes} diodes in one message, but a '
                f'message has 1 to {BLOCK_VALUES} values; check its firmware.'
            )
        if diodes != self._diodes:
            return (
                f'The light board has {diodes} photodiodes, but the vehicle file has '
                f'{self._diodes}; give the vehicle file that matches the board.'
            )
        return ''

    def _take_peaks(
        self, message: mavlink.MAVLink_lta_light_peaks_message, now_ns: int
    ) -> Iterator[LightPeaks]:
        self.peaks += 1
        board_ns = message.time_usec * 1000
        self._detect_restart(board_ns)
        self._unfit = self._describe_peaks_fault(message)
        if self._unfit:
            self.unfit += 1
            return
        diodes, window = self._diodes, self._light.samples
        amplitude = np.array(message.amplitude[:diodes])
        # Of white noise with this root mean square, the mean magnitude of a bin.
        noise = np.array(message.noise[:diodes]) * math.sqrt(math.pi / window)
        frequency = np.full(diodes, message.frequency)
        stamp = self._to_graph_time(board_ns, now_ns)
        if stamp is not None:
            snr = signal_to_noise(amplitude, noise)
            yield LightPeaks(stamp, Peaks(amplitude, snr, frequency, noise))

    def _describe_peaks_fault(self, message: mavlink.MAVLink_lta_light_peaks_message) -> str:
        diodes, window = message.diodes, message.window
        if not self._finds_peaks:
            return 'The light board sends peaks instead of samples; start with light_peaks:=true.'
        if diodes != self._diodes or window != self._light.samples:
            return (
                f'The light board finds the peaks of {diodes} diodes over {window} rows, but the '
                f'vehicle has {self._diodes} diodes and a block has {self._light.samples} rows; '
                'build the firmware of the board for these numbers.'
            )
        rate = self._light.sample_rate.si
        # Comparisons with NaN are false
        fits = 0.0 <= message.frequency <= 0.5 * rate and all(
            0.0 <= value <= MOST_COUNTS for value in (*message.amplitude, *message.noise)
        )
        if not fits:
            return 'The light board sends peaks outside the range of its ADC; check its firmware.'
        return ''

    def _detect_restart(self, board_ns: int) -> None:
        """Reset clock and rows if the board's time has gone back."""
        if board_ns < self._newest_ns - REORDERED_NS:
            if self.clock.restarts == self._resets:  # an answer has not told it that already
                self.clock.discard_exchanges()
            self.blocks.restart_row_count()
            self._newest_ns = board_ns
        self._newest_ns = max(self._newest_ns, board_ns)
        self._resets = self.clock.restarts

    def _to_graph_time(self, board_ns: int, now_ns: int) -> int | None:
        """Return the graph time of a board stamp; None if it is unknown or implausible."""
        if self._unlike:
            return None
        if self.clock.is_synchronized:
            stamp = self.clock.to_host_time(board_ns)
            # Of a board that has just started anew, or anything: ROS cannot tell every time.
            if now_ns - BLOCK_LIFE_NS < stamp < now_ns + LARGEST_LEAD_NS:
                return stamp
        self.undated += 1
        return None

    def _take_time(self, message: mavlink.MAVLink_timesync_message, now_ns: int) -> None:
        board, request = message.tc1, message.ts1
        if board == 0:  # MAVLink TIMESYNC: 0 marks a request
            if self._replies < OPEN_REQUESTS:
                self._replies += 1
                self._link.timesync_send(tc1=now_ns, ts1=request)
            else:
                self.unanswered += 1
        elif request in self._request_times and 0 <= now_ns - request < ANSWER_NS:
            # Each request has one answer; duplicated datagrams must not count twice
            self._request_times.remove(request)
            self.clock.add_exchange(ClockExchange(request, board, now_ns))

    def _take_status(self, message: mavlink.MAVLink_lta_light_status_message) -> None:
        self.overruns = message.overruns
        version, rate, bits = message.dialect, message.sample_rate, message.adc_bits
        self.commit, self.vehicle = message.commit, message.vehicle
        sample_rate = self._light.sample_rate.si
        self._unlike = ''
        if version != DIALECT_VERSION:
            self._unlike = (
                f'The light board uses version {version} of the messages, but this bridge uses '
                f'version {DIALECT_VERSION}; build both from the same commit.'
            )
        # Written with `not`, so that a rate of NaN is refused too
        elif not abs(rate - sample_rate) <= 1e-3 * sample_rate:
            self._unlike = (
                f'The light board samples at {rate:g} Hz, but topics.yaml says '
                f'{sample_rate:g} Hz; set both to the same rate.'
            )
        elif self._bits not in (None, bits):
            self._unlike = (
                f'The ADC of the light board has {bits} bits, but the vehicle file says '
                f'{self._bits}; set both to the same value, or clipped readings are not detected.'
            )
        elif self.vehicle and self._vehicle not in (None, self.vehicle):
            self._unlike = (
                f'The firmware of the light board was built for other diodes ({self.vehicle:08x}) '
                f'than the vehicle file has ({self._vehicle:08x}); give the vehicle file of this '
                'board, or build and flash its firmware with "make firmware".'
            )
