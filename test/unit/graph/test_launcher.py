# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The launcher: what it starts, hears and reports, and how it stops what it started."""

import os
from pathlib import Path
from queue import Empty
import signal
import threading
import time
from types import SimpleNamespace

from lta_config.errors import BadInput
from lta_graph.child_process import ChildProcess
from lta_graph.launch_plan import LaunchPlan, LaunchProcess
from lta_graph.launcher import Launcher, STOP_GRACE, STOP_POLL, TERM_GRACE
import pytest
from waiting import PATIENCE, wait_until

from .tiny_processes import DEAF, FOREVER, IGNORANT, POLITE, run_to_end
from .tiny_processes import fleet as fleet


def test_a_killed_process_is_named(fleet):
    fleet.add('estimator', FOREVER)
    fleet.add('controller', FOREVER)
    with fleet.launcher() as launcher:
        fleet.await_line('estimator', 'up')
        fleet.await_line('controller', 'up')
        assert sorted(launcher.running) == ['controller', 'estimator']
        assert launcher.poll() == []
        (victim,) = [pid for pid in fleet.pids() if b'estimator' in _cmdline(pid)]
        os.kill(victim, signal.SIGKILL)
        (ended,) = launcher.wait(PATIENCE)
        assert ended.sentence == 'estimator was killed by SIGKILL'
        assert (ended.status, ended.success, ended.stopped) == (-9, False, False)
        assert launcher.outcome is ended
        assert launcher.running == ['controller']


def _cmdline(pid: int) -> bytes:
    return Path(f'/proc/{pid}/cmdline').read_bytes()


def test_the_last_twenty_lines_of_each_stream_survive_a_crash(fleet):
    fleet.add(
        'navigator',
        'import sys\nfor k in range(50): print("out", k)\n'
        'for k in range(30): print("err", k, file=sys.stderr)\n'
        'sys.stderr.write("no newline \\u2603")\nsys.exit(7)\n',
    )
    with fleet.launcher() as launcher:
        run_to_end(launcher)
    ended = launcher.outcome
    assert ended.sentence == 'navigator ended with status 7'
    assert ended.stdout == tuple(f'out {k}' for k in range(30, 50))
    assert ended.stderr == (*(f'err {k}' for k in range(11, 30)), 'no newline \N{SNOWMAN}')
    assert ended.lines == ended.stderr
    assert len(fleet.lines) == 81


@pytest.mark.parametrize(
    ('status', 'planned', 'success', 'sentence'),
    [
        (0, True, True, 'simulator ended'),
        (0, False, False, 'simulator ended'),
        (1, True, False, 'simulator ended with status 1'),
        (2, False, False, 'simulator ended with status 2'),
    ],
)
def test_only_status_0_of_a_planned_end_is_success(fleet, status, planned, success, sentence):
    fleet.add('simulator', f'raise SystemExit({status})', planned=planned)
    fleet.add('recorder', POLITE)
    with fleet.launcher() as launcher:
        run_to_end(launcher)
        fleet.await_line('recorder', 'up')
        assert (launcher.outcome.success, launcher.outcome.sentence) == (success, sentence)
    # The recorder was asked to end: that does not change the outcome.
    assert (launcher.outcome.name, launcher.outcome.success) == ('simulator', success)
    assert [(end.name, end.status, end.stopped) for end in launcher.ended] == [
        ('simulator', status, False),
        ('recorder', 0, True),
    ]


def test_without_a_process_that_ends_nothing_the_run_goes_on(fleet):
    fleet.add('viewer', 'raise SystemExit(2)', on_exit_shutdown=False)
    fleet.add('simulator', FOREVER)
    with fleet.launcher() as launcher:
        (ended,) = launcher.wait(PATIENCE)
        assert (ended.name, ended.status, ended.stopped) == ('viewer', 2, False)
        assert launcher.outcome is None
        fleet.await_line('simulator', 'up')
        (victim,) = [pid for pid in fleet.pids() if b'simulator' in _cmdline(pid)]
        os.kill(victim, signal.SIGKILL)
        run_to_end(launcher)
        assert launcher.outcome.name == 'simulator'


def test_a_run_of_processes_that_end_nothing_ends_with_the_last(fleet):
    fleet.add('first', '', on_exit_shutdown=False)
    fleet.add('last', FOREVER, on_exit_shutdown=False)
    with fleet.launcher() as launcher:
        (ended,) = launcher.wait(PATIENCE)
        assert (ended.name, launcher.outcome) == ('first', None)
        fleet.await_line('last', 'up')
        (victim,) = fleet.pids()
        os.kill(victim, signal.SIGKILL)
        run_to_end(launcher)
        assert (launcher.outcome.name, launcher.outcome.success) == ('last', False)


def test_a_flood_of_output_neither_blocks_nor_hides_a_death(fleet, tmp_path):
    flooded = tmp_path / 'flooded'
    fleet.add(
        'flood', 'import os\nblock = b"x" * 79 + b"\\n"\nwhile True: os.write(1, 500 * block)'
    )
    fleet.add('endless', 'import os\nwhile True: os.write(2, b"x" * 40000)')  # never a line's end
    fleet.add(
        'mortal',
        'import os, time\n'
        f'while not os.path.exists({str(flooded)!r}): time.sleep(0.01)\n'
        'raise SystemExit(4)',
    )
    count = {'flood': 0, 'endless': 0}

    def add(name: str, line: str) -> None:
        count[name] += len(line)
        if min(count.values()) > 1_000_000:
            flooded.touch()

    with Launcher(LaunchPlan(tuple(fleet.processes)), add) as launcher:
        run_to_end(launcher)
        assert launcher.outcome.sentence == 'mortal ended with status 4'


def test_a_process_gets_its_arguments_and_environment(fleet):
    fleet.add(
        'show',
        'import os, sys\nprint(sys.argv[1:], os.environ["PYTHONUNBUFFERED"],\n'
        '      os.environ["OPENBLAS_NUM_THREADS"], os.getsid(0) == os.getpid(),\n'
        '      os.getpgid(0) == os.getpid(), sys.stdin.read() == "")',
        args=('--word', 'a b'),
        parameters={'text': 'a b'},
        namespace='/r1',
    )
    with fleet.launcher() as launcher:
        run_to_end(launcher)
    ros = "'--ros-args', '-r', '__node:=show', '-r', '__ns:=/r1', '-p', 'text:=\"a b\"'"
    shown = f"['--word', 'a b', {ros}] 1 1 True True True"
    assert fleet.lines == [('show', shown)]


def test_what_cannot_be_executed_starts_nothing(fleet):
    fleet.add('good', FOREVER)
    fleet.add('bad', '')
    (fleet.folder / 'bad').write_text('#!/no/such/interpreter\n')
    with pytest.raises(
        BadInput, match=r'^The program bad cannot be started \(.*/bad: No such file'
    ):
        fleet.launcher().start()
    assert fleet.pids() == []
    (fleet.folder / 'bad').chmod(0o644)
    with pytest.raises(BadInput, match=r"^Unknown executable of fleet 'bad'; known: good\.$"):
        fleet.launcher().start()
    fleet.processes = [LaunchProcess('nowhere', 'x', 'x')]
    with pytest.raises(
        BadInput,
        match=r"^The package 'nowhere' is not installed here; install it \(of ROS 2 Jazzy: ",
    ):
        fleet.launcher().start()


class Clock:
    """Stands in for the launcher's clock: time passes only by sleeping in it."""

    def __init__(self):
        self.now = 0.0

    def monotonic(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds
        time.sleep(0.0)  # somebody else's turn


def test_each_process_has_its_own_time_to_end(fleet):
    fleet.add('viewer', IGNORANT, sigterm_timeout=0.05)
    fleet.add('recorder', POLITE)
    with fleet.launcher() as launcher:
        for name in ('viewer', 'recorder'):
            fleet.await_line(name, 'up')
    assert [(end.name, end.status) for end in launcher.ended] == [
        ('viewer', -signal.SIGTERM),
        ('recorder', 0),
    ]
    assert ('recorder', 'closed') in fleet.lines


def test_stop_gives_time_to_close(fleet):
    fleet.add('recorder', POLITE)
    with fleet.launcher() as launcher:
        fleet.await_line('recorder', 'up')
    assert fleet.lines == [('recorder', 'up'), ('recorder', 'closing'), ('recorder', 'closed')]
    assert launcher.outcome is None
    assert [(end.status, end.stopped) for end in launcher.ended] == [(0, True)]


def test_signals_come_in_order_after_their_graces(fleet, monkeypatch):
    clock, sent, send = Clock(), [], ChildProcess.send_signal
    monkeypatch.setattr('lta_graph.launcher.time', clock)

    def signalled(child, number):
        sent.append((number, clock.now))
        send(child, number)
        if number is not signal.SIGKILL:
            fleet.await_line('deaf', number.name)

    monkeypatch.setattr(ChildProcess, 'send_signal', signalled)
    fleet.add('deaf', DEAF)
    launcher = fleet.launcher(grace=STOP_GRACE)
    launcher.start()
    fleet.await_line('deaf', 'up')
    launcher.stop()
    numbers, times = zip(*sent[:3], strict=True)
    assert numbers == (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
    assert times == pytest.approx((0.0, STOP_GRACE, STOP_GRACE + TERM_GRACE), abs=2 * STOP_POLL)
    assert [line for _, line in fleet.lines] == ['up', 'SIGINT', 'SIGTERM']
    (ended,) = launcher.ended
    assert (ended.sentence, ended.stopped) == ('deaf was killed by SIGKILL', True)
    launcher.stop()  # again is nothing


def test_children_of_a_process_end_with_it(fleet):
    fork = 'import os, time\nif os.fork():\n    time.sleep(600)\n'
    fleet.add('parent', fork + IGNORANT)
    with fleet.launcher():
        fleet.await_line('parent', 'up')
        assert len(fleet.pids()) == 2
    fleet.await_pids(0)  # the launcher waits for grandchildren as well, but not for ever


def test_an_error_in_the_callback_reaches_the_caller_and_stops_all(fleet):
    fleet.add('talker', FOREVER)

    def fail(name: str, line: str) -> None:
        raise OSError('the terminal is gone')

    def run() -> None:
        with Launcher(LaunchPlan(tuple(fleet.processes)), fail) as launcher:
            wait_until(lambda: launcher.wait(1.0), 'the error of the callback')

    with pytest.raises(OSError, match='the terminal is gone'):
        run()
    assert fleet.pids() == []


def test_a_hanging_callback_does_not_hold_the_stop_up(fleet):
    fleet.add('talker', FOREVER)
    called, hang, over = threading.Event(), threading.Event(), threading.Event()

    def hanging(name: str, line: str) -> None:
        called.set()
        hang.wait(PATIENCE)
        over.set()

    launcher = Launcher(LaunchPlan(tuple(fleet.processes)), hanging)
    launcher.start()
    assert called.wait(PATIENCE)
    launcher.stop()
    assert not over.is_set()
    assert fleet.pids() == []
    hang.set()


def test_ctrl_c_tears_no_queue_apart():
    """Raised inside `Queue.get`, an exception could leave its lock taken: then nothing ends."""
    whole = []

    def get(timeout):
        os.kill(os.getpid(), signal.SIGINT)
        whole.append(timeout)  # Python acts on a signal before the next statement
        raise Empty

    launcher = Launcher(LaunchPlan(()), lambda name, line: None)
    launcher._watch = SimpleNamespace(events=SimpleNamespace(get=get), fault=None)
    # A shell that put the tests into the background has Ctrl-C ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            launcher.wait(0.25)
    finally:
        signal.signal(signal.SIGINT, before)
    assert whole == [0.25]
