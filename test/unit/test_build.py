# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`make build`: messages are compiled once, by whatever compiler there is."""

import importlib.util
from pathlib import Path
import shutil
import subprocess
import sys

import pytest
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.type_support import check_for_type_support
from waiting import PATIENCE

ROOT = Path(__file__).resolve().parents[2]
MESSAGES = ROOT / 'src/lta_msgs'
# In place of .venv/bin/python: it builds no messages, and logs how it was called
PYTHON = """#!/bin/sh
echo "$* PYTHONPATH=${PYTHONPATH-unset}" >>log.txt
[ "$1" != tools/messages.py ] || exit "$(cat status)"
"""
COLCON = """#!/bin/sh
mkdir -p install build/lta_one/lta_one build/lta_one/lta_one.egg-info
echo 'export AMENT_PREFIX_PATH=/built' >install/local_setup.sh
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
        'colcon.meta', 'config/setup.py', 'config/package.xml', 'src/one/setup.py',
        'src/one/package.xml', 'tools/messages.py', 'tools/messages/one/package.xml',
        'tools/messages/one/msg/One.msg', 'src/lta_msgs/package.xml',
        'src/lta_msgs/msg/One.msg', 'src/lta_msgs/action/One.action', '.venv/.lta',
    ):  # fmt: skip
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    shutil.copy(ROOT / 'tools/build.sh', tmp_path / 'tools')
    (tmp_path / '.venv/bin').mkdir()
    for name, text in (('python', PYTHON), ('colcon', COLCON)):
        (tmp_path / '.venv/bin' / name).write_text(text, 'utf-8')
        (tmp_path / '.venv/bin' / name).chmod(0o755)
    return tmp_path


def build(workspace, status):
    (workspace / 'status').write_text(str(status), 'utf-8')
    words = ['env', 'PYTHONPATH=/opt/ros', workspace / 'tools/build.sh']
    return subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, check=False)


def test_a_failure_to_build_messages_ends_the_build(workspace):
    assert build(workspace, 1).returncode == 2
    assert not (workspace / 'install').exists()
    assert not (workspace / '.venv/.messages').exists()


def list_message_builds(workspace):
    lines = (workspace / 'log.txt').read_text('utf-8').splitlines()
    return [each for each in lines if 'messages.py' in each]


def test_messages_are_built_once_and_without_the_packages_of_a_sourced_ros(workspace):
    for _ in range(2):
        assert build(workspace, 0).returncode == 0
    (line,) = list_message_builds(workspace)
    assert line == 'tools/messages.py tools/messages/one src/lta_msgs PYTHONPATH=unset'
    # What commands read instead of starting local_setup.sh
    written = (workspace / 'install/environment').read_text('utf-8').splitlines()
    assert written[1:] == ['AMENT_PREFIX_PATH /built', f'PYTHONPATH {workspace}/install/python']
    found = {path.name: path.readlink() for path in (workspace / 'install/python').iterdir()}
    assert found == {
        name: workspace / 'build/lta_one' / name for name in ('lta_one', 'lta_one.egg-info')
    }


@pytest.mark.parametrize('name', ['package.xml', 'msg/One.msg', 'action/One.action'])
def test_a_changed_message_builds_the_messages_again(workspace, name):
    build(workspace, 0)
    (workspace / 'src/lta_msgs' / name).write_text('float64 height\n', 'utf-8')
    build(workspace, 0)
    assert len(list_message_builds(workspace)) == 2


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


def test_packages_are_built_after_those_that_they_use(messages, tmp_path):
    for name, uses in (('a_msgs', 'c_msgs'), ('b_msgs', 'b_msgs'), ('c_msgs', 'std_msgs')):
        (tmp_path / name / 'msg').mkdir(parents=True)
        (tmp_path / name / 'package.xml').write_text(f'<package><name>{name}</name></package>')
        (tmp_path / name / 'msg/One.msg').write_text(f'float64 x  # [m]\n{uses}/Other[] other\n')
    packages = [messages.MessagePackage(path, {}) for path in sorted(tmp_path.iterdir())]
    assert [each.uses for each in packages] == [['c_msgs'], [], ['std_msgs']]
    (tmp_path / 'c_msgs/srv').mkdir()
    (tmp_path / 'c_msgs/srv/Ask.srv').write_text('string name\n---\nbool found\n')
    asked = messages.MessagePackage(tmp_path / 'c_msgs', {})
    assert asked.uses == ['builtin_interfaces', 'service_msgs', 'std_msgs']
    ordered = [each.name for each in messages.order_packages(packages)]
    assert sorted(ordered) == ['a_msgs', 'b_msgs', 'c_msgs']
    assert ordered.index('c_msgs') < ordered.index('a_msgs')


@pytest.mark.parametrize(
    ('there', 'first', 'commands'),
    [
        (['gcc', 'g++', 'clang', 'clang++'], 'gcc', [['gcc'], ['g++']]),
        (['cc', 'c++', 'gcc', 'g++'], 'cc', [['cc'], ['c++']]),
        (['cc', 'clang', 'clang++'], 'clang', [['clang'], ['clang++']]),
    ],
)
def test_both_compilers_are_of_one_kind(messages, monkeypatch, there, first, commands):
    monkeypatch.setattr(messages.shutil, 'which', lambda name: name in there or None)
    compilers = messages.find_compilers()
    assert [*compilers] == ['.c', '.cpp']
    assert [*compilers.values()] == commands
    assert compilers['.c'][0] == first


def test_without_a_c_plus_plus_compiler_ziglang_compiles(messages, monkeypatch):
    monkeypatch.setattr(messages.shutil, 'which', lambda name: name == 'cc' or None)
    monkeypatch.setattr(messages, 'find_spec', lambda name: name)
    compilers = messages.find_compilers()
    assert compilers['.c'][-2:] == ['ziglang', 'cc']
    assert compilers['.cpp'][3:] == ['ziglang', 'c++', '-fignore-exceptions']


def test_a_compiler_that_cannot_be_had_ends_with_the_remedy(messages, monkeypatch, tmp_path):
    monkeypatch.setattr(messages.shutil, 'which', lambda name: None)
    monkeypatch.setattr(messages, 'find_spec', lambda name: None)
    # No index is asked, and no folder has the file
    monkeypatch.setenv('PIP_NO_INDEX', '1')
    monkeypatch.setenv('PIP_FIND_LINKS', str(tmp_path))
    with pytest.raises(SystemExit) as caught:
        messages.find_compilers()
    said = str(caught.value)
    assert said.startswith('messages: this machine has no C++ compiler, and ziglang cannot be')
    assert 'ziglang==' in said
    assert 'sudo apt install g++' in said


def test_headers_of_python_that_are_missing_are_named(messages, tmp_path, monkeypatch):
    monkeypatch.setattr(messages.sysconfig, 'get_path', lambda name: str(tmp_path))
    with pytest.raises(SystemExit, match='lacks the headers of Python; install them'):
        messages.check_headers()


def test_two_builds_at_once_build_once(workspace):
    colcon = workspace / '.venv/bin/colcon'
    colcon.write_text(f'{COLCON}echo built >>calls\nsleep 1\n', 'utf-8')
    (workspace / 'status').write_text('0', 'utf-8')
    both = [subprocess.Popen(['env', workspace / 'tools/build.sh']) for _ in range(2)]
    assert [each.wait(PATIENCE) for each in both] == [0, 0]
    assert (workspace / 'calls').read_text() == 'built\n'
    assert (workspace / 'install/.lta').exists()


def test_a_compiler_that_fails_is_reported_and_changes_nothing(messages, tmp_path):
    for name in ('cc', 'c++'):
        (tmp_path / name).write_text('#!/bin/sh\necho no stdlib.h >&2\nexit 1\n', 'utf-8')
        (tmp_path / name).chmod(0o755)
    installed = messages.SITE / 'tf2_msgs'
    before = installed.stat().st_ino
    words = [sys.executable, ROOT / 'tools/messages.py', ROOT / 'tools/messages/tf2_msgs']
    done = subprocess.run(
        words, env={'PATH': str(tmp_path), 'AMENT_PREFIX_PATH': str(messages.VENV)},
        capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert 'no stdlib.h' in done.stderr
    assert installed.stat().st_ino == before


def test_each_interface_of_lta_msgs_can_be_sent_and_is_in_the_ament_index(messages):
    index = messages.VENV / 'share/ament_index/resource_index'
    assert (index / 'packages/lta_msgs').is_file()
    listed = (index / 'rosidl_interfaces/lta_msgs').read_text('utf-8').split()
    sources = [path for kind in ('msg', 'action') for path in MESSAGES.glob(f'{kind}/*')]
    assert {f'{path.parent.name}/{path.name}' for path in sources} < set(listed)
    assert all((messages.VENV / 'share/lta_msgs' / name).is_file() for name in listed)
    for path in sources:
        made = getattr(importlib.import_module(f'lta_msgs.{path.parent.name}'), path.stem)
        if path.suffix == '.action':
            check_for_type_support(made)  # raises
            made = made.Impl.FeedbackMessage
        assert deserialize_message(serialize_message(made()), made) == made()
