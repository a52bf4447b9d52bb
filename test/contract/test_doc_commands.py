# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Every command of the pages exists, with its options; those that take a second are run."""

from importlib.util import find_spec
import re
import shlex

from campaigns.harness import build_parser, list_campaigns
from doc_blocks import blocks, PAGES, pieces, ROOT, run, settings_spoken, simple, spoken, stage
from lta_cli.app import build_app, join_verb, repeat_options
from lta_graph.launches import find_launch, LAUNCHES
import pytest
from typer.main import get_command
from waiting import PATIENCE

BLOCKS = blocks()
TARGETS = set(re.findall(r'^([a-z0-9-]+):', (ROOT / 'Makefile').read_text(), re.MULTILINE))
LEFT_OUT = re.compile(r'\.\.\.|\$')


def parse(words):
    """Ask Typer whether it knows a command line of lta, without running it."""
    words = join_verb(repeat_options(words))
    command = get_command(build_app(words))
    name, rest = 'lta', list(words)
    while hasattr(command, 'commands'):
        if not rest or rest[0] == '--help':
            return
        name = rest.pop(0)
        assert name in command.commands, f'{name} is no verb; known: {", ".join(command.commands)}'
        command = command.commands[name]
    if '--help' in rest:
        return
    command.make_context(name, rest, resilient_parsing=False)
    if name == 'launch':
        launch_arguments(words[1:])


def launch_arguments(words):
    """Ask the launch file whether it has the arguments that it is given."""
    known = {argument.name for argument in find_launch(words[0]).list_arguments()}
    given = {word.partition(':=')[0] for word in words[1:] if ':=' in word}
    assert given <= known, f'{given - known} are no arguments of {words[0]}'


def check(words):
    """Assert that one command can be meant: its program, verb, options, target, module."""
    program, *rest = words
    if program in {'./lta', 'lta'}:
        parse(rest)
    elif program == 'make' and rest[:1] == ['campaign'] and rest[1:]:
        assert rest[1] in list_campaigns(), f'{rest[1]} is no campaign'
        options = ' '.join(rest[2:]).removeprefix('ARGS=').replace('...', '.')
        build_parser(rest[1]).parse_args(shlex.split(options))
    elif program == 'make' and '-C' not in rest:
        targets = {word for word in rest if '=' not in word}
        assert targets <= TARGETS, f'{targets - TARGETS} are no targets of the Makefile'
    elif program.endswith('python') and rest[:1] == ['-m']:
        assert rest[1] == 'venv' or find_spec(rest[1]) is not None
    elif program.endswith('python') and rest and rest[0].endswith('.py'):
        assert (ROOT / rest[0]).exists(), rest[0]


LINES = [(block, line) for block in BLOCKS if block.language == 'sh' for line in block.lines]


@pytest.mark.parametrize(('block', 'line'), LINES, ids=lambda value: str(value)[:60])
def test_a_command_of_a_block_can_be_meant(block, line):
    del block
    for words in simple(line):
        assigned = re.compile(r'\w+=')
        words = [word for k, word in enumerate(words) if k or not assigned.match(word)]
        if words and not LEFT_OUT.search(' '.join(words)):
            check(words)


@pytest.mark.parametrize(('page', 'code'), spoken())
def test_a_command_in_running_text_can_be_meant(page, code):
    del page
    words = simple(code)[0]
    if len(words) == 2 or not LEFT_OUT.search(code):
        spoken_words(words)


@pytest.mark.parametrize(('page', 'of_node', 'name'), settings_spoken())
def test_a_setting_in_running_text_is_one_of_a_launch_file_or_of_a_node(page, of_node, name):
    del page
    if of_node:
        assert f'`{name}`' in (ROOT / 'docs/parameters.md').read_text()
        return
    known = {item.name for each in LAUNCHES.values() for item in each.list_arguments()}
    assert name in known


def spoken_words(words):
    """Check a command that may leave out what it needs, as text does: the verb and its options."""
    try:
        check(words)
    except Exception as error:
        message = getattr(error, 'format_message', None)
        short = ('Missing argument', 'Missing option', 'requires an argument', 'valid integer')
        if message is None or not any(text in message() for text in short):
            raise


@pytest.mark.parametrize(
    'block', [block for block in BLOCKS if block.language == 'python'], ids=str
)
def test_a_python_block_compiles(block):
    compile(block.text, str(block), 'exec')


def test_pages_have_blocks_and_say_why_some_are_not_run():
    assert len(PAGES) > 30
    assert len(LINES) > 100
    for block in BLOCKS:
        for kind, part, why in block.marks:
            assert kind == 'quick' or len(why) > 3, f'{block} is not run and does not say why'
            assert part in block.text, f'{block}: no line holds {part}'


QUICK = pieces(quick=True)


@pytest.mark.parametrize('name', QUICK)
def test_what_is_quick_runs(name, tmp_path):
    stage(tmp_path)
    for language, text in QUICK[name]:
        run(language, text, tmp_path, PATIENCE)
