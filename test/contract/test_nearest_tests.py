"""What `make test-fast` chooses: the tests that import what changed, or the nearest to it."""

from importlib import import_module
from pathlib import Path
import subprocess

import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = {
    'src/lta_sim/lta_sim/__init__.py': '',
    'src/lta_sim/lta_sim/drag.py': '',
    'src/lta_sim/lta_sim/air.py': 'from .drag import force\n',
    'src/lta_sim/lta_sim/alone.py': '',
    'test/unit/sim/shapes.py': 'from lta_sim import air\n',
    'test/unit/sim/test_air.py': 'import lta_sim.air\n',
    'test/unit/sim/test_shapes.py': 'from .shapes import ball\n',
    'test/integration/test_drag.py': 'from lta_sim import drag\n',
}


@pytest.fixture
def nearest_tests(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / 'tools'))
    return import_module('nearest_tests')


@pytest.fixture
def tree(tmp_path):
    """A repository on main, in which nothing has changed."""
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    who = ('-c', 'user.name=a', '-c', 'user.email=a@b')
    for words in (('init', '-q', '-b', 'main'), ('add', '.'), (*who, 'commit', '-qm', 'All')):
        subprocess.run(['git', *words], cwd=tmp_path, check=True)
    return tmp_path


def test_what_changed_is_what_differs_from_main(nearest_tests, tree):
    assert nearest_tests.changed(tree) == []
    (tree / 'src/lta_sim/lta_sim/drag.py').write_text('force = 1.0\n')
    (tree / 'src/lta_sim/lta_sim/new.py').write_text('')
    (tree / 'src/lta_sim/lta_sim/air.py').unlink()
    (tree / 'docs.py').write_text('')
    names = {path.name for path in nearest_tests.changed(tree)}
    assert names == {'drag.py', 'new.py'}


@pytest.mark.parametrize(
    ('changed', 'tests'),
    [
        ('src/lta_sim/lta_sim/air.py', {'test_air.py'}),  # imported directly; test_shapes is not
        ('src/lta_sim/lta_sim/drag.py', {'test_air.py'}),  # by way of air.py
        ('src/lta_sim/lta_sim/alone.py', set()),
        ('test/unit/sim/shapes.py', {'test_shapes.py'}),
        ('test/unit/sim/test_air.py', {'test_air.py'}),
        ('test/integration/test_drag.py', set()),
    ],
)
def test_the_nearest_tests_are_those_that_import_it(nearest_tests, tree, changed, tests):
    imports = nearest_tests.read_imports(tree)
    found = nearest_tests.nearest(tree / changed, imports, tree)
    assert {path.name for path in found} == tests
