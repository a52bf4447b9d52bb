# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The doctor: whether processes of this machine talk."""

import os
import subprocess
import sys

from lta_cli.doctor import dds
import pytest
from waiting import PATIENCE


@pytest.fixture(autouse=True)
def _source_path(monkeypatch):
    monkeypatch.setenv('PYTHONPATH', os.pathsep.join(path for path in sys.path if path))


def test_two_processes_talk(monkeypatch):
    for limit in ('DEADLINE', 'SLOW_EXCHANGE'):  # how fast it is, is the machine's
        monkeypatch.setattr(dds, limit, PATIENCE)
    check = dds.check_message_exchange()
    assert check.state == 'ok', check.found
    assert check.found.startswith('two processes discovered each other in ')


def test_nobody_answers():
    command = [sys.executable, '-m', 'lta_graph.ros.echo', 'ask', '--seconds', '0.5']
    result = subprocess.run(command, capture_output=True, timeout=PATIENCE)
    assert (result.returncode, result.stdout) == (1, b'')


def test_a_process_that_cannot_start_says_why(monkeypatch):
    monkeypatch.setenv('RMW_IMPLEMENTATION', 'rmw_of_another_world')
    check = dds.check_message_exchange()
    assert check.state == 'fail'
    assert check.found
    assert check.remedy
