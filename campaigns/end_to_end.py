# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly to the lamp through the real firmware of the drone and of the light board.

The Crazyflie firmware of `--firmware` runs as a Linux process (firmware/crazyflie/linux), the
portable part of the light board's firmware on a Cortex-M7 that QEMU emulates
(firmware/light_board/mps2_an500). One simulated world moves by
the motors of the first, gives it what its sensors read, and gives the second the samples of its
converter. The graph flies both over UDP and a serial port, in real time, as it would fly a drone.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
import mmap
import os
from pathlib import Path
import select
import subprocess
import sys
import termios
import time
import tty
from typing import Final, final, Self

from command import Lta
from diagnostic_msgs.msg import DiagnosticArray
from lta_config.schema.crazyflie_file import hash_diodes
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_emulation.crazyflie.commander import BodyCommand
from lta_emulation.crazyflie.firmware_bench import FirmwareBench
from lta_emulation.crazyflie.simulated_body import SimulatedBody
from lta_emulation.emulated_hardware import build_simulated_body
from lta_emulation.step_thread import StepThread
import numpy as np
from numpy.typing import NDArray
from peer import Peer
from std_srvs.srv import SetBool

from campaigns import ROOT
from campaigns.firmware import check_sources
from campaigns.graph_trial import Outcome, READY, try_flight
from campaigns.harness import Campaign, Case, Row, Rows
from campaigns.linux_crazyflie import build, Process

LONGEST: Final = 80.0  # s from take-off to the lamp
LANDS: Final = 30.0  # s from the request to motors that stand
MEMORY: Final = 1 << 24  # bytes that the board shares with us (flight.c)
FIRST: Final = 64  # byte after the count
CONVERTER_ROWS: Final = 1 << 19
LINK, LINK_BYTES = 0xC00000, 1 << 20
BOARD: Final = 'flight.elf'  # program of the light board, from firmware/light_board


@dataclass(frozen=True, slots=True)
class FirmwareFlight(Outcome):
    """
    A flight.

    Attributes
    ----------
    begun, closest : float
        Distance from the lamp. [m]
    reached : float or None
        Time to the lamp. [s]
    missed : int
        Exchanges that the firmware missed.
    emulation : float
        Processor time that the light board took in a second of flight. [s]

    """

    begun: float = 0.0
    reached: float | None = None
    closest: float = 0.0
    missed: int = 0
    emulation: float = 0.0


@final
class EmulatedCore:
    """
    The portable part of the light board's firmware on a Cortex-M7 that QEMU emulates.

    Its converter and its link are memory that both share, in the place of DMA:
    `firmware/light_board/mps2_an500/flight.c`.

    `program`: from firmware/light_board. `folder`: for the shared memory and its serial port.
    """

    def __init__(self, program: Path, folder: Path) -> None:
        self._program, self._file = program, folder / 'memory'
        self._rows = self._sent = 0
        self._near, theirs = os.openpty()
        tty.setraw(theirs, termios.TCSANOW)
        os.set_blocking(self._near, False)
        self.port = os.ttyname(theirs)
        self._far = theirs  # stays open: without a reader the port would be gone
        with self._file.open('wb') as file:
            file.truncate(MEMORY)
        # Until the bridge has asked for the time nobody reads; afterwards nothing is lost, as
        # the memory holds 6 s
        self._is_open, self._pending = False, b''
        self._relay = StepThread(self._carry, 'relay')

    def __enter__(self) -> Self:
        memory = f'memory-backend-file,id=shared,size={MEMORY},mem-path={self._file},share=on'
        words = ['qemu-system-arm', '-object', memory, '-M', 'mps2-an500,memory-backend=shared',
                 '-display', 'none', '-monitor', 'none', '-serial', 'stdio', '-kernel',
                 self._program]  # fmt: skip
        self._process = subprocess.Popen(words, stdin=subprocess.PIPE, bufsize=0)
        with self._file.open('r+b') as file:
            self._memory = mmap.mmap(file.fileno(), MEMORY)
        counts = memoryview(self._memory).cast('I')
        self._rows_count, self._link_count = counts[:1], counts[LINK // 4 : LINK // 4 + 1]
        self._relay.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._relay.stop()
        self._process.kill()
        self._process.communicate()
        os.close(self._near)
        os.close(self._far)

    @property
    def processor_time(self) -> float:
        """Time of a processor of this machine that the emulation has taken [s]."""
        return read_processor_time(self._process.pid)

    def sample_light(self, _begun: float, samples: NDArray[np.uint16]) -> None:
        """Give the board a block; shape (samples, diodes)."""
        data = samples.astype('<u2').tobytes()
        size = len(data) // len(samples)
        for turn in range(len(samples)):
            place = FIRST + size * ((self._rows + turn) % CONVERTER_ROWS)
            self._memory[place : place + size] = data[size * turn : size * (turn + 1)]
        # The count after the rows that it shows, in one store
        self._rows += len(samples)
        self._rows_count[0] = self._rows

    def _carry(self) -> None:
        assert self._process.stdin is not None
        if select.select([self._near], [], [], 0.002)[0]:
            self._process.stdin.write(os.read(self._near, 65536))
            self._is_open = True
        if not self._pending:
            sent = self._read_link()
            self._pending = sent if self._is_open else b''
        with suppress(BlockingIOError):
            if self._pending:
                self._pending = self._pending[os.write(self._near, self._pending) :]

    def _read_link(self) -> bytes:
        """Return what the board has sent since the last call."""
        begun, ended = self._sent, self._link_count[0]
        self._sent, first = ended, LINK + FIRST
        begun, ended = begun % LINK_BYTES, begun % LINK_BYTES + (ended - begun)
        data = self._memory[first + begun : first + min(ended, LINK_BYTES)]
        return data + self._memory[first : first + max(0, ended - LINK_BYTES)]


def read_processor_time(process: int) -> float:
    """Return the time of a processor that a process has taken [s]."""
    words = Path(f'/proc/{process}/stat').read_text().rpartition(')')[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf('SC_CLK_TCK')


@contextmanager
def serve(
    programs: Path, folder: Path, seed: int
) -> Iterator[tuple[SimulatedBody, FirmwareBench, EmulatedCore]]:
    """Serve both boards and their world."""
    light = EmulatedCore(programs / BOARD, folder)
    body = build_simulated_body('gtmab', 'lamp_room', seed, light.sample_light)
    # The first step compiles the model for seconds, in which the board would count on
    body.advance(0.011, BodyCommand((0.0,) * 4))
    with (
        Process(programs / 'app' / 'crazyflie') as firmware,
        light,
        FirmwareBench(body, firmware.bench_port, firmware.port) as bench,
    ):
        yield body, bench, light


def fly(programs: Path, seed: int, folder: Path, peer: Peer) -> FirmwareFlight:
    """Fly to the lamp, and ask for a landing."""
    facts: dict[str, str] = {}
    with serve(programs, folder, seed) as (body, bench, light):
        lta, world = Lta(), body.world
        listen(peer, facts)
        graph = lta.start(
            'launch', 'fly', 'source:=crazyflie', f'uri:={bench.uri}', 'light_board:=true',
            f'light_port:={light.port}', 'light_patience:=60.0', 'record:=false',
        )  # fmt: skip
        try:
            peer.until(lambda: all(facts.get(name) == word for name, word in READY.items()))
            begun, missed = float(world.goal_distance), bench.missed
            peer.arm_until(lambda: any(body.duties))
            since, distances, busy = time.monotonic(), [begun], light.processor_time

            def is_over() -> bool:
                distances.append(float(world.goal_distance))
                return bool(world.is_at_lamp) or time.monotonic() > since + LONGEST

            peer.until(is_over)
            flown = time.monotonic() - since
            reached = flown if world.is_at_lamp else None
            emulation = (light.processor_time - busy) / flown
            peer.ask(SetBool, 'crazyflie_bridge/arm', data=False)
            asked = time.monotonic()
            peer.until(lambda: not any(body.duties) or time.monotonic() > asked + LANDS)
            took = None if any(body.duties) else time.monotonic() - asked
            graph.interrupt()
            graph.end()
        finally:
            lta.kill()
    wrong = '' if reached is not None and took is not None else 'the lamp was not reached'
    if reached is not None and took is None:
        wrong = 'the motors did not stop'
    return FirmwareFlight(
        took=took, wrong=wrong, begun=begun, reached=reached, closest=min(distances),
        missed=bench.missed - missed, emulation=emulation,
    )  # fmt: skip


def listen(peer: Peer, facts: dict[str, str]) -> None:
    """Keep the newest message of each task in /diagnostics."""

    def hear(array: DiagnosticArray) -> None:
        facts.update((status.name.rpartition('/')[2], status.message) for status in array.status)

    peer.node.create_subscription(DiagnosticArray, '/diagnostics', hear, 100)


def prepare(options: Namespace) -> None:
    """Build both firmwares, with the hashes of the vehicle inside."""
    programs = options.out.resolve() / 'programs'
    build(check_sources(options), 'app', programs)
    diodes = hash_diodes(load_vehicle_file('gtmab'))
    words = ['make', '-s', '-C', ROOT / 'firmware/light_board', programs / BOARD,
             f'BUILD={programs}', f'PYTHON={sys.executable}',
             f'IDENTITY=-DLTA_VEHICLE={diodes:#x}u']  # fmt: skip
    subprocess.run(words, check=True)


def run(case: Case, options: Namespace) -> Row:
    """Return the row of a flight; its number is the seed."""
    programs = options.out.resolve() / 'programs'
    return try_flight(lambda folder, peer: fly(programs, case.number, folder, peer))


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the span of each figure over the flights."""
    reached = sum(row.get('reached') is not None for row in rows.values())
    stopped = sum(row.get('took') is not None for row in rows.values())
    yield f'{reached} of {len(rows)} flights reached the lamp; the motors of {stopped} stopped.'
    yield ''
    yield (
        '| flights | start [m from the lamp] | reached after [s] | closest [m] | '
        'motors stopped after [s] | missed exchanges |'
    )
    yield '|---|---|---|---|---|---|'
    figures = (('begun', 1), ('reached', 1), ('closest', 2), ('took', 1), ('missed', 0))
    cells = (
        format_span([row[name] for row in rows.values() if row.get(name) is not None], digits)
        for name, digits in figures
    )
    yield f'| {len(rows)} | {" | ".join(cells)} |'


def format_span(values: Sequence[float], digits: int) -> str:
    """Return the lowest and the highest value, '-' without any."""
    if not values:
        return '-'
    low, high = f'{min(values):.{digits}f}', f'{max(values):.{digits}f}'
    return low if low == high else f'{low} to {high}'


def add_arguments(parser: ArgumentParser) -> None:
    """Add the sources."""
    parser.add_argument('--firmware', type=Path, help='folder of the sources, at tag 2026.08')


CAMPAIGN: Final = Campaign(
    lambda options: ['lamp_room'], run, list_table, each=20, add_arguments=add_arguments,
    page='hardware_flights.md', alone=True, patience=400.0, prepare=prepare,
)  # fmt: skip
