# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The command line around the verbs."""

import subprocess
import sys

from lta_cli import app
import pytest
from typer.main import get_command


@pytest.mark.parametrize('words', [(), ('bag',)])
def test_without_a_verb_it_helps(call, words):
    status, said = call(*words)
    assert (status, said.err) == (0, '')
    assert 'COMMAND [ARGS]...' in said.out


def test_it_tells_its_version(call, monkeypatch):
    monkeypatch.setattr(app, 'VERSION', '1.2.3')
    status, said = call('--version')
    assert (status, said.out) == (0, 'lta 1.2.3\n')


def test_only_the_verb_that_is_asked_for_is_loaded():
    """All of them take a second, and `lta bag info` a tenth of it."""
    code = (
        'import sys; from lta_cli.app import build_app; build_app(["bag", "info"]);'
        'print(*[name for name in sys.modules if name in ("lta_analysis.bags", "lta_cli.verbs")],'
        '"plotly" in sys.modules, "rclpy" in sys.modules)'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ['lta_analysis.bags', 'False', 'False']


def test_every_verb_of_the_registry_is_there(call):
    status, said = call('--help')
    assert status == 0
    # The name is before two blanks; a verb may have two words
    rows = [line[2:] for line in said.out.splitlines() if line.startswith('│ ')]
    first = [row.split('  ')[0].strip() for row in rows]
    assert [name for name in first if name in app.VERBS] == list(app.VERBS)
    for name, verb in app.VERBS.items():
        inner = verb.verbs if isinstance(verb, app.VerbGroup) else {}
        for word in inner:
            status, said = call(name, word, '--help')
            assert status == 0
            assert f'lta {name} {word}' in said.out


def test_a_list_says_what_loaded_verbs_say_of_themselves():
    """It is read from their files, in a tenth of the time that they take to load."""
    loaded = get_command(app.build_app()).commands
    listed = get_command(app.build_app(['--help'])).commands
    assert {name: verb.help for name, verb in listed.items()} == {
        name: verb.help for name, verb in loaded.items()
    }
    inner = get_command(app.build_app(['light', '--help'])).commands['light'].commands
    for name, verb in loaded['light'].commands.items():
        assert inner[name].help == verb.help


def test_a_list_loads_no_verb():
    code = (
        'import sys; from lta_cli.app import build_app; build_app(["--help"]);'
        'heavy = "lta_cli.verbs", "lta_report", "numpy";'
        'print(*[name for name in sys.modules if name.startswith(heavy)])'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_options_of_several_values_may_stand_once():
    words = [
        'discover',
        '--train',
        'a',
        'b',
        '--confirm',
        'c',
        '--seed',
        '3',
        '--holdout',
        'd',
        'e',
    ]
    assert app.repeat_options(words) == [
        'discover', '--train', 'a', '--train', 'b', '--confirm', 'c', '--seed', '3',
        '--holdout', 'd', '--holdout', 'e',
    ]  # fmt: skip
    assert app.repeat_options(['simulate', '--train', 'a', 'b']) == [
        'simulate',
        '--train',
        'a',
        'b',
    ]
    assert app.repeat_options([]) == []


@pytest.mark.parametrize(
    ('words', 'joined'),
    [
        (['effects', 'new', 'walls'], ['effects new', 'walls']),
        (['effects', 'walls'], ['effects', 'walls']),
        (['effects'], ['effects']),
        ([], []),
    ],
)
def test_a_verb_of_two_words_is_one(words, joined):
    assert app.join_verb(words) == joined
