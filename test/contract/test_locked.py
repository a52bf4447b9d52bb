# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is installed is locked by hash, as the requirements ask, and its licences are known."""

from importlib import import_module
from pathlib import Path
import re
import sys

from lta_cli.doctor.machine import NEWEST_PYTHON
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
import pytest

ROOT = Path(__file__).resolve().parents[2]
HERE = f'{sys.version_info.major}.{sys.version_info.minor}'
NEWEST = sys.version_info[:2] == NEWEST_PYTHON
LOCKS = ('uv', 'build', 'run', 'test', 'compiler')
ONE = re.compile(r'(\S+==[^\\]+?)((?: \\\n    --hash=sha256:[0-9a-f]{64})+)\n')


@pytest.fixture(autouse=True)
def with_tools(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / 'tools'))


def locked(name):
    """Return the requirements of a locked file, by package; each line must have its hashes."""
    head, *rest = (ROOT / f'locked/{name}.txt').read_text().splitlines(keepends=True)
    assert head.startswith('#')
    text = ''.join(rest)
    assert ONE.sub('', text) == '', 'each package has its version and hashes, and nothing else'
    found = [Requirement(wanted) for wanted, _ in ONE.findall(text)]
    return {canonicalize_name(one.name): one for one in found}


def for_this(name):
    """Return what of a locked file the Python that runs this takes."""
    return {package for package, one in locked(name).items()
            if one.marker is None or one.marker.evaluate()}  # fmt: skip


@pytest.mark.parametrize('name', LOCKS)
def test_locked_is_what_the_requirements_need_here(name):
    needed = import_module('lock').locked(LOCKS, (HERE,))[name]
    assert for_this(name) == needed.keys(), 'make lock'


@pytest.mark.skipif(NEWEST, reason='the newest Python lacks what older ones alone need')
@pytest.mark.parametrize('name', LOCKS)
def test_locked_is_what_the_requirements_need_of_each_python(name):
    marks = import_module('lock').locked(LOCKS)[name]
    wanted = {package: Requirement(f'{package}; {mark}').marker if mark else None
              for package, mark in marks.items()}  # fmt: skip
    assert {package: one.marker for package, one in locked(name).items()} == wanted, 'make lock'


@pytest.mark.parametrize('name', [*LOCKS, 'docs'])
def test_locked_versions_are_the_pinned_ones(name):
    lock = import_module('lock')
    pins = lock.pins('constraints.txt', lock.LOCKS[name].source)
    assert {one: f'=={pins[one]}' for one in locked(name)} == {
        one: str(each.specifier) for one, each in locked(name).items()
    }


def test_everything_that_is_asked_for_is_pinned_and_nothing_else():
    needed = {package for name in LOCKS for package in locked(name)}
    assert needed == import_module('lock').pins('constraints.txt').keys()


def test_what_the_site_is_asked_for_is_locked():
    assert import_module('lock').pins('requirements-docs.txt').keys() <= locked('docs').keys()


@pytest.mark.skipif(NEWEST, reason='the newest Python lacks packages that are listed')
def test_the_list_of_licences_is_complete_and_fresh():
    page = import_module('licences').page()
    assert (ROOT / 'docs/licences.md').read_text() == page, 'make lock'
    assert '|  |' not in page


@pytest.mark.parametrize('lock', ['build', 'run'])
def test_the_base_install_has_nothing_under_the_gpl_alone(lock):
    licences = import_module('licences')
    copyleft = [
        name
        for name in for_this(lock)
        if re.search('GPL|GNU', licences.licence(name)) and name not in {'docutils', 'pymavlink'}
    ]
    assert not copyleft
    assert licences.licence('pymavlink') == 'GNU Lesser General Public License v3 (LGPLv3)'
    assert {'Public Domain', 'BSD License'} <= set(licences.licence('docutils').split(', '))
