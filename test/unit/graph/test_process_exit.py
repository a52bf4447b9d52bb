# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A process ends at once, with its words said and its last duties done."""

import subprocess
import sys

import pytest
from waiting import PATIENCE

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
