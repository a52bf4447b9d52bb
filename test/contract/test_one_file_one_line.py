# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Adding one of a kind is one file and one line: done in a copy, from what the tutorial shows."""

import os
import shutil
import subprocess
import sys

from doc_blocks import ROOT
from followed_pages import steps, Written
import pytest

STRATEGY = """
from lta_control.strategies.protocol import NavigationStrategy, SteeringCommand


def start(heading):
    return (heading,)


def steer(settings, memory, sight):
    return SteeringCommand(memory[0], settings.speed, False), memory


STRAIGHT_STRATEGY = NavigationStrategy('straight', start, steer)
"""
VERB = """
from lta_analysis.console import plain_console


def greet(name: str = 'lamp') -> None:
    \"\"\"Say hello.\"\"\"
    plain_console().print(f'hello, {name}')
"""
SECOND = """
from types import SimpleNamespace

from lta_model.effects.protocol import VehicleMotion
from lta_model.effects.surfaces import tether as rope
import numpy as np
from oracle.parameters import Given
from scipy.spatial.transform import Rotation
from second import tether

turn, nothing = Rotation.from_euler('xyz', (0.3, -0.4, 2.0)).as_matrix(), (0.0, 0.0, 0.0)
for height in (-1.0, 0.5, 9.0):
    scene = SimpleNamespace(position=np.array([1.0, 2.0, height]), up=turn[2])
    told, _ = tether(Given({'line': 0.03, 'length': 2.0}), None, scene, None)
    motion = VehicleMotion((1.0, 2.0, height), tuple(turn.ravel()), *3 * (nothing,), (), (), ())
    wrench = rope((0.03, 2.0), (), motion, ())
    assert np.allclose(wrench, told, rtol=1e-12, atol=0.0), height
"""
PAGE = """
from tools.reference.effects import render_page

print(render_page())
"""
GREET = "        'greet': Verb('greet', 'greet'),"


def with_copy(tmp_path, package):
    """Copy a package, and return its folder in the copy."""
    source = ROOT / 'src' / package / package
    ignored = shutil.ignore_patterns('__pycache__')
    return shutil.copytree(source, tmp_path / package, ignore=ignored)


def with_line(path, after, line):
    """Put one line into a file below another."""
    text = path.read_text(encoding='utf-8')
    assert text.count(after) == 1
    path.write_text(text.replace(after, f'{after}\n{line.rstrip()}'), encoding='utf-8')


def python(tmp_path, *arguments, **more):
    """Run Python on the copy in place of the package, and return what it said."""
    path = os.pathsep.join([str(tmp_path), *(entry for entry in sys.path if entry)])
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=tmp_path,
        env={**os.environ, 'PYTHONPATH': path, **more},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert done.returncode == 0, done.stdout
    return done.stdout


@pytest.fixture
def titled():
    """
    What the tutorial of an effect writes, by the file and whether above or below a line.

    Under another name: who follows the tutorial has its effect, and runs this test.
    """
    todo = [step for step in steps('docs/tutorials/your_effect.md') if isinstance(step, Written)]
    return {
        (step.path, step.where): step.text.replace('guide_rope', 'tether').replace(
            'GUIDE_ROPE', 'TETHER'
        )
        for step in todo
    }


@pytest.mark.parametrize('plain', ['1', pytest.param('0', marks=pytest.mark.long)])
def test_an_effect_with_the_test_of_its_tutorial(tmp_path, titled, plain):
    """As Python, and compiled, which takes the time of all effects together."""
    more = {'NUMBA_DISABLE_JIT': plain}
    folder = with_copy(tmp_path, 'lta_model') / 'effects'
    source = 'src/lta_model/lta_model/effects'
    surfaces, before = folder / 'surfaces.py', 'NO_FLOOR = '
    text, rope = surfaces.read_text(encoding='utf-8'), titled[f'{source}/surfaces.py', 'above']
    assert text.count(f'\n{before}') == 1
    surfaces.write_text(text.replace(f'\n{before}', f'\n{rope}{before}'), encoding='utf-8')
    line = titled[f'{source}/__init__.py', 'below']
    with_line(folder / '__init__.py', '    surfaces.FLOOR_CONTACT,', line)
    its_test = tmp_path / 'test_tether.py'
    its_test.write_text(titled['test/unit/sim/test_guide_rope.py', ''])
    once = ('-m', 'pytest', '-q', '-p', 'no:cacheprovider')
    assert '3 passed' in python(tmp_path, *once, its_test, **more)
    shutil.copytree(ROOT / 'test/property', tmp_path / 'property')
    words = ('-n', '0', '--import-mode=importlib', 'property', '-k', 'tether')
    laws = python(tmp_path, *once, *words, **more)
    assert ' passed' in laws
    shutil.copytree(ROOT / 'test/unit/sim/oracle', tmp_path / 'oracle')
    given = 'from oracle.parameters import at_centre, NONE\n\n\n'
    (tmp_path / 'second.py').write_text(given + titled['test/unit/sim/oracle/lift.py', 'above'])
    said = python(tmp_path, '-c', SECOND + PAGE)
    assert '| `tether` | Weight of a rope that hangs to the floor' in said


def test_a_strategy(tmp_path):
    folder = with_copy(tmp_path, 'lta_control') / 'strategies'
    (folder / 'straight.py').write_text(STRATEGY)
    with_line(folder / '__init__.py', "    'homing',", "    'straight',")
    said = python(
        tmp_path,
        '-c',
        'from lta_control.strategies import find_navigation_strategy as find; '
        'print(find("straight"))',
    )
    assert "name='straight'" in said


def test_a_verb(tmp_path):
    folder = with_copy(tmp_path, 'lta_cli')
    (folder / 'verbs/greet.py').write_text(VERB)
    with_line(folder / 'app.py', "        'doctor': Verb('doctor', 'doctor'),", GREET)
    call = (
        'import sys; sys.argv = ["lta", "greet"]; '
        'from lta_cli.app import run_command_line; run_command_line()'
    )
    assert python(tmp_path, '-c', call) == 'hello, lamp\n'


def test_a_vehicle_is_a_file_and_no_line(tmp_path):
    share = tmp_path / 'config'
    shutil.copytree(ROOT / 'config', share, ignore=shutil.ignore_patterns('__pycache__'))
    text = (share / 'vehicles/gtmab.yaml').read_text(encoding='utf-8')
    (share / 'vehicles/mine.yaml').write_text(text.replace('name: gtmab', 'name: mine', 1))
    said = python(
        tmp_path,
        '-c',
        f'import sys; sys.path.insert(0, "{share}")\n'
        'from lta_config.files import list_shipped_names\n'
        'from lta_config.schema.vehicle_file import load_vehicle_file\n'
        'print(list_shipped_names("vehicles"), load_vehicle_file("mine").name)',
    )
    assert "'mine'" in said
    assert said.split()[-1] == 'mine'
