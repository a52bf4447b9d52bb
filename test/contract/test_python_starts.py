# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Wherever Python starts Python, no file of the current folder takes the place of a module."""

import ast
from pathlib import Path
import re
import subprocess
import sys

from waiting import PATIENCE

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ('src', 'config', 'tools', 'firmware')
# The name of an interpreter as a shell or make has it, and its first option
START = re.compile(r'(?:python3?|\$python|\$1|\$\(PYTHON\))"? +(-\w+)')
HARMLESS = {'-V'}  # runs no module


def list_files(*patterns):
    """Return the files of the product that match."""
    return sorted(
        path for folder in FOLDERS for kind in patterns for path in (ROOT / folder).rglob(kind)
    )


def find_python_starts(path):
    """Yield the line and the word after `sys.executable` of each command in a Python file."""
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if not isinstance(node, ast.List | ast.Tuple):
            continue
        for first, second in zip(node.elts, node.elts[1:], strict=False):
            if ast.unparse(first) == 'sys.executable' and isinstance(second, ast.Constant):
                yield node.lineno, str(second.value)


def find_shell_starts(path):
    """Yield line and first option of each start of Python in a script or makefile."""
    for number, line in enumerate(path.read_text(encoding='utf-8').splitlines(), 1):
        # Neither a remark nor a sentence for the user
        if line.lstrip().startswith(('#', 'echo ')):
            continue
        yield from ((number, option) for option in START.findall(line))


def is_safe(option):
    """Return whether an option keeps the current folder out, or no module is run."""
    return not option.startswith('-') or option in HARMLESS or set('PI') & set(option)


SHELL = [
    *(ROOT / name for name in ('lta', 'ros2', 'Makefile')),
    *list_files('*.sh', 'Makefile', '*.mk'),
]


def test_every_start_of_python_leaves_the_current_folder_out():
    python = [(path, *start) for path in list_files('*.py') for start in find_python_starts(path)]
    shell = [(path, *start) for path in SHELL for start in find_shell_starts(path)]
    assert len(python) >= 2
    assert len(shell) >= 20
    assert [start for start in python + shell if not is_safe(start[2])] == []


def test_doctor_and_workers_import_nothing_of_the_current_folder(tmp_path):
    """The program is started as a wheel starts it: without -P, but not with -c."""
    for name in ('numpy', 'rclpy', 'lta_graph', 'multiprocessing', 'json'):
        (tmp_path / f'{name}.py').write_text('open("ran", "w"); raise SystemExit(3)')
    program = tmp_path / 'bin' / 'lta'
    program.parent.mkdir()
    program.write_text(
        'from lta_cli.doctor.dds import check_message_exchange\n'
        'from lta_cli.doctor.software import check_dependency_imports\n'
        'from lta_report.workers import WorkerProcess\n'
        'if __name__ == "__main__":\n'
        '    print(check_dependency_imports(), check_message_exchange())\n'
        '    worker = WorkerProcess(abs)\n'
        '    print(worker.work(-3, None))\n'
    )
    done = subprocess.run(
        [sys.executable, program], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE
    )
    assert done.stdout.split('\n')[1] == '3', done.stderr
    assert not (tmp_path / 'ran').exists()
