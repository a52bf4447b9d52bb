# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Results appear when all are there, or none does."""

from datetime import datetime
import os
from pathlib import Path
import subprocess
import sys

from lta_config.atomic_file import PART_SUFFIX, release_folders, stage_results
from lta_config.errors import BadInput
from lta_report.results_folder import check_creatable, resolve_folder
import pytest


def test_results_appear_together_and_the_last_one_last(tmp_path, monkeypatch):
    folder = tmp_path / 'out'
    moved = []
    with stage_results(folder, 'b') as part:
        for name in 'cba':
            (part / name).write_text(name)
        assert [one.name for one in folder.iterdir()] == [part.name]
        rename = type(part).rename
        monkeypatch.setattr(
            type(part), 'rename', lambda one, to: (moved.append(to.name), rename(one, to))
        )
    assert sorted(moved[:2]) == ['a', 'c']
    assert moved[2:] == ['b']
    assert {one.name: one.read_text() for one in folder.iterdir()} == {n: n for n in 'abc'}


@pytest.mark.parametrize('fault', [KeyboardInterrupt, OSError])
def test_nothing_half_written_stays(tmp_path, fault):
    held = tmp_path / 'held'
    held.mkdir()
    (held / 'flights').write_text('')

    def stopped(folder):
        with stage_results(folder, 'b') as part:
            (part / 'a').write_text('a')
            raise fault

    for folder in (tmp_path / 'new', held):
        with pytest.raises(fault):
            stopped(folder)
    assert [one.name for one in tmp_path.iterdir()] == ['held']
    assert [one.name for one in held.iterdir()] == ['flights']


WRITER = """
import sys
from pathlib import Path
from lta_config.atomic_file import replace_atomically
from lta_config.atomic_file import stage_results

folder = Path(sys.argv[1])
with stage_results(folder, 'b') as part, replace_atomically(folder / 'page.html') as page:
    (part / 'a').write_text('half')
    page.write_text('half')
    print('writes', flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def writer(tmp_path):
    """Return a folder to which a process is writing, and the process."""
    words = [sys.executable, '-c', WRITER, str(tmp_path / 'out')]
    pipe = subprocess.PIPE
    with subprocess.Popen(words, stdin=pipe, stdout=pipe, text=True) as process:
        assert process.stdout.readline() == 'writes\n'
        yield tmp_path / 'out', process
        process.kill()


def test_what_a_killed_command_was_writing_is_replaced(writer):
    folder, process = writer
    with pytest.raises(BadInput, match='Another command is writing to'):
        check_creatable(folder)
    assert {one.name for one in folder.iterdir()} == {PART_SUFFIX, f'.page.html{PART_SUFFIX}'}
    process.kill()
    process.wait()
    check_creatable(folder)
    with stage_results(folder, 'b') as part:
        (part / 'b').write_text('whole')
    assert {one.name: one.read_text() for one in folder.iterdir()} == {'b': 'whole'}


def test_a_command_does_not_write_beside_a_living_one(writer):
    folder, process = writer
    with (
        pytest.raises(BadInput, match='Another command is writing to'),
        stage_results(folder, 'b'),
    ):
        pass
    assert (folder / PART_SUFFIX / 'a').read_text() == 'half'
    process.stdin.close()
    assert process.wait() == 0
    assert {one.name for one in folder.iterdir()} == {'a', 'page.html'}


RESOLVER = """
from lta_report import results_folder
from test_results_folder import Noon

results_folder.datetime = Noon
folder = results_folder.resolve_folder(None, 'flight')
(folder / 'bag').write_text('')
print(folder.name)
"""


class Noon(datetime):
    """A clock that stands still."""

    @classmethod
    def now(cls, tz=None):
        return cls(2026, 11, 20, 12, tzinfo=tz)


def test_commands_of_the_same_second_have_folders_of_their_own(tmp_path):
    words = [sys.executable, '-c', RESOLVER]
    paths = {'PYTHONPATH': os.pathsep.join([str(Path(__file__).parent), *sys.path])}
    started = [
        subprocess.Popen(
            words, cwd=tmp_path, env=os.environ | paths, stdout=subprocess.PIPE, text=True
        )
        for _ in range(4)
    ]
    names = sorted(process.communicate()[0].strip() for process in started)
    ends = ('', '-2', '-3', '-4')
    assert names == [f'20261120-120000-flight{end}' for end in ends]


def test_a_command_that_wrote_nothing_leaves_no_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for _ in range(2):
        assert resolve_folder(None, 'flight').is_dir()
    (resolve_folder(None, 'kept') / 'bag').write_text('')
    release_folders()
    assert [one.name.partition('-')[2].partition('-')[2] for one in Path('runs').iterdir()] == [
        'kept'
    ]
    (tmp_path / 'new').mkdir()
    monkeypatch.chdir(tmp_path / 'new')
    resolve_folder(None, 'flight')
    release_folders()
    assert list(Path().iterdir()) == []
