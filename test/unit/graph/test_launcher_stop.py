# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A stop of real, tiny processes: signals come in order, and nothing is left."""

import signal
import threading
import time

from lta_graph.child_process import ChildProcess
from lta_graph.launch_plan import LaunchPlan
from lta_graph.launcher import Launcher, STOP_GRACE, STOP_POLL, TERM_GRACE
import pytest
from waiting import PATIENCE, wait_until

from .tiny_processes import DEAF, FOREVER, IGNORANT, POLITE
from .tiny_processes import fleet as fleet


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
