# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Tiny processes for a launcher to supervise."""

from dataclasses import replace
import os
from pathlib import Path
import signal
import sys

from lta_graph.launch_plan import LaunchPlan, LaunchProcess
from lta_graph.launcher import Launcher
import pytest
from waiting import PATIENCE, wait_until

MARKERS = 'share/ament_index/resource_index/packages'
FOREVER = 'import time\nprint("up", flush=True)\ntime.sleep(600)\n'
# Handlers write with os.write: a signal may come while `print` still holds its buffer.
DEAF = """
import os, signal, time
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, lambda got, _: os.write(1, f'{signal.Signals(got).name}\\n'.encode()))
os.write(1, b'up\\n')
while True:
    time.sleep(600)
"""
IGNORANT = """
import signal, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
print('up', flush=True)
time.sleep(600)
"""
POLITE = """
import os, signal, time
def leave(number, _):
    os.write(1, b'closing\\n')
    time.sleep(0.3)
    os.write(1, b'closed\\n')
    os._exit(0)
signal.signal(signal.SIGINT, leave)
os.write(1, b'up\\n')
time.sleep(600)
"""


class Fleet:
    """A package of throw-away executables, and the lines that they wrote."""

    def __init__(self, prefix: Path) -> None:
        self.folder = prefix / 'lib' / 'fleet'
        self.folder.mkdir(parents=True)
        (prefix / MARKERS).mkdir(parents=True)
        (prefix / MARKERS / 'fleet').touch()
        self.lines: list[tuple[str, str]] = []
        self.processes: list[LaunchProcess] = []

    def add(self, name: str, code: str, *, args: tuple[str, ...] = (), **more: object):
        path = self.folder / name
        path.write_text(f'#!{sys.executable} -IS\n{code}', encoding='utf-8')
        path.chmod(0o755)
        process = LaunchProcess('fleet', name, name, words=args, planned=True)
        self.processes.append(replace(process, **more))

    def launcher(self, grace: float = PATIENCE) -> Launcher:
        plan = LaunchPlan(tuple(self.processes))
        return Launcher(plan, lambda *line: self.lines.append(line), grace=grace)

    def await_line(self, *line: str) -> None:
        wait_until(lambda: line in self.lines, f'the line {line}', lambda: self.lines)

    def pids(self) -> list[int]:
        return pids_of(self.folder)

    def await_pids(self, count: int) -> None:
        wait_until(lambda: len(self.pids()) == count, f'{count} living processes', self.pids)


def pids_of(folder: Path) -> list[int]:
    """The living processes that run something in a folder, as the system sees them."""
    found = []
    for entry in Path('/proc').iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / 'cmdline').read_bytes()
                state = (entry / 'stat').read_text().rsplit(')', 1)[1].split()[0]
            except OSError:
                continue
            if f'{folder}/'.encode() in words and state != 'Z':
                found.append(int(entry.name))
    return found


@pytest.fixture
def fleet(tmp_path, monkeypatch):
    made = Fleet(tmp_path / 'prefix')
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path / 'prefix'))
    yield made
    left = made.pids()
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    assert not left, 'processes were left behind'


def run_to_end(launcher: Launcher) -> None:
    wait_until(
        lambda: launcher.outcome is not None,
        'the end of the run',
        lambda: launcher.ended,
        step=lambda: launcher.wait(1.0),
    )
