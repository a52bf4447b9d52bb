# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Serve the emulated light board on a pseudo terminal, in real time, in a separate thread."""

from pathlib import Path
from queue import Empty, SimpleQueue
import time
from typing import Final, final, Self

from lta_emulation.step_thread import StepThread
from lta_emulation.teensy.emulated_board import Cable, EmulatedBoard
import numpy as np
from numpy.typing import NDArray

REQUEST_WAIT: Final = 0.002  # s to wait for a request
BEAT_NS: Final = 1_000_000_000  # between two heartbeats


@final
class BoardServer:
    """
    A light board on a pseudo terminal.

    Parameters
    ----------
    board : EmulatedBoard
        Booted at 0 of `now_ns`.
    name : Path
        What the bridge opens.
    beacon : float
        Beacon frequency at which it detects peaks itself; 0 to send all samples. [Hz]

    Attributes
    ----------
    board : EmulatedBoard
        Replace it to emulate a restart.
    silent : bool
        Whether it sends nothing.
    cable : Cable
        Used by the thread only; callers set `plugged`.
    plugged : bool
        Whether the cable is plugged in; may be set.

    """

    def __init__(self, board: EmulatedBoard, name: Path, beacon: float = 0.0) -> None:
        self.board, self.silent = board, False
        self._name, self._beacon = name, beacon
        self.cable, self.plugged = Cable(name), True
        self._began = time.monotonic_ns()
        # The simulation's thread puts blocks in, the board's thread takes them out
        self._blocks: SimpleQueue[tuple[int, NDArray[np.uint16]]] = SimpleQueue()
        self._beat, self._was_plugged = 0, True
        self._thread = StepThread(self._serve, 'emulated_board')

    @property
    def now_ns(self) -> int:
        """Time since the boot [ns]."""
        return time.monotonic_ns() - self._began

    @property
    def port(self) -> str:
        """Return what the bridge opens."""
        return str(self._name)

    def __enter__(self) -> Self:
        """Boot."""
        self._began = time.monotonic_ns()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Switch off and pull the cable."""
        self._thread.stop()
        self.cable.pull()

    def toggle_cable(self) -> None:
        """Unplug the cable, or plug it in."""
        self.plugged = not self.plugged

    def sample_light(self, begun: float, samples: NDArray[np.uint16]) -> None:
        """Sample a block, from a time since the boot on [s]; shape (samples, diodes)."""
        self._blocks.put((round(1e9 * begun), samples))

    def _serve(self) -> None:
        if self.plugged != self._was_plugged:
            self._was_plugged = not self._was_plugged
            # Only this thread touches the cable, so no lock is needed
            (self.cable.plug if self._was_plugged else self.cable.pull)()
        looked = self.now_ns
        received = self.cable.read(REQUEST_WAIT)
        self._write_to_cable(self.board.answer_timesync(received, self.now_ns))
        if self.now_ns >= self._beat:
            self._beat = self.now_ns + BEAT_NS
            self._write_to_cable(self.board.encode_status())
        self._send_light()
        if not received and self.now_ns - looked < 1e9 * REQUEST_WAIT:
            time.sleep(REQUEST_WAIT)  # reading a port that is not open returns at once

    def _send_light(self) -> None:
        try:
            begun_ns, samples = self._blocks.get_nowait()
        except Empty:
            return
        # With a beacon frequency, the board sends peaks instead of raw samples
        if self._beacon:
            self._write_to_cable(self.board.encode_peaks(samples, self._beacon, begun_ns))
        else:
            self._write_to_cable(self.board.encode_light(samples, begun_ns))

    def _write_to_cable(self, data: bytes) -> None:
        if not self.silent:
            self.cable.write(data)
