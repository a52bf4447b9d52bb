# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What people type or write wrong: three tables of what is said of it, and rules for all sentences.

`messages.txt` has commands, each followed by exit status and sentence; they are called in one
process, in a folder with the files of `stage`. `mistakes.txt` has shipped files in which something
is changed, each followed by what their reader says: a place of the file and what it then holds,
nothing where that is null. `calls.txt` has calls from Python with the module of their names. All
of these are added by hand; `python test/golden/test_messages.py` renews the sentences (in the
workspace).
"""

import ast
from collections import defaultdict
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
import importlib
import io
import math
import os
from pathlib import Path
import re
import shlex
import sys
import tempfile

from lta_cli import app
from lta_config.errors import BadInput
from lta_config.files import (
    find_file,
    format_error,
    KIND_FOLDERS,
    list_shipped_names,
    load_file,
    load_yaml,
    share_folder,
)
from lta_config.schema.cell_file import load_cell_file
from lta_config.schema.comparison_file import load_comparison, load_maneuver_file
from lta_config.schema.mission_file import load_light_day, load_mission
from lta_config.schema.mount_file import mount_panels
from lta_config.schema.paper_file import PaperRow
from lta_config.schema.spectrum_file import load_spectrum
from lta_config.schema.sweep_file import load_sweep
from lta_config.topics import TopicTable
from lta_control.laws import load_gains
from lta_flight.sweep.plan import SweepPlan
from lta_model.electrical.panel import fit_diode
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_studies.light.plan.floor import FloorPlan
import numpy as np
from pydantic import ValidationError
import pytest
from typer.main import get_command
import yaml

ROOT = Path(__file__).resolve().parents[2]
TABLE = Path(__file__).with_name('messages.txt')
MISTAKES = Path(__file__).with_name('mistakes.txt')
CALLS = Path(__file__).with_name('calls.txt')
READERS = {  # of each kind of file, by its path
    'cell': lambda path: fit_diode(load_cell_file(path)),
    'comparison': load_comparison,
    'floor plan': lambda path: load_file(FloorPlan, Path(path)),
    'gains': load_gains,
    'light of the day': load_light_day,
    'manoeuvre': load_maneuver_file,
    'mission': load_mission,
    'mount': lambda path: mount_panels(load_yaml(find_file('vehicle', 'gtmab')), path),
    'row of the paper': lambda path: load_file(PaperRow, Path(path)),
    'scenario': lambda path: load_scenario(path).light_field,
    'spectrum': load_spectrum,
    'sweep': lambda path: SweepPlan(load_sweep(path)).check(),
    'topics': lambda path: load_file(TopicTable, Path(path)),
    'vehicle': lambda path: load_vehicle(path).build_model(),
}
GTMAB = (ROOT / 'config/vehicles/gtmab.yaml').read_text()
SPOILT = {  # vehicle files with one mistake each
    'unknown_key': ('about:', 'abuot: x\nabout:'),
    'missing_unit': ('{value: 116.8, unit: g,', '{value: 116.8,'),
    'wrong_unit': ('{value: 2, unit: g, source', '{value: 2, unit: parsec, source'),
    'negative': ('value: 116.8', 'value: -116.8'),
    'nan': ('value: 116.8', 'value: .nan'),
    'text': ('value: 116.8', 'value: heavy'),
    'no_yaml': ('schema: 3', 'schema: [2'),
    'newer': ('schema: 3', 'schema: 99'),
}


def read_table():
    """Return the rows: a command line, its exit status, its sentence."""
    lines = TABLE.read_text(encoding='utf-8').splitlines()
    rows = zip(lines[::2], lines[1::2], strict=True)
    return [(command, *answer.strip().split(' ', 1)) for command, answer in rows]


def stage(folder):
    """Write what the commands of the table meet into a folder."""
    (folder / 'empty').mkdir()
    (folder / 'full').mkdir()
    (folder / 'full/thesis.tex').write_text('mine')
    (folder / 'text.txt').write_text('no table\n')
    (folder / 'broken.yaml').write_text('a: [1')
    (folder / 'list.yaml').write_text('- 1\n')
    for name, (old, new) in SPOILT.items():
        assert old in GTMAB
        (folder / f'{name}.yaml').write_text(GTMAB.replace(old, new, 1))
    sys.path.append(str(ROOT / 'test/unit'))
    from report_flight import write_flight

    write_flight(folder / 'flight', until=5.0)


def answer(command, folder):
    """Return the exit status and what a command line says, folders by their names."""
    out, err = io.StringIO(), io.StringIO()
    sys.argv = shlex.split(command)
    with redirect_stdout(out), redirect_stderr(err):
        status = app.run_command_line()
    said = (out.getvalue() + err.getvalue()).strip()
    return str(status), said.replace(str(folder), 'HERE').replace(str(ROOT), 'ROOT')


ROWS = defaultdict(list)
for row in read_table():
    ROWS[row[0].split()[1]].append(row)


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp('here')
    stage(folder)
    return folder


@pytest.fixture
def here(folder, monkeypatch):
    monkeypatch.chdir(folder)
    monkeypatch.setenv('COLUMNS', '120')
    monkeypatch.setattr(sys, 'argv', ['lta'])
    return folder


@pytest.mark.parametrize('verb', ROWS)
def test_what_is_typed_wrong_is_answered_as_in_the_table_and_nothing_is_made(here, verb):
    before = sorted(here.iterdir())
    wrong = [
        f'{command}\n  {status} {sentence}\n  now: {" ".join(now)}'
        for command, status, sentence in ROWS[verb]
        if (now := answer(command, here)) != (status, sentence)
    ]
    assert not wrong, '\n'.join(wrong)
    assert sorted(here.iterdir()) == before


def list_commands(command, path=()):
    """Yield the words and the parameters of each command."""
    if hasattr(command, 'commands'):
        for name, inner in command.commands.items():
            yield from list_commands(inner, (*path, name))
    else:
        yield path, command.params


# `lta run` passes on what it does not know
COMMANDS = dict(list_commands(get_command(app.build_app())))
COMMANDS.pop(('run',))


@pytest.mark.parametrize('path', COMMANDS, ids=' '.join)
def test_every_option_refuses_what_it_cannot_be(here, path):
    """One that is not known, no number, none of its choices, an empty path."""
    before, verb = sorted(here.iterdir()), ' '.join(path)
    status, said = answer(f'lta {verb} --nonsense', here)
    assert status == '2'
    assert said.startswith('No such option: --nonsense')
    places = [one for one in COMMANDS[path] if not one.opts[0].startswith('-') and one.required]
    for one in COMMANDS[path]:
        kind, name = one.type_descriptor.annotation, one.opts[0]
        bad = "''" if 'Path' in str(kind) else 'x'
        typed = kind in (int, float) or re.search('Literal|Fidelity|Path|.int]|.float]', str(kind))
        if name.startswith('--') and typed and not getattr(one, 'is_flag', False):
            words = ' '.join('nope' for _ in places)
            status, said = answer(f'lta {verb} {words} {name} {bad}', here)
            assert status == '2'
            check_sentence(said)
    assert sorted(here.iterdir()) == before


def check_sentence(text):
    """Assert the rules of messages: one line, one sentence that ends, no code, no shouting."""
    assert '\n' not in text, text
    assert text.endswith('.'), text
    assert not re.search(r'Traceback|<class|object at 0x|\bErrno\b|\berror:|please|!', text), text
    assert not re.search(r'  |\bNone\b', text), text


def test_every_sentence_of_the_table_keeps_the_rules():
    rows = read_table()
    assert len(rows) > 150
    assert len({command for command, _, _ in rows}) == len(rows)
    for _, status, sentence in rows:
        assert status == '2'
        check_sentence(sentence)


def list_mistakes():
    """Return kind and name of a file, what is changed in it, and what is said, for each row."""
    lines = MISTAKES.read_text(encoding='utf-8').splitlines()
    rows = []
    for line, said in zip(lines[::2], lines[1::2], strict=True):
        file, *changes = line.split(' | ')
        rows.append((*file.rsplit(' ', 1), changes, said.strip()))
    return rows


def describe_mistake(kind, name, changes, folder):
    """Return what the reader of a file says of it with these changes."""
    shipped = share_folder() / 'topics.yaml' if kind == 'topics' else find_file(kind, name)
    content = load_yaml(shipped)
    for change in changes:
        ((place, value),) = yaml.safe_load(f'{{{change}}}').items()
        *way, last = place.split('.')
        part = content
        for key in way:
            part = part[key]
        part[last] = value
        if value is None:
            del part[last]
    # What a reader has stored of a path is not that of the next row
    path = Path(tempfile.mkdtemp(dir=folder)) / f'{name}.yaml'
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    try:
        READERS[kind](str(path))
    except BadInput as error:
        return str(error).replace(f'{path.parent}/', '').replace(str(ROOT), 'ROOT')
    return 'nothing is said'


@pytest.mark.parametrize('kind', READERS)
def test_what_is_written_wrong_in_a_file_is_told_as_in_the_table(kind, tmp_path):
    rows = [row for row in list_mistakes() if row[0] == kind]
    assert rows
    for _, name, changes, said in rows:
        assert describe_mistake(kind, name, changes, tmp_path) == said, changes
        check_sentence(said)


def list_calls():
    """Return a call with the module of its names, and what is said, for each row."""
    lines = CALLS.read_text(encoding='utf-8').splitlines()
    return [(call, said.strip()) for call, said in zip(lines[::2], lines[1::2], strict=True)]


def describe_call(row):
    """Return the reason for which a call is refused."""
    module, call = row.split(': ', 1)
    names = {'inf': math.inf, 'nan': math.nan, 'np': np, 'replace': replace}
    try:
        eval(call, vars(importlib.import_module(module)) | names)
    except BadInput as error:
        return str(error)
    except ValidationError as error:
        return format_error(error)
    return 'nothing is said'


@pytest.mark.parametrize('package', ['control', 'model', 'vlc'])
def test_what_is_called_wrong_is_refused_as_in_the_table(package):
    rows = [row for row in list_calls() if row[0].startswith(f'lta_{package}.')]
    assert rows
    for call, said in rows:
        assert describe_call(call) == said, call
        check_sentence(said)


@pytest.mark.parametrize('kind', sorted(READERS.keys() - {'gains', 'sweep', 'topics'}))
def test_every_shipped_file_is_read_and_is_called_what_it_is(kind):
    names = list_shipped_names(KIND_FOLDERS[kind])
    assert names
    for name in names:
        path = find_file(kind, name)
        assert load_yaml(path)['name'] == name
        READERS[kind](str(path))


def list_literals():
    """Yield the text of each BadInput in the sources, values as X, and where it is."""
    for path in sorted([*ROOT.glob('src/lta_*/lta_*/**/*.py'), *ROOT.glob('config/**/*.py')]):
        for node in ast.walk(ast.parse(path.read_text())):
            called = isinstance(node, ast.Call) and ast.unparse(node.func) == 'BadInput'
            if not called or not node.args:
                continue
            text = node.args[0]
            parts = text.values if isinstance(text, ast.JoinedStr) else [text]
            if all(isinstance(one, ast.Constant | ast.FormattedValue) for one in parts):
                words = (str(one.value) if isinstance(one, ast.Constant) else 'X' for one in parts)
                yield ''.join(words), f'{path.relative_to(ROOT)}:{node.lineno}'


def test_every_sentence_of_the_sources_keeps_the_rules():
    sentences = [(text, place) for text, place in list_literals() if text != 'X']
    assert len(sentences) > 300
    for text, place in sentences:
        assert text.endswith(('.', 'X', '.)')), f'{place}: {text}'
        assert not re.search(r'\bplease\b|!$|\berror:|  |\n', text), f'{place}: {text}'


def renew():
    """Write the tables with the sentences of today; commands and changes stay."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        told = [
            ' | '.join((f'{kind} {file}', *changes))
            + f'\n  {describe_mistake(kind, file, changes, folder)}\n'
            for kind, file, changes, _ in list_mistakes()
        ]
    MISTAKES.write_text(''.join(told), encoding='utf-8')
    told = [f'{call}\n  {describe_call(call)}\n' for call, _ in list_calls()]
    CALLS.write_text(''.join(told), encoding='utf-8')
    lines = TABLE.read_text(encoding='utf-8').splitlines()
    commands = [line for line in lines if line.startswith('lta ')]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        stage(folder)
        os.chdir(folder)
        os.environ['COLUMNS'] = '120'
        rows = [(command, *answer(command, folder)) for command in dict.fromkeys(commands)]
    text = ''.join(f'{command}\n  {status} {said}\n' for command, status, said in rows)
    TABLE.write_text(text, encoding='utf-8')


if __name__ == '__main__':
    renew()
