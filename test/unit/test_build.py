"""`make build`: messages that cannot be compiled do not keep anybody from flying."""

import importlib.util
from pathlib import Path
import shutil
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
# In place of .venv/bin/python: it builds no messages, and logs how it was called
PYTHON = """#!/bin/sh
echo "$* PYTHONPATH=${PYTHONPATH-unset}" >>log.txt
[ "$1" != tools/messages.py ] || exit "$(cat status)"
"""


@pytest.fixture(scope='module')
def messages():
    path = ROOT / 'tools/messages.py'
    specification = importlib.util.spec_from_file_location('lta_tools_messages', path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.fixture
def workspace(tmp_path):
    """Return a folder with all that tools/build.sh reads."""
    for name in (
        'config/setup.py', 'config/package.xml', 'src/one/setup.py',
        'src/one/package.xml', 'tools/messages.py', 'tools/messages/one/package.xml',
        'tools/messages/one/msg/One.msg', '.venv/.lta',
    ):  # fmt: skip
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    shutil.copy(ROOT / 'tools/build.sh', tmp_path / 'tools')
    (tmp_path / '.venv/bin').mkdir()
    for name, text in (('python', PYTHON), ('colcon', '#!/bin/sh\nmkdir install\n')):
        (tmp_path / '.venv/bin' / name).write_text(text, 'utf-8')
        (tmp_path / '.venv/bin' / name).chmod(0o755)
    return tmp_path


def build(workspace, status):
    (workspace / 'status').write_text(str(status), 'utf-8')
    words = ['env', 'PYTHONPATH=/opt/ros', workspace / 'tools/build.sh']
    return subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize('status', [1, 3])
def test_a_failure_to_build_messages_ends_no_build(workspace, status):
    done = build(workspace, status)
    assert done.returncode == 0, done.stderr
    assert ('nothing is published on /tf' in done.stderr) == (status == 1)
    assert (workspace / 'install/.lta').exists()
    assert not (workspace / '.venv/.messages').exists()


def test_messages_are_built_once_and_without_the_packages_of_a_sourced_ros(workspace):
    for _ in range(2):
        assert build(workspace, 0).returncode == 0
    (line,) = [
        each
        for each in (workspace / 'log.txt').read_text('utf-8').splitlines()
        if 'messages.py' in each
    ]
    assert line == 'tools/messages.py tools/messages/one PYTHONPATH=unset'


def test_a_copied_library_does_not_change_under_whoever_has_it_open(messages, tmp_path):
    old, new = tmp_path / 'venv/lib.so', tmp_path / 'built/lib.so'
    for path in (old, new):
        path.parent.mkdir()
        path.write_text(path.parent.name, 'utf-8')
    with old.open(encoding='utf-8') as file:
        messages.copy_files(new.parent, old.parent)
        assert file.read() == 'venv'
    assert [path.name for path in old.parent.iterdir()] == ['lib.so']
    assert old.read_text('utf-8') == 'built'


def test_a_compiler_that_fails_is_reported_and_changes_nothing(messages, tmp_path):
    if messages.find_missing():
        pytest.skip('this machine lacks a compiler')
    for name in ('cc', 'c++'):
        (tmp_path / name).write_text('#!/bin/sh\necho no stdlib.h >&2\nexit 1\n', 'utf-8')
        (tmp_path / name).chmod(0o755)
    installed = messages.SITE / 'tf2_msgs'
    before = installed.stat().st_ino
    words = [sys.executable, ROOT / 'tools/messages.py', ROOT / 'tools/messages/tf2_msgs']
    done = subprocess.run(
        words, env={'PATH': str(tmp_path), 'AMENT_PREFIX_PATH': str(messages.VENV)},
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert 'no stdlib.h' in done.stderr
    assert installed.stat().st_ino == before


def test_the_messages_are_installed_where_they_can_be_compiled(messages):
    """Tests of /tf are skipped without them, which must not hide that they fail to build."""
    if messages.find_missing():
        pytest.skip('this machine lacks a compiler')
    assert importlib.util.find_spec('tf2_msgs.msg._tf_message') is not None
