# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The packages under ament_lint (0.17.1), called as docs/workspace.md says.

Without a folder of checkouts (ros_checkouts.py) nothing is run.
"""

from pathlib import Path
import re
import shutil
import subprocess
import venv

import pytest

from .command import ROOT
from .ros_checkouts import CHECKOUTS, WITHOUT

LINTERS = ('ament_copyright', 'ament_flake8', 'ament_pep257')
OF_UBUNTU = (  # 24.04
    'flake8==7.0.0', 'flake8-builtins==2.1.0', 'flake8-comprehensions==3.14.0',
    'flake8-docstrings==1.6.0', 'flake8-import-order==0.18.2', 'flake8-quotes==3.4.0',
    'pydocstyle==6.3.0', 'setuptools<80', 'wheel',
)  # fmt: skip
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(
        not (Path(CHECKOUTS) / 'ament_lint').is_dir(), reason=f'{WITHOUT}, or none of ament_lint'
    ),
]


@pytest.fixture(scope='module')
def programs(tmp_path_factory) -> Path:
    """Return the folder of the linters, in an environment of their own."""
    folder = tmp_path_factory.mktemp('lint')
    venv.create(folder / 'env', with_pip=True)
    pip = [folder / 'env/bin/pip', 'install', '--quiet', '--disable-pip-version-check']
    subprocess.run([*pip, *OF_UBUNTU], check=True)
    for name in LINTERS:
        # setuptools builds where the source is: in a copy, so that the checkout stays as it is
        source = shutil.copytree(Path(CHECKOUTS) / 'ament_lint' / name, folder / name)
        subprocess.run([*pip, '--no-deps', '--no-build-isolation', source], check=True)
    return folder / 'env/bin'


def test_the_commands_of_the_page_find_nothing(programs):
    page = (ROOT / 'docs/workspace.md').read_text(encoding='utf-8')
    commands = [line.split() for line in re.findall(r'^ament_.*$', page, re.MULTILINE)]
    assert sorted(words[0] for words in commands) == list(LINTERS)
    for program, *words in commands:
        done = subprocess.run(
            [programs / program, *words], cwd=ROOT, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
        assert 'No problems found' in done.stdout
