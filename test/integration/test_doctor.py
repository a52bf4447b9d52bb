"""`lta doctor` proves DDS with two real processes, and gives up in time when nobody answers."""

from contextlib import suppress
import os
from pathlib import Path
import shutil
import subprocess
import sys
import time

from lta_analysis.doctor import dds
from lta_analysis.doctor.shared_memory import FOLDER, LOCK, stale, tool
import pytest

from .peer import PATIENCE

pytestmark = pytest.mark.beside


@pytest.fixture(autouse=True)
def _source_path(monkeypatch):
    monkeypatch.setenv('PYTHONPATH', os.pathsep.join(path for path in sys.path if path))


def test_two_processes_talk():
    began = time.monotonic()
    check = dds.conversation()
    assert check.state == 'ok', check.found
    assert check.found.startswith('two processes found each other in ')
    assert time.monotonic() - began < dds.DEADLINE


def test_nobody_answers():
    command = [sys.executable, '-m', 'lta_graph.ros.echo', 'ask', '--seconds', '0.5']
    result = subprocess.run(command, capture_output=True, timeout=dds.DEADLINE)
    assert (result.returncode, result.stdout) == (1, b'')


def locks_of(process):
    """Return the lock files of Fast DDS that a process has open."""
    files = set()
    for link in Path(f'/proc/{process.pid}/fd').iterdir():
        with suppress(FileNotFoundError):  # closed meanwhile
            files.add(link.readlink())
    return {file for file in files if LOCK.fullmatch(file.name)}


@pytest.mark.skipif(shutil.which(tool()) is None, reason='needs the tool of Fast DDS')
def test_what_a_killed_process_leaves_is_stale_and_the_command_removes_no_more():
    command = [sys.executable, '-m', 'lta_graph.ros.echo', 'answer', '--seconds', '60']
    killed, alive = processes = [subprocess.Popen(command) for _ in range(2)]
    try:
        deadline = time.monotonic() + PATIENCE
        while not all(len(locks_of(one)) > 2 for one in processes):  # itself, and two ports
            assert time.monotonic() < deadline
            time.sleep(0.02)
        dead, own = locks_of(killed), locks_of(alive)
        killed.kill()
        killed.wait()
        found = set(stale(FOLDER))
        assert {file for file in dead - own if file.exists()} <= found  # the other may clean up
        assert not own & found
        subprocess.run([tool(), 'shm', 'clean'], check=True, capture_output=True)
        assert not [file for file in dead - own if file.exists()]
        assert all(file.exists() for file in own)
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_a_process_that_cannot_start_says_why(monkeypatch):
    monkeypatch.setenv('RMW_IMPLEMENTATION', 'rmw_of_another_world')
    check = dds.conversation()
    assert check.state == 'fail'
    assert check.found
    assert check.remedy
