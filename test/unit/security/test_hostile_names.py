# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Names and notes of strangers: none of their control characters reaches the terminal.

Each holds an escape sequence, C0 and C1, a change of direction, a character without width and line
separators; each is in a column, a variable, a topic, a joint, a frame, the provenance or a file.
"""

import os
import re
import subprocess
import sys

from lta_cli import app
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_data.importers.readers.sensor_folder import read_folder
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from scipy.io import savemat
import yaml

from .sandbox import find_control
from .test_hostile_pages import write_foreign

EVIL = 'e\x1b]0;own\x07\x1b[8m\x9b31m\u202egnp\u200b\u2066\x7f\u2028\x85\rx'
BYTES = 'bad\udcff'  # as Python shows a byte that is not UTF-8
COLUMNS = {f'{name} {EVIL} [m]': np.arange(50.0) for name in 'xyz'}


def write_csv(folder, names):
    rows = [','.join(f'{0.01 * k + 5:.2f}' for _ in range(4)) for k in range(60)]
    path = folder / 'log.csv'
    path.write_bytes('\n'.join([','.join(['time [s]', *names]), *rows, '']).encode())
    return path


def of_text(folder):
    # A line ends at some of them
    return write_csv(folder, [re.sub('[\r\x85\u2028]', '', name) for name in COLUMNS])


def of_parquet(folder):
    pq.write_table(pa.table({'time [s]': np.arange(50.0)} | COLUMNS), folder / 'log.parquet')
    return folder / 'log.parquet'


def of_numpy(folder):
    names = {f'{name} {EVIL.replace("/", "")}': cells for name, cells in COLUMNS.items()}
    np.savez(folder / 'log.npz', **({'time': np.arange(50.0)} | names))
    return folder / 'log.npz'


def of_matlab(folder):
    path = folder / 'log.mat'
    savemat(path, {'time': np.arange(50.0), 'abcdefghijklmnop': np.arange(50.0)})
    path.write_bytes(path.read_bytes().replace(b'abcdefghijklmnop', b'x\x1b]0;own\x07\x1b[8mz '))
    return path


def vehicle(folder):
    data = yaml.safe_load(find_file('vehicle', 'gtmab').read_text(encoding='utf-8'))
    data['about'] = data['hull']['diameter']['source'] = data['control']['source'] = EVIL
    path = folder / 'v.yaml'
    path.write_text(yaml.safe_dump(data))
    return path


def bag(folder):
    return write_foreign(folder / 'bag', EVIL)


DRAFT = ('import', '--draft', '--out', 'done')
COMMANDS = [
    *((DRAFT, build) for build in (of_text, of_parquet, of_numpy, of_matlab)),
    (('import', '--out', 'done'), of_text),
    (('import', '--out', 'done', '--mapping', 'tum'), of_text),
    *(
        (('vehicle', *words), vehicle)
        for words in [('show',), ('check',), ('diff', 'gtmab'), ('urdf',), ('show', '--json')]
    ),
    *(
        (('bag', *words), bag)
        for words in [
            ('info',), ('info', '--json'), ('check',), ('check', '--json'), ('plot',),
            ('export', '--out', 'done'),
        ]
    ),
    *(((verb, '--out', 'done'), bag) for verb in ('report', 'replay', 'import')),
]  # fmt: skip


@pytest.mark.parametrize(
    ('words', 'build'), COMMANDS, ids=[f'{build.__name__} {words}' for words, build in COMMANDS]
)
def test_what_a_command_prints_has_no_control_character(sandbox, tmp_path, words, build):
    told = sandbox.run([*words, build(tmp_path)], tmp_path)
    assert 'Traceback' not in told.err, told.err[-2000:]
    assert told.status in (0, 1, 2)
    assert told.out + told.err
    assert find_control(told.out + told.err) == set()


def test_the_table_of_reasons_names_the_columns_of_a_draft(sandbox, tmp_path):
    """Otherwise the tests above would pass for want of a name."""
    told = sandbox.run([*DRAFT, of_text(tmp_path)], tmp_path)
    assert '\ufffd]0;own\ufffd' in told.out


@pytest.mark.parametrize('name', ['a\x1b[31m', 'b\x07', 'c\x9b', 'd\nPage: x', BYTES, 'e\u2028'])
@pytest.mark.parametrize('verb', app.VERBS)
def test_an_argument_that_cannot_be_written_is_one_sentence(monkeypatch, capsys, verb, name):
    """None of these names can stand in YAML, a page or a bag; every command refuses it."""
    for words in ([verb, name], [verb, f'./{name}.yaml'], [verb, '--out', name]):
        monkeypatch.setattr(sys, 'argv', ['lta', *words])
        assert app.run_command_line() == 2
        (sentence,) = capsys.readouterr().err.splitlines()
        assert sentence.endswith('rename the file or correct the argument.')


@pytest.mark.parametrize('name', ['a\x1b[31m.csv', f'{BYTES}.csv', 'c\nd.csv'])
def test_a_file_in_a_folder_with_such_a_name_is_one_sentence(tmp_path, name):
    write_csv(tmp_path, 'xyz').rename(tmp_path / name)
    with pytest.raises(BadInput, match='contains a control character, or bytes'):
        read_folder(tmp_path)


def test_a_terminal_without_our_characters_gets_others():
    """This is the whole program; the sheet of a vehicle has bullets and degrees."""
    code = 'from lta_cli.command import main; main()'
    done = subprocess.run(
        [sys.executable, '-c', code, 'vehicle', 'show', 'gtmab'],
        env=os.environ | {'PYTHONIOENCODING': 'ascii'}, capture_output=True, check=True,
    )  # fmt: skip
    assert done.stderr == b''
    assert done.stdout.isascii()
    assert b'? Add' in done.stdout  # a warning, after its sign


def test_a_working_folder_whose_name_is_not_utf_8(sandbox, tmp_path):
    """The libraries of an export take no such path."""
    folder = tmp_path / BYTES
    folder.mkdir()
    bag(folder)
    told = sandbox.run(['bag', 'export', 'bag', '--out', 'done'], folder)
    assert told.status == 2
    assert len(told.err.splitlines()) == 1
    assert told.err.startswith('The name of a file or folder is not UTF-8')
