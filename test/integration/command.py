# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The real `lta` command as a process, its nodes, and the watch over what it leaves behind."""

from collections.abc import Sequence
from contextlib import suppress
import os
from pathlib import Path
import re
import signal
import subprocess
import threading
import time
import uuid

from signals import heed_signals
from time_report import process_started, spent
from waiting import PATIENCE, wait_until

ROOT = Path(__file__).resolve().parents[2]
MARK = 'LTA_TEST_MARK'
NODES = (  # whose end ends a flight
    'simulator',
    'estimator',
    'controller',
    'demodulator',
    'navigator',
    'energy_monitor',
    'recorder',
)
ALL_NODES = {*NODES, 'description'}
LINGER = 20.0  # s for which the dead may stand in /proc on a busy machine


def processes(mark: str) -> dict[int, str]:
    """Return every living process that carries a test's mark: command line by process id."""
    found = {}
    for folder in Path('/proc').glob('[0-9]*'):
        try:
            if f'{MARK}={mark}'.encode() in (folder / 'environ').read_bytes():
                text = (folder / 'cmdline').read_bytes().replace(b'\0', b' ').decode()
                found[int(folder.name)] = text
        except OSError:
            continue
    return found


class Started:
    """A running command: its lines with the time at which they came, and its nodes."""

    def __init__(
        self, mark: str, arguments: tuple[str, ...], program: Sequence[str | Path], **more: str
    ) -> None:
        self._mark = mark
        self.lines: list[tuple[float, str]] = []
        self.popen = subprocess.Popen(
            [*program, *arguments],
            env={**os.environ, **more, MARK: mark},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
            preexec_fn=heed_signals,
        )
        process_started()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        with self.popen.stdout:
            for line in self.popen.stdout:
                self.lines.append((time.monotonic(), line.rstrip()))

    @property
    def text(self) -> str:
        return '\n'.join(line for _, line in self.lines if line)

    def node(self, name: str, robot: str = 'lta1') -> int:
        """Return the process id of a node; of one without namespace where no robot is named."""
        marked = processes(self._mark).items()
        words = f'__node:={name} ' + (f'-r __ns:=/{robot} ' if robot else '')
        (pid,) = [pid for pid, line in marked if words in line]
        return pid

    def holds_interrupts(self) -> None:
        """Wait until the command blocks or catches Ctrl-C, however late its shell begins."""

        def held() -> bool:
            status = Path(f'/proc/{self.popen.pid}/status').read_text()
            masks = re.findall(r'^Sig(?:Blk|Cgt):\s+(\w+)', status, re.MULTILINE)
            return any(int(mask, 16) >> (signal.SIGINT - 1) & 1 for mask in masks)

        wait_until(held, 'the block of SIGINT', lambda: self.text)

    def interrupt(self) -> float:
        """Press Ctrl-C: the signal goes to the foreground process group. Return when."""
        os.killpg(self.popen.pid, signal.SIGINT)
        return time.monotonic()

    def said(self, word: str) -> float:
        """Wait until a line holds a word, and return when it came."""

        def found() -> float | None:
            return next((when for when, line in self.lines if word in line), None)

        return wait_until(found, repr(word), lambda: self.text)

    def end(self) -> int:
        """Wait for the end and return the exit status."""
        wait_until(lambda: self.popen.poll() is not None, 'the end', lambda: self.text)
        self._reader.join(PATIENCE)
        return self.popen.returncode


class Lta:
    """Runs the command and knows what it started."""

    def __init__(self) -> None:
        self.mark = uuid.uuid4().hex
        self._started: list[Started] = []

    def run(self, *arguments: object) -> 'subprocess.CompletedProcess[str]':
        """Run to the end."""
        with spent():
            return subprocess.run(
                [ROOT / 'lta', *map(str, arguments)],
                env={**os.environ, MARK: self.mark},
                capture_output=True,
                text=True,
                timeout=PATIENCE,
            )

    def start(
        self, *arguments: object, program: Sequence[str | Path] = (ROOT / 'lta',), **more: str
    ) -> Started:
        """Start the command, or another program, with further environment variables."""
        self._started.append(Started(self.mark, tuple(map(str, arguments)), program, **more))
        return self._started[-1]

    @property
    def text(self) -> str:
        """What all that was started has said."""
        return '\n'.join(started.text for started in self._started)

    def left(self) -> list[str]:
        """Return what still runs, once the kernel has had time to take the dead away."""
        with suppress(AssertionError):
            wait_until(lambda: not processes(self.mark), 'processes to go', patience=LINGER)
        return list(processes(self.mark).values())

    def kill(self) -> None:
        for pid in processes(self.mark):
            os.kill(pid, signal.SIGKILL)
        for started in self._started:
            started.end()  # its pipe would fail whichever test comes next
