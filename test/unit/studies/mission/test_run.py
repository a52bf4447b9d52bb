"""Lives of a mission side by side: Ctrl-C ends them all at once, and the headline counts."""

import signal
import sys
from threading import active_count, main_thread
import time
from types import SimpleNamespace

from lta_studies.mission import run as running
from lta_studies.mission.report import format_headline
from lta_studies.mission.run import MissionResult
import pytest
from waiting import EVERY, PATIENCE, wait_until


class Long:
    """A life longer than anybody waits, stretch by stretch."""

    ended = False

    def run(self, told):
        for _ in range(round(PATIENCE / EVERY)):
            told(1.0)
            time.sleep(EVERY)
        Long.ended = True


@pytest.fixture
def interrupted():
    """Return a function that raises KeyboardInterrupt where this thread waits, as Ctrl-C does."""
    heard = []

    def stop(*_):
        raise KeyboardInterrupt

    def hear(gone):
        if not heard:
            heard.append(gone)
            wait_until(waits, 'the wait for the lives')
            signal.pthread_kill(main_thread().ident, signal.SIGALRM)

    before = signal.signal(signal.SIGALRM, stop)
    yield hear
    signal.signal(signal.SIGALRM, before)
    assert heard


def waits():
    """Tell whether the first thread waits for the others to come to something."""
    frame = sys._current_frames()[main_thread().ident]
    while frame is not None and frame.f_code.co_name != 'as_completed':
        frame = frame.f_back
    return frame is not None


def test_ctrl_c_ends_the_lives_that_are_being_lived(monkeypatch, tmp_path, interrupted):
    monkeypatch.setattr(running, 'claim_results_folder', lambda *_: None)
    monkeypatch.setattr(running, 'compile_flight', lambda *_: None)
    monkeypatch.setattr(running, 'build_simulation', lambda *_: (Long(), None))
    mission = SimpleNamespace(round=('aisle',))
    order = SimpleNamespace(
        mission=mission, day=None, scenes=None, days=1, seeds=(1, 2), schedules=('by light',)
    )
    threads = active_count()
    with pytest.raises(KeyboardInterrupt):
        running.run_missions(order, tmp_path, interrupted)
    assert not Long.ended
    assert active_count() == threads
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(('failures', 'end'), [(0, ''), (1, '; 1 failure in 40 flights')])
def test_the_headline_counts_failures_of_the_schedule_by_light(failures, end):
    own = SimpleNamespace(flown=7200.0, flights=40, failure_count=failures)
    fixed = SimpleNamespace(flown=3600.0, flights=30, failure_count=9)
    results = [
        MissionResult('by light', 1, None, own),
        MissionResult('duty cycle', 1, None, fixed),
    ]
    request = SimpleNamespace(mission=SimpleNamespace(name='greenhouse'), days=1)
    assert format_headline(request, results) == (
        'In the mission greenhouse the drone flies 120 minutes a day, '
        f'2.00 times as many as with a fixed duty cycle{end}.'
    )
