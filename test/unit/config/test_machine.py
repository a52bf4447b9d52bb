# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The cache folder: where XDG says, or a private one among the temporary files."""

from pathlib import Path
import stat
import tempfile

from lta_config.machine import find_cache_folder
import pytest


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
