# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A shell asks how a line goes on, by the protocol of Typer."""

import shlex
import subprocess
import sys

import pytest


@pytest.fixture
def ask(monkeypatch, capsys):
    """Return a function that completes a line in a shell and returns the possible last words."""
    from lta_cli.app import complete

    def run(line: str, shell: str = 'bash') -> list[str]:
        words = shlex.split(line) + ([''] if line.endswith(' ') else [])
        monkeypatch.setenv('_LTA_COMPLETE', f'complete_{shell}')
        monkeypatch.setenv('COMP_WORDS', line if shell == 'bash' else '')
        monkeypatch.setenv('COMP_CWORD', f'{len(words) - 1}')
        monkeypatch.setenv('_TYPER_COMPLETE_ARGS', line)
        monkeypatch.setenv('_TYPER_COMPLETE_FISH_ACTION', 'get-args')
        with pytest.raises(SystemExit) as left:
            complete()
        assert left.value.code == 0
        return [word for word in capsys.readouterr().out.splitlines() if word]

    return run


@pytest.mark.parametrize(
    ('line', 'expected'),
    [
        ('lta sim', ['simulate']),
        ('lta eff', ['effects']),
        ('lta energy b', ['budget', 'breakeven']),
        ('lta tests between --ro', ['--room']),
        ('lta fly --no-p', ['--no-page']),
        ('lta fly --time ', ['lockstep', 'realtime']),
        ('lta fly --vehicle gt', ['gtmab']),
        ('lta simulate --scenario lamp_', ['lamp_room']),
        ('lta vehicle show rg', ['rgblimp']),
        ('lta discover --train A B --conf', ['--confirm']),
        # Left to the shell, which knows the files
        ('lta fly --vehicle ./absent', []),
    ],
)
def test_a_line_goes_on(line, expected, ask):
    assert ask(line) == expected


def test_zsh_and_fish_show_what_a_command_does(ask):
    assert ask('lta light li', 'fish')[0].startswith('link\tCompute the link budget')
    assert '"link":"Compute the link budget' in ask('lta light li', 'zsh')[0]


@pytest.mark.parametrize('shell', ['bash', 'zsh', 'fish'])
def test_a_shell_gets_the_script_that_asks(shell):
    program = 'from lta_cli.command import main; main()'
    done = subprocess.run(
        [sys.executable, '-c', program],
        env={'_LTA_COMPLETE': f'source_{shell}', 'PYTHONPATH': ':'.join(sys.path)},
        capture_output=True,
        text=True,
    )
    assert f'_LTA_COMPLETE=complete_{shell}' in done.stdout, done.stderr
