# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Workers finish every item even if some of them die, and none outlives the command."""

from functools import partial
from multiprocessing import active_children, get_context
import os
from pathlib import Path
import signal
import subprocess
import sys

from lta_config.errors import BadInput
from lta_report.workers import DaskWorkers, ItemFailure, LocalWorkers
import pytest
from waiting import PATIENCE, wait_until
import worker_functions


def run(function, items, size=2):
    with LocalWorkers(function, size) as workers:
        return dict(workers.run(items)), workers.lost


@pytest.fixture
def forking(monkeypatch):
    """Start workers by a fork, which is quick, for tests in which many die."""
    monkeypatch.setattr('lta_report.workers.get_context', lambda _: get_context('fork'))


@pytest.mark.parametrize('size', [1, 2])
def test_an_error_is_a_failure_of_its_item_alone(size):
    assert run(worker_functions.fail_at_odd, range(4), size)[0] == {
        0: 0,
        1: ItemFailure('ArithmeticError: odd'),
        2: 4,
        3: ItemFailure('3 is not even.'),
    }
    assert not active_children()


def test_one_worker_is_this_process():
    ((process, blocked, _),) = run(worker_functions.describe_process, [0], 1)[0].values()
    assert process == os.getpid()
    assert not blocked


def test_a_worker_leaves_ctrl_c_to_its_parent_and_the_cores_to_its_siblings(monkeypatch):
    monkeypatch.delenv('OMP_NUM_THREADS', raising=False)
    ((process, blocked, threads),) = run(worker_functions.describe_process, [0])[0].values()
    assert process != os.getpid()
    assert (blocked, threads) == (True, '1')
    assert 'OMP_NUM_THREADS' not in os.environ
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def test_the_item_of_a_dead_worker_is_repeated_once(tmp_path, forking):
    found, lost = run(partial(worker_functions.die_at, str(tmp_path)), range(6))
    assert lost == 3
    assert found == {k: k**2 for k in (0, 1, 3, 4, 5)} | {
        2: ItemFailure('2 worker processes ended during this computation, the last by SIGKILL.')
    }


def test_workers_that_never_finish_anything_stop_the_run(forking):
    with (
        LocalWorkers(worker_functions.end_at_once, 2) as workers,
        pytest.raises(BadInput, match=r'^6 worker processes in a row .* exit status 7\); check'),
    ):
        list(workers.run(range(100)))
    assert not active_children()


def test_a_result_that_cannot_be_sent_is_a_failure():
    (failure,) = run(worker_functions.return_lambda, [0])[0].values()
    assert failure.reason.startswith('The result cannot be sent: ')


@pytest.mark.parametrize('size', [1, 2])
def test_the_share_of_an_unfinished_item_is_reported(size):
    shares = []
    with LocalWorkers(worker_functions.square_in_halves, size, shares.append) as workers:
        assert list(workers.run([3])) == [(3, 9)]
    assert shares == [0.5]


def test_a_run_that_was_left_does_not_disturb_the_next(tmp_path):
    with LocalWorkers(partial(worker_functions.start_and_wait, str(tmp_path)), 2) as workers:
        running = workers.run([0, 1, 1])
        assert next(running) == (0, 0)
        running.close()
        assert len(active_children()) == 1  # the one that was idle
        assert list(workers.run([0])) == [(0, 0)]


SCRIPT = """
from functools import partial
import sys
sys.path[:0] = sys.argv[2:]
from lta_report.workers import LocalWorkers
import worker_functions
if __name__ == '__main__':
    try:
        with LocalWorkers(partial(worker_functions.start_and_wait, sys.argv[1]), 2) as workers:
            list(workers.run([1, 1]))
    except KeyboardInterrupt:
        sys.exit(130)
"""


@pytest.mark.parametrize('number', [signal.SIGKILL, signal.SIGINT])
def test_no_worker_outlives_the_command(tmp_path, number):
    """Killed alone, or by Ctrl-C to all its processes, while all workers compute for minutes."""
    script = tmp_path / 'script.py'
    script.write_text(SCRIPT)
    command = subprocess.Popen(
        [sys.executable, str(script), str(tmp_path), *sys.path],
        start_new_session=True,
        # A shell's background job ignores Ctrl-C, and so does what it starts
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        wait_until(lambda: len(list(tmp_path.glob('*.pid'))) == 2, 'both workers')
        if number is signal.SIGINT:
            os.killpg(command.pid, number)
        else:
            command.send_signal(number)
        assert command.wait(PATIENCE) == (130 if number is signal.SIGINT else -number)
    finally:
        command.kill()
        command.wait()
    workers = [Path('/proc') / file.stem / 'cmdline' for file in tmp_path.glob('*.pid')]
    wait_until(lambda: not any(file.exists() for file in workers), 'the end of the workers')


def test_a_cluster_works_like_this_machine():
    """A scheduler with two workers in this process; needs the optional dask.distributed."""
    distributed = pytest.importorskip('distributed')
    options = {'processes': False, 'n_workers': 2, 'threads_per_worker': 1}
    with (
        distributed.LocalCluster(**options, dashboard_address=None) as cluster,
        DaskWorkers(worker_functions.fail_at_odd, cluster.scheduler_address) as workers,
    ):
        found = dict(workers.run(range(20)))
    assert found == run(worker_functions.fail_at_odd, range(20), 1)[0]
    assert workers.lost == 0
