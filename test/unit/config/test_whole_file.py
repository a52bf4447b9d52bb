# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Files and folders of results: whole or not at all, and where they may lie."""

import os
from pathlib import Path
import stat
import tempfile

from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput
from lta_config.machine import find_cache_folder
from lta_report.results_folder import write_file, write_json
import pytest


def write(path, text, fault=None):
    with replace_atomically(path) as part:
        part.write_text(text)
        if fault is not None:
            raise fault


def test_a_file_takes_the_place_of_the_one_before_when_it_is_whole(tmp_path):
    path = tmp_path / 'page'
    for text in ('old', 'new'):
        write(path, text)
        assert path.read_text() == text
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize('fault', [KeyboardInterrupt, OSError])
@pytest.mark.parametrize('before', [[], ['page']])
def test_what_breaks_off_leaves_what_was_there(tmp_path, fault, before):
    for name in before:
        (tmp_path / name).write_text('old')
    with pytest.raises(fault):
        write(tmp_path / 'page', 'new', fault)
    assert {one.name: one.read_text() for one in tmp_path.iterdir()} == dict.fromkeys(
        before, 'old'
    )


@pytest.mark.parametrize('keep', [write_json, write_file])
def test_results_that_find_no_room_are_told_and_leave_the_earlier_ones(tmp_path, room, keep):
    path = tmp_path / 'result'
    long = ['x' * 500] if keep is write_json else 'x' * 500
    with room(100), pytest.raises(BadInput, match='cannot be written'):
        keep(long, path)
    assert not list(tmp_path.iterdir())
    path.write_text('good')
    with room(100), pytest.raises(BadInput, match='cannot be written'):
        keep(long, path)
    assert path.read_text() == 'good'
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_one_and_what_is_no_file_is_written_to(tmp_path):
    link = tmp_path / 'link'
    link.symlink_to(tmp_path / 'page')
    write(link, 'new')
    assert link.is_symlink()
    assert (tmp_path / 'page').read_text() == 'new'
    pipe = tmp_path / 'pipe'
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    # By its name, and as /dev/stdout leads to a pipe that has none.
    for path in (pipe, Path(f'/proc/self/fd/{reader}')):
        write(path, 'heard')
        assert os.read(reader, 100) == b'heard'
    os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)


@pytest.fixture
def nothing_writable(monkeypatch, tmp_path):
    """Point home at a path that cannot be created, and temporary files at a folder."""
    monkeypatch.delenv('XDG_CACHE_HOME', raising=False)
    monkeypatch.setenv('HOME', '/proc/nowhere')
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path))
    return tmp_path


def test_xdg_comes_before_home(monkeypatch, tmp_path):
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'xdg'))
    monkeypatch.setenv('HOME', str(tmp_path / 'home'))
    assert find_cache_folder('kernels') == tmp_path / 'xdg/lta/kernels'
    monkeypatch.delenv('XDG_CACHE_HOME')
    assert find_cache_folder('cfd') == tmp_path / 'home/.cache/lta/cfd'


def test_without_a_home_the_folder_is_private_and_found_again(nothing_writable):
    folder = find_cache_folder('kernels')
    assert folder.is_relative_to(nothing_writable)
    assert stat.S_IMODE(folder.parent.stat().st_mode) == 0o700
    assert find_cache_folder('kernels') == folder


def test_a_user_without_an_entry_in_the_password_database(nothing_writable, monkeypatch):
    def fail():
        raise RuntimeError('Could not determine home directory.')

    monkeypatch.setattr(Path, 'home', fail)
    assert find_cache_folder('kernels').is_relative_to(nothing_writable)


@pytest.mark.parametrize('kind', ['open', 'link', 'broken link', 'file'])
def test_a_folder_that_others_can_write_is_not_used(nothing_writable, tmp_path_factory, kind):
    """Compiled code from it would run with this user's rights."""
    first = find_cache_folder('kernels').parent
    if kind == 'open':
        first.chmod(0o777)
    elif kind == 'file':
        first.rmdir()
        first.touch()
    else:
        first.rmdir()
        elsewhere = tmp_path_factory.mktemp('elsewhere')
        first.symlink_to(elsewhere / 'nowhere' if kind == 'broken link' else elsewhere)
    assert find_cache_folder('kernels').parent != first
