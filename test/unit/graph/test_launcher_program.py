# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Processes from outside: what Ctrl-C, signals and their own arguments do to them."""

import os
import re
import signal
import subprocess
import sys
import threading

from lta_graph.child_process import spawn_process
from lta_graph.launch_plan import LaunchProcess
import pytest
from waiting import PATIENCE

from .tiny_processes import DEAF, FOREVER, POLITE
from .tiny_processes import fleet as fleet

LAUNCH = """
import os, signal, sys
from lta_graph.launch_plan import LaunchPlan, LaunchProcess
from lta_graph import launcher

grace, launcher.TERM_GRACE, last = map(float, sys.argv[1:4])
plan = LaunchPlan(tuple(LaunchProcess('fleet', n, n) for n in sys.argv[4:]))
def say(*words):  # one write a line: two threads speak here
    os.write(1, (' '.join(words) + '\\n').encode())
spawned, spawn = [], launcher.spawn_process
def interrupted(*words):
    spawned.append(spawn(*words))
    say('spawned')
    if len(spawned) == last:
        os.kill(os.getpid(), signal.SIGINT)
    return spawned[-1]
launcher.spawn_process = interrupted
try:
    with launcher.Launcher(plan, say, grace=grace) as it:
        say('started')
        while it.outcome is None:
            it.wait(0.2)
except KeyboardInterrupt:
    say('interrupted')
    sys.exit(130)
"""


class Program:
    """A launcher in a process of its own, to which signals can be sent."""

    def __init__(
        self,
        *names: str,
        grace: float = PATIENCE,
        term_grace: float = PATIENCE,
        last: int = 0,
        **more: str,
    ) -> None:
        path = ':'.join(item for item in sys.path if item)
        self.popen = subprocess.Popen(
            [sys.executable, '-c', LAUNCH, *map(str, (grace, term_grace, last)), *names],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, 'PYTHONPATH': path, **more},
            # A shell's background job ignores Ctrl-C, and so does what it starts.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )
        self._watchdog = threading.Timer(PATIENCE, self.popen.kill)  # so that no test can hang
        self._watchdog.start()

    def read_until(self, *wanted: str) -> None:
        missing = set(wanted)
        while missing:
            line = self.popen.stdout.readline()
            assert line, f'it ended without {missing}'
            missing.discard(line.strip())

    def rest(self) -> tuple[int, list[str]]:
        out, _ = self.popen.communicate(timeout=PATIENCE)
        self._watchdog.cancel()
        return self.popen.returncode, out.splitlines()


def test_ctrl_c_ends_everything_in_order(fleet):
    fleet.add('recorder', POLITE)
    fleet.add('simulator', FOREVER)
    program = Program('recorder', 'simulator')
    program.read_until('started', 'recorder up', 'simulator up')
    program.popen.send_signal(signal.SIGINT)
    status, lines = program.rest()
    assert status == 130
    assert [line for line in lines if 'clos' in line] == ['recorder closing', 'recorder closed']
    assert lines[-1] == 'interrupted'
    assert fleet.pids() == []


def test_each_further_ctrl_c_goes_on_to_the_next_signal(fleet):
    """Either grace would be longer than the test waits for a word of the process."""
    fleet.add('deaf', DEAF)
    program = Program('deaf', grace=10 * PATIENCE, term_grace=10 * PATIENCE)
    program.read_until('started', 'deaf up')
    program.popen.send_signal(signal.SIGINT)
    program.read_until('deaf SIGINT')
    program.popen.send_signal(signal.SIGINT)
    program.read_until('deaf SIGTERM')
    program.popen.send_signal(signal.SIGINT)
    status, lines = program.rest()
    assert (status, lines[-1]) == (130, 'interrupted')
    assert fleet.pids() == []


@pytest.mark.parametrize('last', [1, 4, 7])
def test_ctrl_c_while_starting_starts_no_more_and_leaves_nothing(fleet, last):
    names = [f'node{k}' for k in range(7)]
    for name in names:
        fleet.add(name, FOREVER)
    # An interpreter that still starts may print a KeyboardInterrupt and go on: SIGTERM ends it.
    status, lines = Program(*names, last=last, grace=1.0).rest()
    assert (status, lines.count('spawned'), lines[-1]) == (130, last, 'interrupted')
    assert 'started' not in lines
    assert fleet.pids() == []


def test_a_killed_launcher_takes_its_processes_along(fleet):
    fleet.add('polite', FOREVER)
    program = Program('polite')
    program.read_until('started', 'polite up')
    program.popen.kill()
    program.rest()
    fleet.await_pids(0)


def test_ctrl_c_is_heard_even_where_a_shell_has_it_ignored(fleet):
    # A shell without job control starts background jobs with SIGINT ignored; heirs inherit it.
    fleet.add('node', FOREVER)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with fleet.launcher() as launcher:
            fleet.await_line('node', 'up')
    finally:
        signal.signal(signal.SIGINT, before)
    assert re.fullmatch(
        r'node (was killed by SIGINT|ended with status 1)', launcher.ended[0].sentence
    )


@pytest.mark.parametrize(('package', 'blocked'), [('lta_control', True), ('their_nodes', False)])
def test_only_our_nodes_start_with_sigint_blocked(package, blocked):
    """Others never unblock it, and would have to be killed."""
    process = LaunchProcess(package, 'node', 'node')
    child = spawn_process(process, 'node', ['grep', 'SigBlk', '/proc/self/status'], os.environ)
    out, _ = child.popen.communicate()
    mask = int(out.split()[1], 16)
    assert bool(mask & 1 << (signal.SIGINT - 1)) == blocked


CODE = """
import atexit, sys, time
from lta_graph.terminal_streams import exit_process

class Slow:
    def __del__(self):
        time.sleep({sleep})

slow = Slow()
atexit.register(sys.stdout.write, ', tidied')
sys.stdout.write('worked')
exit_process(3)
"""


@pytest.fixture
def run(tmp_path):
    """Return a function that runs the code, by another program where one is named."""
    path = tmp_path / 'code.py'

    def start(*by, sleep=0):
        path.write_text(CODE.format(sleep=sleep))
        return subprocess.run(
            [sys.executable, *by, path], capture_output=True, text=True, timeout=PATIENCE
        )

    return start


def test_nothing_is_taken_apart(run):
    left = run(sleep=10 * PATIENCE)
    assert (left.returncode, left.stdout, left.stderr) == (3, 'worked, tidied', '')


def test_a_profiler_comes_to_its_result(run, tmp_path):
    left = run('-m', 'cProfile', '-o', tmp_path / 'profile')
    assert left.stdout == 'worked, tidied'
    assert (tmp_path / 'profile').stat().st_size > 0


command_line = pytest.importorskip('lta_graph.ros.command_line', exc_type=ImportError)


@pytest.mark.parametrize(
    ('words', 'names'),
    [
        ([], []),
        (['-p', 'frequency:=175.0'], ['frequency']),
        (['--param', 'prior.distance:=1.0', '-r', '__ns:=/a'], ['prior.distance']),
        (['-p', 'demodulator:window:=x', '-p', 'other:seed:=1'], ['window']),
        (['-p', '/**:window:=x'], ['window']),
        (['-p', "strategy:='a:=b'"], ['strategy']),
    ],
)
def test_the_parameters_given_to_a_node(words, names):
    line = ['program', '--ros-args', *words]
    assert command_line.list_parameter_names(line, 'demodulator') == names
