"""
A light board without the board: its bytes for given light, its clock, and what goes wrong.

The peer for tests of the bridge, and for trying a graph without hardware.
"""

from collections.abc import Iterator
from dataclasses import dataclass
import os
from pathlib import Path
import select
import termios
import tty
from typing import final

from lta_bridge.teensy.dialect import (
    HEARTBEAT,
    LTA_LIGHT_BLOCK,
    LTA_LIGHT_PEAKS,
    LTA_LIGHT_STATUS,
    TIMESYNC,
)
from lta_bridge.teensy.frame_parser import FrameParser
from lta_bridge.teensy.light_board import ACTIVE, CONTROLLER, DIALECT, NO_AUTOPILOT, PROTOCOL
from lta_bridge.teensy.message import MavlinkMessage
import numpy as np
from numpy.typing import NDArray

SYSTEM, COMPONENT = 1, 191
MOST = LTA_LIGHT_PEAKS.layout['amplitude'].shape[0]  # diodes that peaks can be told of
VALUES = LTA_LIGHT_BLOCK.layout['samples'].shape[0]  # of all diodes, in a message
WRAP = 2**32
FOREIGN = MavlinkMessage(12345, 'FOREIGN', 7, np.dtype([('word', '<u4')]))


@final
@dataclass(frozen=True, slots=True)
class FrameFaults:
    """
    What happens on the way to every n-th frame of light; 0 is never.

    Attributes
    ----------
    drop, corrupt, cut, foreign : int
        Lost; one bit wrong; ended after a third; followed by a message that nobody here knows.

    """

    drop: int = 0
    corrupt: int = 0
    cut: int = 0
    foreign: int = 0

    def apply(self, turn: int, frame: bytes) -> bytes:
        """Return what arrives of a frame, counted from 1."""
        if _is_hit(turn, self.drop):
            return b''
        if _is_hit(turn, self.corrupt):
            middle = len(frame) // 2
            return frame[:middle] + bytes((frame[middle] ^ 1,)) + frame[middle + 1 :]
        if _is_hit(turn, self.cut):
            return frame[: len(frame) // 3]
        if _is_hit(turn, self.foreign):
            return frame + FOREIGN.build_frame(0, SYSTEM, COMPONENT, word=turn)
        return frame


def _is_hit(turn: int, every: int) -> bool:
    return every > 0 and turn % every == 0


@final
class EmulatedBoard:
    """
    A board that was switched on at a moment of our time.

    Parameters
    ----------
    boot_ns : int
        That moment. [ns]
    sample_rate : float
        Rows a second of its clock. [Hz]
    diodes : int
        Values in a row.
    drift : float
        Part by which its clock is too fast.
    faults : Faults
        What happens to its frames of light.
    first : int
        Number of its first row.
    dialect : int
        The version of its messages.
    bits : int
        Of its converter.

    Attributes
    ----------
    faults : Faults
        What happens to its frames of light from now on.
    sent : int
        Frames of light so far, those that a fault took included.

    """

    def __init__(
        self,
        boot_ns: int,
        sample_rate: float = 10e3,
        diodes: int = 8,
        drift: float = 0.0,
        faults: FrameFaults | None = None,
        first: int = 0,
        dialect: int = DIALECT,
        bits: int = 12,
    ) -> None:
        self._boot_ns, self._rate, self._diodes, self._drift = boot_ns, sample_rate, diodes, drift
        self.faults = faults or FrameFaults()
        self._dialect, self._bits = dialect, bits
        self._first, self._rows, self._turn = first, 0, 0
        self._paused = 0  # ns of its clock in which it sampled nothing
        self._hears = FrameParser()
        self._left = np.empty((0, diodes), np.uint16)
        self.sent = 0

    def to_board_time(self, our_ns: int) -> int:
        """Return its time at a moment of ours. [ns]"""
        since = our_ns - self._boot_ns
        return since + round(since * self._drift)

    def row_time_ns(self, row: int) -> int:
        """Return the moment of ours at which it samples a row, counted from 0. [ns]"""
        return self._boot_ns + round(row / self._rate / (1.0 + self._drift) * 1e9)

    def encode_light(self, samples: NDArray[np.uint16], begun_ns: int | None = None) -> bytes:
        """
        Return the frames of the next rows; what fills none waits.

        Parameters
        ----------
        samples : ndarray of uint16, shape (n, diodes)
            ADC counts.
        begun_ns : int, optional
            Moment of ours at which the first was sampled; they follow the last where left out.
            What began before its boot it has not sampled.

        """
        if begun_ns is not None:
            if begun_ns < self._boot_ns:
                return b''
            sampled = self._rows + len(self._left)
            self._paused = self.to_board_time(begun_ns) - round(sampled / self._rate * 1e9)
        return b''.join(self._encode_rows(samples))

    @property
    def _time_usec(self) -> int:
        """Its time of the next row to be sent. [us]"""
        return round(self._rows / self._rate * 1e6 + self._paused / 1e3)

    def _encode_rows(self, samples: NDArray[np.uint16]) -> Iterator[bytes]:
        count = VALUES // self._diodes
        self._left = np.concatenate([self._left, samples])
        while len(self._left) >= count:
            rows, self._left = self._left[:count], self._left[count:]
            values = np.zeros(VALUES, np.uint16)
            values[: rows.size] = rows.ravel()
            frame = self._build_frame(
                LTA_LIGHT_BLOCK,
                time_usec=self._time_usec,
                sequence=(self._first + self._rows) % WRAP,
                diodes=self._diodes,
                rows=count,
                samples=values,
            )
            self._rows += count
            self.sent += 1
            yield self.faults.apply(self.sent, frame)

    def encode_peaks(
        self, samples: NDArray[np.uint16], frequency: float, begun_ns: int | None = None
    ) -> bytes:
        """
        Return the frame of the peaks that it finds, as its firmware does (core/goertzel.c).

        Parameters
        ----------
        samples : ndarray of uint16, shape (n, diodes)
            ADC counts of the window.
        frequency : float
            Of the beacon. [Hz]
        begun_ns : int, optional
            As for `encode_light`.

        """
        count = len(samples)
        if begun_ns is not None:
            if begun_ns < self._boot_ns:
                return b''
            self._paused = self.to_board_time(begun_ns) - round(self._rows / self._rate * 1e9)
        waves = samples - samples.mean(axis=0)
        turns = np.exp(-2j * np.pi * frequency / self._rate * np.arange(count))
        amplitude = 2.0 / count * np.abs(turns @ waves)
        rest = np.sqrt(np.maximum(np.mean(waves**2, axis=0) - 0.5 * amplitude**2, 0.0))
        room = MOST - self._diodes
        frame = self._build_frame(
            LTA_LIGHT_PEAKS,
            time_usec=self._time_usec,
            sequence=(self._first + self._rows) % WRAP,
            window=count,
            frequency=frequency,
            diodes=self._diodes,
            amplitude=np.pad(amplitude, (0, room)),
            noise=np.pad(rest, (0, room)),
        )
        self._rows += count
        return frame

    def encode_status(self) -> bytes:
        """Return what it says of itself once a second."""
        beat = self._build_frame(
            HEARTBEAT,
            type=CONTROLLER,
            autopilot=NO_AUTOPILOT,
            system_status=ACTIVE,
            mavlink_version=PROTOCOL,
        )
        return beat + self._build_frame(
            LTA_LIGHT_STATUS,
            time_usec=self._time_usec,
            rows=(self._first + self._rows) % WRAP,
            sample_rate=self._rate,
            diodes=self._diodes,
            adc_bits=self._bits,
            dialect=self._dialect,
        )

    def answer_timesync(self, data: bytes, now_ns: int) -> bytes:
        """Return the answers to what came, at a moment of ours [ns]."""
        asked = [f.record for f in self._hears.parse_frames(data) if f.message is TIMESYNC]
        return b''.join(
            self._build_frame(TIMESYNC, tc1=self.to_board_time(now_ns), ts1=int(question['ts1']))
            for question in asked
            if question['tc1'] == 0
        )

    def _build_frame(self, message: MavlinkMessage, **values: object) -> bytes:
        self._turn += 1
        return message.build_frame(self._turn - 1, SYSTEM, COMPONENT, **values)


@final
class Cable:
    """
    A pseudo terminal under a name that stays while the cable is pulled and put back.

    Parameters
    ----------
    name : Path
        What the other side opens.

    """

    def __init__(self, name: Path) -> None:
        self._name = name
        self._ours: int | None = None
        self.plug()

    def plug(self) -> None:
        """Put the cable in."""
        self._ours, theirs = os.openpty()
        tty.setraw(theirs, termios.TCSANOW)
        os.set_blocking(self._ours, False)
        self._name.unlink(missing_ok=True)
        self._name.symlink_to(os.ttyname(theirs))
        os.close(theirs)

    def pull(self) -> None:
        """Pull the cable: the other side's port is gone."""
        self._name.unlink(missing_ok=True)
        if self._ours is not None:
            os.close(self._ours)
            self._ours = None

    def read(self, timeout: float = 0.0) -> bytes:
        """Return what the other side has sent, after at most so long [s]; nothing if nobody is."""
        if self._ours is None:
            return b''
        try:
            ready = select.select([self._ours], [], [], timeout)[0]
            return os.read(self._ours, 65536) if ready else b''
        except OSError:  # nobody has the other end open
            return b''

    def write(self, data: bytes) -> None:
        """Send all, as far as the other side takes it; what it leaves for 0.1 s is lost."""
        while data and self._ours is not None:
            try:
                data = data[os.write(self._ours, data) :]
            except BlockingIOError:
                if not select.select([], [self._ours], [], 0.1)[1]:
                    return
