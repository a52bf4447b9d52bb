"""A launcher in a process of its own: Ctrl-C ends all in order, and its death takes all along."""

import os
import re
import signal
import subprocess
import sys
import threading
import time

import pytest

from .tiny_processes import DEAF, FOREVER, IGNORANT, POLITE, until
from .tiny_processes import fleet as fleet

# Real processes against the wall clock: nothing else may run beside them.
pytestmark = pytest.mark.integration

LAUNCH = """
import os, sys
from lta_graph.launch_file import LaunchPlan, Process
from lta_graph import launcher

launcher.TERM_GRACE = 0.5
plan = LaunchPlan(tuple(Process('fleet', n, n, '/', (), False) for n in sys.argv[2:]))
def say(*words):  # one write a line: two threads speak here
    os.write(1, (' '.join(words) + '\\n').encode())
try:
    with launcher.Launcher(plan, say, grace=float(sys.argv[1])) as it:
        say('started')
        while it.outcome is None:
            it.wait(0.2)
except KeyboardInterrupt:
    say('interrupted')
    sys.exit(130)
"""


class Program:
    """A launcher in a process of its own, to which signals can be sent."""

    def __init__(self, grace: float, *names: str) -> None:
        path = ':'.join(item for item in sys.path if item)
        self.popen = subprocess.Popen(
            [sys.executable, '-c', LAUNCH, str(grace), *names],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, 'PYTHONPATH': path},
            # A shell's background job ignores Ctrl-C, and so does what it starts.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )
        self._watchdog = threading.Timer(20.0, self.popen.kill)  # so that no test can hang
        self._watchdog.start()

    def read_until(self, *wanted: str) -> None:
        missing = set(wanted)
        while missing:
            line = self.popen.stdout.readline()
            assert line, f'it ended without {missing}'
            missing.discard(line.strip())

    def rest(self) -> tuple[int, list[str]]:
        out, _ = self.popen.communicate(timeout=10)
        self._watchdog.cancel()
        return self.popen.returncode, out.splitlines()


def test_ctrl_c_ends_everything_in_order(fleet):
    fleet.add('recorder', POLITE)
    fleet.add('simulator', FOREVER)
    program = Program(5.0, 'recorder', 'simulator')
    program.read_until('started', 'recorder up', 'simulator up')
    program.popen.send_signal(signal.SIGINT)
    status, lines = program.rest()
    assert status == 130
    assert [line for line in lines if 'clos' in line] == ['recorder closing', 'recorder closed']
    assert lines[-1] == 'interrupted'
    assert fleet.pids() == []


def test_a_second_ctrl_c_shortens_the_grace(fleet):
    fleet.add('deaf', DEAF)
    program = Program(60.0, 'deaf')
    program.read_until('started', 'deaf up')
    program.popen.send_signal(signal.SIGINT)
    before = time.monotonic()
    program.read_until('deaf SIGINT')
    program.popen.send_signal(signal.SIGINT)
    program.read_until('deaf SIGTERM')
    status, lines = program.rest()
    assert time.monotonic() - before < 5.0
    assert (status, lines[-1]) == (130, 'interrupted')
    assert fleet.pids() == []


@pytest.mark.parametrize('delay', [0.02, 0.08, 0.12, 0.16, 0.2, 0.25])
def test_ctrl_c_while_starting_leaves_nothing(fleet, delay):
    names = [f'node{k}' for k in range(7)]
    for name in names:
        fleet.add(name, FOREVER)
    program = Program(5.0, *names)
    time.sleep(delay)
    program.popen.send_signal(signal.SIGINT)
    assert program.rest()[0] in (130, -signal.SIGINT, 1)  # 1, -2: before the program's own `try`
    until(lambda: not fleet.pids(), 1.0)


def test_a_killed_launcher_takes_its_processes_along(fleet):
    fleet.add('polite', FOREVER)
    program = Program(5.0, 'polite')
    program.read_until('started', 'polite up')
    program.popen.kill()
    program.rest()
    until(lambda: not fleet.pids(), 1.0)


def test_a_killed_launcher_takes_also_along_who_ignores_sigint(fleet):
    fleet.add('deaf', IGNORANT)
    program = Program(0.1, 'deaf')
    program.read_until('started', 'deaf up')
    program.popen.kill()
    killed = time.monotonic()
    until(lambda: not fleet.pids(), 5.0)
    assert 0.4 < time.monotonic() - killed < 3.0  # 0.1 s and the 0.5 s after SIGTERM
    program.rest()


def test_ctrl_c_is_heard_even_where_a_shell_has_it_ignored(fleet):
    # A shell without job control starts background jobs with SIGINT ignored; heirs inherit it.
    fleet.add('node', FOREVER)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with fleet.launcher(grace=5.0) as launcher:
            fleet.await_line('node', 'up')
            started = time.monotonic()
        assert time.monotonic() - started < 2.0
    finally:
        signal.signal(signal.SIGINT, before)
    assert re.fullmatch(
        r'node (was killed by SIGINT|ended with status 1)', launcher.ended[0].sentence
    )
