# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Supervision of real, tiny processes: they get what they need, and every end is named."""

import os
from pathlib import Path
import signal

from lta_config.errors import BadInput
from lta_graph.launch_plan import LaunchPlan, LaunchProcess
from lta_graph.launcher import Launcher
import pytest
from waiting import PATIENCE

from .tiny_processes import fleet as fleet
from .tiny_processes import FOREVER, POLITE, run_to_end


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
