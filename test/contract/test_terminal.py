# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""All text to a terminal passes one place, `lta_graph/terminal_streams.py`."""

import ast
from importlib.metadata import distribution
from importlib.util import find_spec
from pathlib import Path

from lta_config.files import share_folder
import pytest

ROOT = share_folder().parent
SOURCES = sorted(
    path for part in ('src', 'config/lta_config') for path in (ROOT / part).rglob('*.py')
    if 'test' not in path.parts
)  # fmt: skip
# What writes past `sys.stdout` and `sys.stderr`, and where it is fine
DIRECT = {
    'os.write': {
        'src/lta_cli/lta_cli/command.py': 1,  # 'Stopped.', from a signal handler
        'src/lta_report/lta_report/browser.py': 1,  # a pipe to the browser
        'src/lta_emulation/lta_emulation/teensy/emulated_board.py': 1,  # a pseudo terminal
    },
    'sys.__stdout__': {},
    'sys.__stderr__': {},
    'sys.stderr.buffer': {},
    'sys.stdout.buffer': {
        'src/lta_data/lta_data/importers/readers/mat_process.py': 1,  # arrays for its parent
    },
}
STARTS = {'guard_streams', 'run_node', 'run_process'}
PROCESS = 'lta_graph.ros.process:run_process'  # which `run_node` calls


def calls(path):
    return [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call)]


@pytest.mark.parametrize('name', DIRECT)
def test_nothing_writes_past_the_streams(name):
    found = {}
    for path in SOURCES:
        tree = ast.parse(path.read_text())
        uses = sum(
            ast.unparse(node) == name for node in ast.walk(tree) if isinstance(node, ast.Attribute)
        )
        if uses:
            found[path.relative_to(ROOT).as_posix()] = uses
    assert found == DIRECT[name]


def test_only_one_console_prints():
    """Others are quiet, or write into a page."""
    for path in SOURCES:
        for call in calls(path):
            if ast.unparse(call.func).split('.')[-1] == 'Console':
                given = {word.arg for word in call.keywords}
                assert given & {'quiet', 'file'}, path


def test_every_program_guards_its_streams():
    packages = sorted(path.name for path in (ROOT / 'src').iterdir() if path.name[:4] == 'lta_')
    starts = {
        point.value
        for package in packages
        if package != 'lta_msgs'
        for point in distribution(package).entry_points
        if point.group == 'console_scripts'
    }
    assert len(starts) > 10
    for start in starts:
        assert list_calls(start) & STARTS, start
    assert 'guard_streams' in list_calls(PROCESS)


def list_calls(start):
    """Return what the function of an entry point calls."""
    module, _, name = start.partition(':')
    body = ast.parse(Path(find_spec(module).origin).read_text()).body
    (function,) = [one for one in body if isinstance(one, ast.FunctionDef) and one.name == name]
    return {ast.unparse(node.func) for node in ast.walk(function) if isinstance(node, ast.Call)}
