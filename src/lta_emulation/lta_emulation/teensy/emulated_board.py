# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Emulate a light board: its messages for given samples, and its clock.

It serves to test the bridge and to run a graph without hardware.
"""

from collections.abc import Callable, Iterator
import os
from pathlib import Path
import select
import termios
import tty
from typing import final

from lta_bridge.teensy._generated import mavlink
from lta_bridge.teensy.block_assembler import FrameParser
from lta_bridge.teensy.light_board import (
    ACTIVE,
    BLOCK_VALUES,
    CONTROLLER,
    DIALECT_VERSION,
    NO_AUTOPILOT,
    PROTOCOL,
)
from lta_config.errors import BadInput
import numpy as np
from numpy.typing import NDArray

# MAVLink ids; 191 is an onboard computer
SYSTEM, COMPONENT = 1, 191
MESSAGE_PEAKS = max(mavlink.MAVLink_lta_light_peaks_message.array_lengths)  # in a message of peaks
WRAP = 2**32


@final
class EmulatedBoard:
    """
    A board that was switched on at a given host time.

    Parameters
    ----------
    boot_ns : int
        Host time of switching on. [ns]
    sample_rate : float
        Row rate by its clock. [Hz]
    diodes : int
        Values in a row.
    drift : float
        Relative rate error of its clock, positive if it runs fast.
    transmit : callable
        Returns the bytes that arrive of a frame of light, from its number, from 1 on.
    first : int
        Number of its first row.
    dialect : int
        Version of its messages.
    bits : int
        Of its converter.
    vehicle : int
        Hash of the diodes that its firmware was built for; 0 is unknown.

    Attributes
    ----------
    sent : int
        Number of light frames so far, including lost ones.

    """

    def __init__(
        self,
        boot_ns: int,
        sample_rate: float = 10e3,
        diodes: int = 8,
        drift: float = 0.0,
        transmit: Callable[[int, bytes], bytes] = lambda _, frame: frame,
        first: int = 0,
        dialect: int = DIALECT_VERSION,
        bits: int = 12,
        vehicle: int = 0,
    ) -> None:
        self._boot_ns, self._rate, self._diodes, self._drift = boot_ns, sample_rate, diodes, drift
        self._transmit = transmit
        self._dialect, self._bits, self._vehicle = dialect, bits, vehicle
        self._first, self._rows = first, 0
        self._paused = 0  # ns of its clock without sampling
        self._hears, self._link = FrameParser(), mavlink.MAVLink(None, SYSTEM, COMPONENT)
        self._left = np.empty((0, diodes), np.uint16)
        self.sent = 0

    def to_board_time(self, our_ns: int) -> int:
        """Convert a host time to board time [ns]."""
        since = our_ns - self._boot_ns
        # Integers keep nanoseconds exact at any age; only the small drift term is a float
        return since + round(since * self._drift)

    def row_time_ns(self, row: int) -> int:
        """Return the host time at which it samples a row, counted from 0 [ns]."""
        return self._boot_ns + round(row / self._rate / (1.0 + self._drift) * 1e9)

    def encode_light(self, samples: NDArray[np.uint16], begun_ns: int | None = None) -> bytes:
        """
        Return the frames of the next rows; rows that do not fill a frame are kept.

        `samples`, shape (n, diodes): ADC counts. `begun_ns`: host time of the first sample; by
        default the rows follow the previous ones. Rows from before its boot are ignored.
        """
        if begun_ns is not None:
            if begun_ns < self._boot_ns:
                return b''
            # Rows of this block follow those that wait for a full frame
            sampled = self._rows + len(self._left)
            self._paused = self.to_board_time(begun_ns) - round(sampled / self._rate * 1e9)
        return b''.join(self._encode_rows(samples))

    @property
    def _time_usec(self) -> int:
        """Board time of the next row to send [us]."""
        return round(self._rows / self._rate * 1e6 + self._paused / 1e3)

    def _encode_rows(self, samples: NDArray[np.uint16]) -> Iterator[bytes]:
        # Rows per frame; the rest of the fixed-size array stays zero
        count = BLOCK_VALUES // self._diodes
        self._left = np.concatenate([self._left, samples])
        while len(self._left) >= count:
            rows, self._left = self._left[:count], self._left[count:]
            values = np.zeros(BLOCK_VALUES, np.uint16)
            values[: rows.size] = rows.ravel()
            frame = self._build_frame(
                mavlink.MAVLink_lta_light_block_message(
                    time_usec=self._time_usec,
                    # The row counter has 32 bits
                    sequence=(self._first + self._rows) % WRAP,
                    diodes=self._diodes,
                    rows=count,
                    samples=values.tolist(),
                )
            )
            self._rows += count
            self.sent += 1
            yield self._transmit(self.sent, frame)

    def encode_peaks(
        self, samples: NDArray[np.uint16], frequency: float, begun_ns: int | None = None
    ) -> bytes:
        """
        Return the frame of the detected peaks, computed as in its firmware (core/goertzel.c).

        `samples`, shape (n, diodes): ADC counts of the window. `frequency`: of the beacon [Hz].
        `begun_ns`: as for `encode_light`.
        """
        count = len(samples)
        if begun_ns is not None:
            if begun_ns < self._boot_ns:
                return b''
            self._paused = self.to_board_time(begun_ns) - round(self._rows / self._rate * 1e9)
        waves = samples - samples.mean(axis=0)
        # One bin of the discrete Fourier transform, equal to the Goertzel filter of the firmware
        turns = np.exp(-2j * np.pi * frequency / self._rate * np.arange(count))
        amplitude = 2.0 / count * np.abs(turns @ waves)
        # A sine of amplitude A has a variance of A^2 / 2; the remaining variance is noise
        rest = np.sqrt(np.maximum(np.mean(waves**2, axis=0) - 0.5 * amplitude**2, 0.0))
        # Pad the values to the fixed array length of the message
        room = MESSAGE_PEAKS - self._diodes
        frame = self._build_frame(
            mavlink.MAVLink_lta_light_peaks_message(
                time_usec=self._time_usec,
                sequence=(self._first + self._rows) % WRAP,
                window=count,
                frequency=frequency,
                diodes=self._diodes,
                amplitude=np.pad(amplitude, (0, room)).tolist(),
                noise=np.pad(rest, (0, room)).tolist(),
            )
        )
        self._rows += count
        return frame

    def encode_status(self) -> bytes:
        """Return the heartbeat and status, sent once a second."""
        beat = self._build_frame(
            mavlink.MAVLink_heartbeat_message(
                type=CONTROLLER,
                autopilot=NO_AUTOPILOT,
                base_mode=0,
                custom_mode=0,
                system_status=ACTIVE,
                mavlink_version=PROTOCOL,
            )
        )
        return beat + self._build_frame(
            mavlink.MAVLink_lta_light_status_message(
                time_usec=self._time_usec,
                rows=(self._first + self._rows) % WRAP,
                overruns=0,
                sample_rate=self._rate,
                diodes=self._diodes,
                adc_bits=self._bits,
                dialect=self._dialect,
                commit=0,
                vehicle=self._vehicle,
            )
        )

    def answer_timesync(self, data: bytes, now_ns: int) -> bytes:
        """Return the answers to received bytes at a host time [ns]."""
        board_ns = self.to_board_time(now_ns)
        return b''.join(
            self._build_frame(mavlink.MAVLink_timesync_message(tc1=board_ns, ts1=message.ts1))
            for message in self._hears.parse_frames(data)
            # A nonzero tc1 marks an answer of another participant
            if isinstance(message, mavlink.MAVLink_timesync_message) and message.tc1 == 0
        )

    def _build_frame(self, message: mavlink.MAVLink_message) -> bytes:
        frame = message.pack(self._link)
        self._link.seq = (self._link.seq + 1) % 256
        return frame


@final
class Cable:
    """
    A pseudo terminal whose name stays the same when it is unplugged and plugged in again.

    `name`: path that the other side opens. Raise `BadInput` if it cannot be created, or is there
    and no link, as a port that was left behind would be.
    """

    def __init__(self, name: Path) -> None:
        self._name = name
        self._ours: int | None = None
        self.plug()

    def plug(self) -> None:
        """Plug the cable in."""
        self._ours, theirs = os.openpty()
        # Without raw mode the terminal would echo and translate line ends
        tty.setraw(theirs, termios.TCSANOW)
        # A full buffer must not block the emulation when nobody reads
        os.set_blocking(self._ours, False)
        try:
            if self._name.is_symlink():
                self._name.unlink()
            # The name of a pseudo terminal changes at each opening; the link does not
            self._name.symlink_to(os.ttyname(theirs))
        except OSError as error:
            raise BadInput(
                f"The light board's port '{self._name}' cannot be created ({error.strerror}); "
                'remove what is there, or give another path as light port.'
            ) from None
        finally:
            os.close(theirs)

    def pull(self) -> None:
        """Unplug the cable; the other side's port vanishes."""
        if self._name.is_symlink():
            self._name.unlink(missing_ok=True)
        if self._ours is not None:
            os.close(self._ours)
            self._ours = None

    def read(self, timeout: float = 0.0) -> bytes:
        """Return the bytes received within a time [s]; empty if the port is not open."""
        if self._ours is None:
            return b''
        try:
            ready = select.select([self._ours], [], [], timeout)[0]
            return os.read(self._ours, 65536) if ready else b''
        except OSError:  # the other end is not open
            return b''

    def write(self, data: bytes) -> None:
        """Send the data; bytes that the other side does not read within 0.1 s are lost."""
        while data and self._ours is not None:
            try:
                data = data[os.write(self._ours, data) :]
            except BlockingIOError:
                if not select.select([], [self._ours], [], 0.1)[1]:
                    return
