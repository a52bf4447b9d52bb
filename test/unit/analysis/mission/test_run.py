"""Lives of a mission side by side: Ctrl-C ends them all at once."""

import signal
from threading import active_count
import time
from types import SimpleNamespace

from lta_analysis.mission import run as running
import pytest


class Long:
    """A life of twenty seconds, stretch by stretch."""

    def live(self, told):
        for _ in range(2000):
            time.sleep(0.01)
            told(1.0)


@pytest.fixture
def interrupted():
    """Raise KeyboardInterrupt after half a second, as the command line does at Ctrl-C."""

    def stop(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, 0.5)
    yield
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    signal.signal(signal.SIGALRM, before)


def test_ctrl_c_ends_the_lives_that_are_being_lived(monkeypatch, tmp_path, interrupted):
    monkeypatch.setattr(running, 'begin', lambda *_: None)
    monkeypatch.setattr(running, 'compiled', lambda *_: None)
    monkeypatch.setattr(running, 'life_of', lambda *_: (Long(), None))
    mission = SimpleNamespace(round=('aisle',))
    order = SimpleNamespace(
        mission=mission, day=None, scenes=None, days=1, seeds=(1, 2), schedules=('by light',)
    )
    threads, begun, heard = active_count(), time.monotonic(), []
    with pytest.raises(KeyboardInterrupt):
        running.run(order, tmp_path, heard.append)
    assert heard
    assert time.monotonic() - begun < 10.0
    assert active_count() == threads
    assert not list(tmp_path.iterdir())
