"""A stop of real, tiny processes: signals come in order, and nothing is left."""

from pathlib import Path
import signal
import threading
import time

from lta_graph.launch_file import LaunchPlan
from lta_graph.launcher import Launcher
import pytest

from .tiny_processes import DEAF, FOREVER, IGNORANT, POLITE, until
from .tiny_processes import fleet as fleet

# Real processes against the wall clock: nothing else may run beside them.
pytestmark = pytest.mark.integration


def test_a_spare_process_that_hangs_does_not_hold_up_the_end(fleet):
    fleet.add('viewer', DEAF)
    fleet.add('recorder', POLITE)
    with fleet.launcher(grace=60.0, spare=('viewer',)) as launcher:
        for name in ('viewer', 'recorder'):
            fleet.await_line(name, 'up')
        before = time.monotonic()
    assert time.monotonic() - before < 30.0
    assert {end.name: end.status for end in launcher.ended} == {
        'recorder': 0,
        'viewer': -signal.SIGKILL,
    }
    assert ('recorder', 'closed') in fleet.lines


def test_stop_gives_time_to_close(fleet):
    fleet.add('recorder', POLITE)
    with fleet.launcher() as launcher:
        fleet.await_line('recorder', 'up')
        before = time.monotonic()
    assert 0.3 <= time.monotonic() - before < 2.0
    assert fleet.lines == [('recorder', 'up'), ('recorder', 'closing'), ('recorder', 'closed')]
    assert launcher.outcome is None
    assert [(end.status, end.stopped) for end in launcher.ended] == [(0, True)]


def test_signals_come_in_order_after_their_graces(fleet, monkeypatch):
    monkeypatch.setattr('lta_graph.launcher.TERM_GRACE', 0.2)
    fleet.add('deaf', DEAF)
    launcher = fleet.launcher(grace=0.4)
    launcher.start()
    fleet.await_line('deaf', 'up')
    before = time.monotonic()
    launcher.stop()
    assert 0.6 <= time.monotonic() - before < 1.5
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
    assert fleet.pids() == []


def test_an_error_in_the_callback_reaches_the_caller_and_stops_all(fleet):
    fleet.add('talker', FOREVER)

    def fail(name: str, line: str) -> None:
        raise OSError('the terminal is gone')

    def run() -> None:
        with Launcher(LaunchPlan(tuple(fleet.processes)), fail) as launcher:
            for _ in range(100):
                launcher.wait(0.05)

    with pytest.raises(OSError, match='the terminal is gone'):
        run()
    assert fleet.pids() == []


def test_a_hanging_callback_does_not_hold_the_stop_up(fleet):
    fleet.add('talker', FOREVER)
    hang = threading.Event()
    launcher = Launcher(LaunchPlan(tuple(fleet.processes)), lambda *_: hang.wait() and None)
    launcher.start()
    until(lambda: len(fleet.pids()) == 1)
    before = time.monotonic()
    launcher.stop()
    assert time.monotonic() - before < 3.0
    assert fleet.pids() == []
    hang.set()


def test_nothing_of_the_guard_is_left_after_a_stop(fleet):
    fleet.add('node', FOREVER)
    with fleet.launcher() as launcher:
        guard = launcher._guard._popen.pid
        assert Path(f'/proc/{guard}').exists()
    assert not Path(f'/proc/{guard}').exists()
