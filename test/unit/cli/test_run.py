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


@pytest.mark.parametrize(
    ('words', 'sentence'),
    [
        (('/no/own.py',), 'There is no Python file /no/own.py; check the path.'),
        (
            ('lta_vlc',),
            "The executable of 'lta_vlc' is missing; write lta run lta_vlc NAME.",
        ),
    ],
)
def test_what_cannot_be_run_is_one_sentence(call, executed, words, sentence):
    status, printed = call('run', *words)
    assert (status, printed.err.strip()) == (2, sentence)
    assert executed == []
