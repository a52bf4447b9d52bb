# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The Crazyflie firmware as a Linux process, built by firmware/crazyflie/linux.

`Process` starts one and asks its bench; `RealPlayer` plays it the scripts of
`firmware_scenarios.py` over its own link.
"""

from collections.abc import Mapping
from contextlib import suppress
import os
from pathlib import Path
import socket
import subprocess
import threading
import time
from typing import Final, final, NamedTuple, Self

from firmware_scenarios import due, Packet, PERIOD, Sample, Scenario
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_config.schema.crazyflie_file import hash_airframe, load_crazyflie
from lta_config.schema.vehicle_file import load_vehicle_file
from ports import free_port, UDP

from campaigns import ROOT

SOURCES: Final = ROOT / 'firmware/crazyflie/linux'
LATEST: Final = 0.05  # s by which a packet of a script may be late
BOOTS: Final = 2.0  # s that a drone takes to calibrate its sensors when it is switched on
STARTS: Final = 20.0  # s within which the firmware must be up
READY: Final = SupervisorBit.CAN_BE_ARMED | SupervisorBit.ARMED  # after its own checks
ANSWERS: Final = 1.0  # s for one answer on this machine
BLIMP: Final = {  # a body of GT-MAB's size: 2 g heavy
    'LTA_BODY_MASS': '0.3', 'LTA_BODY_LIFT': '2.923', 'LTA_BODY_THRUST': '0.25',
    'LTA_BODY_DRAG': '0.3',
}  # fmt: skip


def build(firmware: Path, name: str, folder: Path) -> Path:
    """Build one of `BUILDS` from a folder of firmware sources; return the program."""
    out = folder / name
    airframe = hash_airframe(load_vehicle_file('gtmab'), load_crazyflie('gtmab'))
    words = ['make', '-s', '-j2', '-C', str(SOURCES), f'FIRMWARE={firmware}', f'BUILD={name}',
             f'OUT={out}', f'IDENTITY=-DLTA_VEHICLE={airframe:#x}u']  # fmt: skip
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f'The build {name} failed:\n{done.stderr[-2000:]}')
    return out / 'crazyflie'


def commit_of(firmware: Path) -> str:
    """Return the commit of the sources, with -modified where they were changed."""

    def git(*words: str) -> str:
        return subprocess.run(['git', '-C', str(firmware), *words], capture_output=True, text=True,
                              check=True).stdout.strip()  # fmt: skip

    changed = git('status', '--porcelain', '--untracked-files=no', 'src', 'configs', 'Kconfig')
    return git('rev-parse', 'HEAD') + ('-modified' if changed else '')


class TooLate(Exception):
    """The machine was too busy to play a script at its times."""


class Bench(NamedTuple):
    """What the bench tells: time since boot [ms], ratios [1/65535], compare values, range [m]."""

    stamp_ms: int
    ratios: tuple[int, ...]
    compares: tuple[int, ...]
    range: float


@final
class Process:
    """
    One running firmware.

    `program`: from `build`. `port`: of its link; 0 for any free one. `environment`: its body and
    clock (`linux_platform.c`, `body.c`).
    """

    def __init__(
        self, program: Path, port: int = 0, environment: Mapping[str, str] | None = None
    ) -> None:
        self._program, self._environment = program, dict(environment or {})
        self.port, self.bench_port = port or free_port(UDP), free_port(UDP)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(('127.0.0.1', self.bench_port))
        self._boot: threading.Timer | None = None
        self._start()

    def _start(self, **environment: str) -> None:
        self._process = subprocess.Popen(
            [self._program, str(self.port), str(self.bench_port)],
            env=os.environ | self._environment | environment,
        )
        until = time.monotonic() + STARTS
        while True:
            with suppress(OSError):  # nobody listens yet
                if self._ask('get').startswith('1'):
                    return
            if self._process.poll() is not None or time.monotonic() > until:
                raise SystemExit(f'{self._program} did not start ({self._process.returncode}).')
            time.sleep(0.02)

    @property
    def uri(self) -> str:
        """Where cflib finds it."""
        return f'udp://127.0.0.1:{self.port}'

    @property
    def pid(self) -> int:
        """The number of the process; SIGUSR1 switches the firmware off and on."""
        return self._process.pid

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Switch off."""
        if self._boot is not None:
            self._boot.cancel()
            self._boot.join()
        self._process.kill()
        self._process.wait()
        self._socket.close()

    def restart(self) -> None:
        """Switch off at once, and on after the time that a drone takes to start."""
        self._process.kill()
        self._process.wait()
        self._boot = threading.Timer(BOOTS, self._start)
        self._boot.start()

    def _ask(self, text: str, patience: float = ANSWERS) -> str:
        self._socket.settimeout(0.0)
        with suppress(BlockingIOError):  # late answers to what nobody waited for
            while self._socket.recv(256):
                pass
        self._socket.settimeout(patience)
        self._socket.send(text.encode())
        return self._socket.recv(256).decode()

    def look(self, patience: float = ANSWERS) -> Bench:
        """Return what the bench tells; `TimeoutError` after so long [s]."""
        words = self._ask('get', patience).split()
        numbers = tuple(map(int, words[1:10]))
        return Bench(numbers[0], numbers[1:5], numbers[5:9], float(words[10]))

    def set(self, name: str, value: float) -> None:
        """Change the body."""
        answer = self._ask(f'{name} {value}')
        assert answer == 'ok', answer


@final
class RealPlayer:
    """A script's player over a fresh process's own link."""

    def __init__(self, process: Process) -> None:
        self._process = process
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(('127.0.0.1', process.port))
        self._socket.settimeout(ANSWERS)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def send(self, packet: Packet) -> None:
        port, channel, data = packet
        self._socket.send(bytes([port << 4 | channel]) + data)

    def ask(self, packet: Packet) -> bytes:
        """Send a packet; return the next answer on its port and channel that repeats its head."""
        self.send(packet)
        head = packet[0] << 4 | packet[1]
        while True:
            data = self._socket.recv(64)
            if data[0] & 0xF3 == head:
                return data[1:]

    def answer(self, packet: Packet) -> bytes | None:
        """Send a packet; return its answer, None where there is none."""
        try:
            return self.ask(packet)
        except TimeoutError:
            return None

    def wait_until_ready(self) -> None:
        """Wait until the firmware has passed its own checks."""
        while not self.word() & READY:
            time.sleep(PERIOD)

    def word(self) -> int:
        """Return the supervisor's word."""
        while (answer := self.ask((9, 0, b'\x0c')))[0] != 0x8C:
            pass
        return int.from_bytes(answer[1:3], 'little')

    def play(self, scenario: Scenario) -> list[Sample]:
        """Play a script in real time."""
        self.wait_until_ready()
        samples: list[Sample] = []
        begun, last = time.monotonic(), 0.0
        for turn in range(round(scenario.seconds / PERIOD)):
            now = turn * PERIOD
            time.sleep(max(0.0, begun + now - time.monotonic()))
            if time.monotonic() > begun + now + LATEST:
                raise TooLate
            for at, name, value in scenario.bench:
                if last <= at < now:
                    self._process.set(name, value)
            for packet in due(scenario, last, now):
                self.send(packet)
            word, bench = self.word(), self._process.look()
            samples.append(Sample(time.monotonic() - begun, word, bench.ratios))
            last = now
        return samples
