# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`lta run` starts an executable of a package, or somebody's own Python file."""

import sys

from lta_cli.verbs import run
import pytest


@pytest.fixture
def executed(monkeypatch):
    """Return a list with what was executed."""
    calls = []
    monkeypatch.setattr(run.os, 'execv', lambda path, words: calls.append((str(path), words)))
    return calls


def test_a_python_file_gets_its_arguments(call, executed, tmp_path):
    path = tmp_path / 'own.py'
    path.touch()
    # The call returns here, where the real one replaces the process
    call('run', path, '--ros-args', '-r', '__ns:=/lta1')
    assert executed[0] == (
        sys.executable,
        [sys.executable, str(path), '--ros-args', '-r', '__ns:=/lta1'],
    )
