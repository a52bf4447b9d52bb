"""
The light board as the bridge knows it: bytes in, blocks in our time out, questions due.

Knows no transport and no ROS: whoever has a link hands bytes in and sends what is due.
"""

from collections.abc import Iterator
import math
from typing import final, NamedTuple

from lta_bridge.teensy.block_assembler import BlockAssembler
from lta_bridge.teensy.board_clock import BoardClock, ClockExchange
from lta_bridge.teensy.dialect import (
    HEARTBEAT,
    LTA_LIGHT_BLOCK,
    LTA_LIGHT_PEAKS,
    LTA_LIGHT_STATUS,
    TIMESYNC,
)
from lta_bridge.teensy.frame_parser import FrameParser, MavlinkFrame
from lta_bridge.teensy.message import MavlinkMessage
from lta_bridge.teensy.sender_filter import SenderFilter
from lta_config.topics import AdcBlockShape
from lta_vlc.demodulation import Peaks
from lta_vlc.spectral.snr import signal_to_noise_ratio
import numpy as np
from numpy.typing import NDArray

DIALECT = 1  # the version of our messages
SYSTEM, COMPONENT = 255, 191  # MAVLink: a ground station, its onboard computer
BEAT_NS = 1_000_000_000  # between heartbeats
ASK_NS = 250_000_000  # between questions for the time
EAGER_NS = 20_000_000  # between them before it is known
OLDEST_NS = AHEAD_NS = 10_000_000_000  # by which a first sample may seem old, or yet to come
BACK_NS = 100_000_000  # by which a datagram may be overtaken; farther back, the board began anew
ANSWER_NS = 1_000_000_000  # after which an answer says nothing any more
QUESTIONS = 8  # kept until they are answered; of the board's, answered at once
OF_LIGHT = (LTA_LIGHT_BLOCK, LTA_LIGHT_PEAKS, LTA_LIGHT_STATUS)
CONTROLLER, NO_AUTOPILOT, ACTIVE, PROTOCOL = 18, 8, 4, 3  # of MAVLink's common.xml
COUNTS = 65535.0  # more no ADC of 16 bits can tell
ROOM = LTA_LIGHT_BLOCK.layout['samples'].shape[0]  # values in a message


class LightPeaks(NamedTuple):
    """Peaks that the board found in one block's time, and our time of its first sample. [ns]"""

    stamp_ns: int
    peaks: Peaks


class LightBlock(NamedTuple):
    """One ADC block, shape (samples, diodes), and our time of its first sample. [ns]"""

    stamp_ns: int
    samples: NDArray[np.uint16]


@final
class LightBoard:
    """
    The board at the other end of a link.

    Parameters
    ----------
    light : Light
        What a block is, by the topic table.
    diodes : int
        How many the vehicle has.
    finds_peaks : bool
        Whether it is to find the peaks itself and send no samples.
    bits : int or None
        Of the vehicle's converter; None where any will do.

    Attributes
    ----------
    framing, clock, blocks
        What came, the board's clock, and the rows.
    undated : int
        Blocks that came before the board's time was known, or at a time that cannot be, and were
        left.
    sender : OneSender
        The system and component whose light counts: others may share the link.
    heard_ns : int
        When its last message came, or whoever's answer while it has sent no light; 0 before. [ns]
    unfit : int
        Messages of light that could not be used.
    unanswered : int
        Questions for our time that came too thick to be answered.
    overruns : int
        Rows that the board itself had to leave.
    peaks : int
        Windows in which the board found peaks itself.

    """

    def __init__(
        self, light: AdcBlockShape, diodes: int, finds_peaks: bool = False, bits: int | None = None
    ) -> None:
        self._light, self._diodes, self._finds_peaks = light, diodes, finds_peaks
        self._bits = bits
        self._sent = 0
        self._asked: list[int] = []
        self._next_beat = self._next_ask = self._looked_ns = 0
        self._replies: list[bytes] = []
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
        """Why its blocks cannot be used, in one sentence; empty where they can."""
        return self._unlike or self._unfit

    def receive_data(self, data: bytes, now_ns: int) -> Iterator[LightBlock | LightPeaks]:
        """Take any part of the stream, when it came [ns], and yield what it completes."""
        for frame in self.framing.parse_frames(data):
            if not self._is_from_board(frame, now_ns):
                continue
            if frame.message is LTA_LIGHT_BLOCK:
                yield from self._take_rows(frame.record, now_ns)
            elif frame.message is TIMESYNC:
                self._take_time(frame.record, now_ns)
            elif frame.message is LTA_LIGHT_STATUS:
                self._take_status(frame.record)
            elif frame.message is LTA_LIGHT_PEAKS:
                yield from self._take_peaks(frame.record, now_ns)

    def _is_from_board(self, frame: MavlinkFrame, now_ns: int) -> bool:
        """Tell whether the board sent it, and note that it lives; only light says who it is."""
        source, known = (frame.system, frame.component), self.sender.who
        if frame.message in OF_LIGHT:
            heard = self.sender.accept_sender(source, now_ns)
        else:
            heard = source == known or (known is None and frame.message is TIMESYNC)
        if heard:
            self.heard_ns = now_ns
        return heard

    def compose_due_messages(self, now_ns: int) -> bytes:
        """Return what is to be sent now: a heartbeat, a question for the time, answers."""
        out, self._replies = b''.join(self._replies), []
        if now_ns < self._looked_ns - BACK_NS:  # our own clock was set back
            self._next_beat = self._next_ask = now_ns
            self.clock.restart()
        self._looked_ns = now_ns
        if now_ns >= self._next_beat:
            self._next_beat = now_ns + BEAT_NS
            out += self._build_frame(
                HEARTBEAT,
                type=CONTROLLER,
                autopilot=NO_AUTOPILOT,
                system_status=ACTIVE,
                mavlink_version=PROTOCOL,
            )
        if now_ns >= self._next_ask:
            self._next_ask = now_ns + (ASK_NS if self.clock.is_synchronized else EAGER_NS)
            self._asked = [*self._asked[1 - QUESTIONS :], now_ns]
            out += self._build_frame(TIMESYNC, ts1=now_ns)
        return out

    def _build_frame(self, message: MavlinkMessage, **values: int) -> bytes:
        self._sent += 1
        return message.build_frame(self._sent - 1, SYSTEM, COMPONENT, **values)

    def _take_rows(self, record: np.void, now_ns: int) -> Iterator[LightBlock]:
        self._detect_restart(_board_time_ns(record))
        self._unfit = self._find_rows_fault(int(record['diodes']), int(record['rows']))
        if self._unfit:
            self.unfit += 1
            return
        diodes, rows = self._diodes, int(record['rows'])
        samples = record['samples'][: diodes * rows].reshape(rows, diodes)
        for block in self.blocks.add_rows(
            _board_time_ns(record), int(record['sequence']), samples
        ):
            stamp = self._find_host_time(block.board_ns, now_ns)
            if stamp is not None:
                yield LightBlock(stamp, block.samples)

    def _find_rows_fault(self, diodes: int, rows: int) -> str:
        if self._finds_peaks:
            return (
                'The light board sends samples and no peaks; start without light_peaks:=true, or '
                'build its firmware for peaks.'
            )
        if not 0 < diodes * rows <= ROOM:
            return f'The light board sends {rows} rows of {diodes} diodes in one message.'
        if diodes != self._diodes:
            return (
                f'The light board has {diodes} diodes and the vehicle file {self._diodes}; '
                'fly the vehicle that it is on.'
            )
        return ''

    def _take_peaks(self, record: np.void, now_ns: int) -> Iterator[LightPeaks]:
        self.peaks += 1
        self._detect_restart(_board_time_ns(record))
        self._unfit = self._find_peaks_fault(record)
        if self._unfit:
            self.unfit += 1
            return
        diodes, window = self._diodes, self._light.samples
        amplitude = record['amplitude'][:diodes].astype(np.float64)
        # Of white noise with this root mean square, the mean magnitude of a bin.
        noise = record['noise'][:diodes].astype(np.float64) * math.sqrt(math.pi / window)
        frequency = np.full(diodes, float(record['frequency']))
        stamp = self._find_host_time(_board_time_ns(record), now_ns)
        if stamp is not None:
            snr = signal_to_noise_ratio(amplitude, noise)
            yield LightPeaks(stamp, Peaks(amplitude, snr, frequency, noise))

    def _find_peaks_fault(self, record: np.void) -> str:
        diodes, window = int(record['diodes']), int(record['window'])
        if not self._finds_peaks:
            return 'The light board sends peaks and no samples; start with light_peaks:=true.'
        if diodes != self._diodes or window != self._light.samples:
            return (
                f'The light board finds peaks of {diodes} diodes over {window} rows; the vehicle '
                f'has {self._diodes} and a block {self._light.samples}: build it for these.'
            )
        rate = self._light.sample_rate.si
        most = {'amplitude': COUNTS, 'noise': COUNTS, 'frequency': 0.5 * rate}
        # What is no number compares false.
        if not all(
            ((record[name] >= 0.0) & (record[name] <= top)).all() for name, top in most.items()
        ):
            return (
                'The light board tells peaks that are no numbers of an ADC; look at its firmware.'
            )
        return ''

    def _detect_restart(self, board_ns: int) -> None:
        """Forget clock and rows of before where the board's time has gone back."""
        if board_ns < self._newest_ns - BACK_NS:
            if self.clock.restarts == self._resets:  # an answer has not told it that already
                self.clock.restart()
            self.blocks.restart()
            self._newest_ns = board_ns
        self._newest_ns = max(self._newest_ns, board_ns)
        self._resets = self.clock.restarts

    def _find_host_time(self, board_ns: int, now_ns: int) -> int | None:
        """Return our time of what the board stamped so; None where it may not be used."""
        if self._unlike:
            return None
        if self.clock.is_synchronized:
            stamp = self.clock.to_host_time(board_ns)
            # Of a board that has just started anew, or anything: ROS cannot tell every time.
            if now_ns - OLDEST_NS < stamp < now_ns + AHEAD_NS:
                return stamp
        self.undated += 1
        return None

    def _take_time(self, record: np.void, now_ns: int) -> None:
        board, asked = int(record['tc1']), int(record['ts1'])
        if board == 0:  # the other asks
            if len(self._replies) < QUESTIONS:
                self._replies.append(self._build_frame(TIMESYNC, tc1=now_ns, ts1=asked))
            else:
                self.unanswered += 1
        elif asked in self._asked and 0 <= now_ns - asked < ANSWER_NS:
            self._asked.remove(asked)
            self.clock.add_exchange(ClockExchange(asked, board, now_ns))

    def _take_status(self, record: np.void) -> None:
        self.overruns = int(record['overruns'])
        dialect, rate = int(record['dialect']), float(record['sample_rate'])
        bits = int(record['adc_bits'])
        wanted = self._light.sample_rate.si
        self._unlike = ''
        if dialect != DIALECT:
            self._unlike = (
                f'The light board speaks version {dialect} of its messages and this bridge '
                f'version {DIALECT}; build both from one commit.'
            )
        elif not abs(rate - wanted) <= 1e-3 * wanted:
            self._unlike = (
                f'The light board samples at {rate:g} Hz and topics.yaml says {wanted:g} Hz; '
                'give both the same.'
            )
        elif self._bits not in (None, bits):
            self._unlike = (
                f'The light board converts to {bits} bits and the vehicle file says {self._bits}; '
                'give both the same, or a reading that clips is not known.'
            )


def _board_time_ns(record: np.void) -> int:
    return int(record['time_usec']) * 1000
