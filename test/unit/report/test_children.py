"""Processes that work for a command: one that dies is a sentence, none outlives the command."""

from multiprocessing import active_children
import os
import signal
import time

from lta_config.errors import BadInput
from lta_report.worker_pool import ALONE, run_in_workers, WorkerPool
from lta_studies.platforms import run as platforms
from lta_studies.reproduce import run as reproduce
from lta_studies.tune import workers
import pytest
from waiting import PATIENCE

DIED = r'^A worker process died, perhaps because memory ran out; try again with --workers 1\.'
GOES_ON = r' Finished work is stored; run the same command again to continue\.$'


def test_what_is_done_comes_back_whoever_does_it():
    for jobs in (1, 2):
        assert sorted(run_in_workers(divmod, [(7, 2), (9, 4)], jobs, '--jobs')) == [(2, 1), (3, 1)]
    assert not active_children()


@pytest.fixture
def dead(monkeypatch):
    """Let every flight, study and examination end the process that it runs in."""
    monkeypatch.setattr(platforms, 'fly_job', os._exit)
    monkeypatch.setattr(workers, '_evaluate_with_index', _ends)
    monkeypatch.setattr(reproduce, '_study_with_name', _ends)


def _ends(*_):
    os._exit(3)


def test_a_worker_that_dies_is_told_in_a_sentence(dead, tmp_path):
    with pytest.raises(BadInput, match=DIED + '$'):
        list(platforms.fly_all([3, 3], 2))
    order = reproduce.ReproductionRequest(('cells',), True, tmp_path, 2)
    with pytest.raises(BadInput, match=DIED + GOES_ON):
        list(reproduce.study_all(order, reproduce.select_rows(['cells'])))
    with workers.create_workers(2) as processes:
        for _ in range(2):  # whoever asks once more hears the same
            with pytest.raises(BadInput, match=DIED + GOES_ON):
                workers.evaluate_jobs(['any'], processes)
    assert not active_children()


def test_a_child_leaves_ctrl_c_to_its_parent_and_the_processors_to_its_siblings():
    with WorkerPool(2, '--jobs') as children:
        assert list(children.map_unordered(signal.getsignal, [(signal.SIGINT,)])) == [
            signal.SIG_IGN
        ]
        found = children.map_unordered(os.getenv, [(name,) for name in ALONE])
        assert list(found) == ['1'] * len(ALONE)


def test_whoever_leaves_early_ends_what_is_being_worked_on():
    def leave_early():
        with WorkerPool(2, '--jobs') as children:
            next(children.map_unordered(time.sleep, [(0.0,), (PATIENCE,), (PATIENCE,)]))
            working.extend(active_children())
            raise KeyboardInterrupt

    working = []
    with pytest.raises(KeyboardInterrupt):
        leave_early()
    assert {child.exitcode for child in working} == {-signal.SIGTERM}
    assert not active_children()


def test_after_a_search_that_was_stopped_the_same_processes_go_on():
    with WorkerPool(2, '--jobs') as children:
        next(children.map_unordered(time.sleep, [(0.0,), (0.2,), (0.2,), (0.2,)]))
        assert list(children.map_unordered(abs, [(-1,)])) == [1]
