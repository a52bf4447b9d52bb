# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`colcon test` runs the unit tests of each package, and each unit test belongs to one."""

import os
from pathlib import Path
import re
import shutil
import subprocess
import sys

import package_tests
from package_tests import list_tests, PACKAGE_TESTS, UNIT
import pytest
from waiting import PATIENCE
import yaml

ROOT = Path(__file__).resolve().parents[2]
# Besides what `make test` runs of lta_graph: one test that fails, and one that is too long
ADDED = """
import pytest


def test_that_fails():
    assert not 'broken'


@pytest.mark.long
def test_that_is_long():
    assert not 'run'
"""


def test_every_unit_test_belongs_to_one_package_and_every_package_has_one():
    for name in PACKAGE_TESTS:
        assert list_tests(name), f'{name or "the tools"}: no unit test'
    listed = [path for name in PACKAGE_TESTS for path in list_tests(name)]
    assert sorted(listed) == sorted(UNIT.rglob('test_*.py'))
    places = [place for paths in PACKAGE_TESTS.values() for place in paths]
    assert len(places) == len(set(places))
    assert [place for place in places if not (UNIT / place).exists()] == []


def test_a_test_without_a_place_is_reported():
    with pytest.raises(LookupError, match=r'nowhere/test_one.py belongs to no package; add it'):
        package_tests.find_package(UNIT / 'nowhere/test_one.py')


def test_each_package_has_the_test_arguments_of_colcon_meta():
    names = yaml.safe_load((ROOT / 'colcon.meta').read_text('utf-8'))['names']
    python = {'pytest-args': ['-m', 'not long']}
    tested = {name: python for name in PACKAGE_TESTS if name}
    assert names == tested | {'lta_msgs': {'cmake-args': ['-DBUILD_TESTING=OFF']}}


PLUGIN = """
import pytest


@pytest.hookspec(firstresult=True)
def pytest_launch_collect_makemodule(path, module): pass


def pytest_pycollect_makemodule(path, parent): pass
"""


def test_the_tests_run_beside_the_plugins_of_jazzy(tmp_path):
    """Their hooks have arguments that pytest 9 has no more."""
    # The names of the plugins of launch_testing, launch_testing_ros and launch_pytest
    for name in ('launch_testing', 'launch_ros', 'launch_pytest'):
        (tmp_path / f'{name}.py').write_text(PLUGIN, encoding='utf-8')
        info = tmp_path / f'{name}-3.4.3.dist-info'
        info.mkdir()
        (info / 'METADATA').write_text(f'Name: {name}\nVersion: 3.4.3\n', 'utf-8')
        (info / 'entry_points.txt').write_text(f'[pytest11]\n{name} = {name}\n', 'utf-8')
    file = 'test/unit/graph/test_launch_table.py'
    words = [sys.executable, '-m', 'pytest', '--collect-only', '-q', file]
    path = f'{tmp_path}:{os.environ.get("PYTHONPATH", "")}'
    done = subprocess.run(
        words, cwd=ROOT, env={**os.environ, 'PYTHONPATH': path}, capture_output=True, text=True,
        timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_failing_test_fails_colcon_test_and_a_long_one_is_not_run(tmp_path):
    unit = tmp_path / 'test/unit'
    (unit / 'graph').mkdir(parents=True)
    names = ['colcon.meta', 'conftest.py', 'pyproject.toml', 'test/unit/conftest.py']
    names += [f'test/unit/{place}' for place in ('report_flight.py', 'graph/test_lockstep.py')]
    names += [f'test/{path.name}' for path in (ROOT / 'test').glob('*.py')]
    for name in names:
        shutil.copy(ROOT / name, tmp_path / name)
    (unit / 'graph/test_added.py').write_text(ADDED, encoding='utf-8')
    shutil.copytree(ROOT / 'src/lta_graph', tmp_path / 'src/lta_graph')
    colcon = Path(sys.prefix) / 'bin/colcon'

    def run(*words: object) -> tuple[int, str]:
        command = [colcon, '--log-base', tmp_path / 'log', *words]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    status, said = run(
        'test', '--paths', 'src/lta_graph', '--install-base', ROOT / 'install',
        '--return-code-on-test-failure',
    )  # fmt: skip
    assert status == 1, said
    status, said = run('test-result', '--verbose')
    assert status == 1
    assert 'test_that_fails' in said
    (tests,) = re.findall(r'Summary: (\d+) tests, 0 errors, 1 failure, 0 skipped', said)
    assert int(tests) > 10
