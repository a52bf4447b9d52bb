# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Read a light board in a thread, and reopen its link after a loss."""

from collections.abc import Callable
import threading
import time
from typing import final

from lta_bridge.teensy.light_board import LightBlock, LightBoard, LightPeaks
from lta_bridge.teensy.port import BoardPort, open_port, Unplugged
from lta_config.errors import BadInput
from lta_graph.health import HealthFact, HealthLevel

GATHER = 1e-3  # s between reads: waking up for each frame would cost more than parsing it
READ_TIME = 0.05  # s that a read waits for bytes
BACK_OFF = (0.1, 0.2, 0.5, 1.0)  # s before reopening; the last value repeats


@final
class BoardReader:
    """
    Read one board in a thread.

    Parameters
    ----------
    address : str
        See `open_port`.
    board : LightBoard
        Parses the received bytes; belongs to the thread until it ends.
    publish : callable
        Called in the thread with each block or its peaks.
    clock : callable
        Returns the host time. [ns]

    Attributes
    ----------
    unplugged : int
        Number of times that the link was lost.
    trouble : str
        Why there is no link now; empty if there is one.

    Raises
    ------
    BadInput
        If the link cannot be opened the first time.

    """

    def __init__(
        self,
        address: str,
        board: LightBoard,
        publish: Callable[[LightBlock | LightPeaks], None],
        clock: Callable[[], int],
    ) -> None:
        self._address, self.board, self._publish, self._clock = address, board, publish, clock
        self.unplugged = 0
        self.trouble = ''
        # In the constructor, so that a wrong address is an error at once
        self._port: BoardPort | None = open_port(address)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name='light board', daemon=True)
        self._thread.start()

    @property
    def strangers(self) -> int:
        """Return the number of ignored messages from other senders than the board."""
        return 0 if self._port is None else self._port.strangers

    def close(self) -> None:
        """Stop the thread and close the link."""
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        failures = 0
        while not self._ended.is_set():
            try:
                if self._port is None:
                    self._port = open_port(self._address)
                    self.trouble = ''
                self._send_and_receive(self._port)
                failures = 0
            except (Unplugged, BadInput) as error:
                self._drop_port(str(error))
                # wait() rather than sleep(), so that close() ends the pause
                self._ended.wait(BACK_OFF[min(failures, len(BACK_OFF) - 1)])
                failures += 1
        if self._port is not None:
            self._port.close()

    def _send_and_receive(self, port: BoardPort) -> None:
        """Send due messages, read received bytes, and pause to collect more."""
        if due := self.board.compose_due_messages(self._clock()):
            port.write(due)
        if data := port.read(READ_TIME):
            for block in self.board.receive_bytes(data, self._clock()):
                self._publish(block)
        time.sleep(GATHER)

    def _drop_port(self, why: str) -> None:
        if self._port is not None:
            self._port.close()
            self._port = None
            self.unplugged += 1
        self.trouble = why


LIGHT_BOARD_TASK = 'light board'
SILENT_BOARD_NS = 500_000_000  # silence that counts as an error: five blocks


def describe_health(reader: BoardReader | None, now_ns: int, active: bool) -> HealthFact:
    """Return the health at a host time [ns]; without a reader it is not configured."""
    if reader is None:
        return HealthFact(LIGHT_BOARD_TASK, HealthLevel.WARN, 'not configured')
    level, message = _assess_health(reader, now_ns, active)
    return HealthFact(
        LIGHT_BOARD_TASK, level, message, _collect_diagnostic_values(reader, reader.board)
    )


def _assess_health(reader: BoardReader, now_ns: int, active: bool) -> tuple[HealthLevel, str]:
    board = reader.board
    if reader.trouble:
        return HealthLevel.ERROR, reader.trouble
    if not board.heard_ns:
        return HealthLevel.WARN, 'nothing received yet'
    if now_ns - board.heard_ns > SILENT_BOARD_NS:
        return HealthLevel.ERROR, (
            f'no data from the light board for {1e-9 * (now_ns - board.heard_ns):.1f} s'
        )
    if board.fault:
        return HealthLevel.ERROR, board.fault
    if not board.clock.is_synchronized:
        return HealthLevel.WARN, 'the clock of the light board is not synchronized yet'
    return HealthLevel.OK, 'receiving light' if active else 'receiving light, not publishing'


def _collect_diagnostic_values(reader: BoardReader, board: LightBoard) -> dict[str, str]:
    framing, blocks, clock = board.framing, board.blocks, board.clock
    figures: dict[str, object] = {
        'frames': framing.frames,
        'crc_errors': framing.crc_errors,
        'unknown': framing.unknown,
        'stray_bytes': framing.stray,
        'blocks': blocks.whole,
        'blocks_torn': blocks.torn,
        'rows_lost': blocks.lost,
        'rows_old': blocks.old,
        'undated': board.undated,
        'unfit': board.unfit,
        'of_other_systems': board.sender.others,
        'of_other_senders': reader.strangers,
        'unanswered': board.unanswered,
        'overruns': board.overruns,
        'peaks': board.peaks,
        'unplugged': reader.unplugged,
        'restarts': clock.restarts,
    }
    if clock.is_synchronized:
        figures['drift_ppm'] = f'{1e6 * clock.drift:.1f}'
        figures['uncertainty_ms'] = f'{1e3 * clock.uncertainty:.3f}'
        figures['round_trip_ms'] = f'{1e-6 * clock.round_trip:.3f}'
    return {key: str(value) for key, value in figures.items()}
