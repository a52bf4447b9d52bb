# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`make campaign mutation`: what is changed, where, and what becomes of a toy."""

import ast
from pathlib import Path

from campaigns import mutation
import pytest

TOY = 'def half(x: float) -> float:\n    """Return half."""\n    return min(x / 2.0, 2.0)\n'
SEEN = 'from toy import half\n\n\ndef test_half():\n    assert half(2.0) == 1.0\n'
MODULE, TEST = Path('src/lta_toy/toy.py'), 'test/unit/toy/test_toy.py'


@pytest.fixture
def root(tmp_path):
    """Return a tree of one module, and one test that sees only half of it."""
    texts = {
        'config/empty.yaml': '',
        'src/lta_toy/setup.py': '',
        str(MODULE): TOY,
        TEST: SEEN,
        'pyproject.toml': '[tool.pytest.ini_options]\nmarkers = ["long: x"]\n',
    }
    for name, text in texts.items():
        (tmp_path / 'root' / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / 'root' / name).write_text(text)
    return tmp_path / 'root'


@pytest.mark.parametrize(
    ('old', 'new', 'fate'),
    [
        ('x / 2.0', 'x * 2.0', (mutation.KILLED, f'{TEST}::test_half')),
        ('2.0)\n', '3.0)\n', (mutation.SURVIVED, '')),
        ('    return', '    while True:\n        pass\n    return', (mutation.ENDLESS, '')),
        ('return min', '__import__("os").abort()\n    return min', (mutation.KILLED, '')),
    ],
)
def test_a_change_is_killed_by_a_test_that_sees_it_or_by_never_ending(
    root, tmp_path, old, new, fate
):
    copy = mutation.Copy(root, tmp_path / 'copy')
    assert copy.try_text(MODULE, TOY.replace(old, new), [TEST], 3, False) == fate
    assert (copy.folder / MODULE).read_text() == TOY  # put back
    assert (root / MODULE).read_text() == TOY  # never touched


def test_every_place_that_decides_something_is_changed_and_no_other():
    source = (
        'Either = int | str\n'
        'def f(x: int = 5) -> str | None:\n'
        '    if x is None:\n'
        "        raise ValueError(f'{1 + 1} is wrong')\n"
        '    while not x < -2:\n'
        '        break\n'
        '    return setting(1.0 + 1.0) and True\n'
        'LARGE = 1000\n'
        '@dataclass(frozen=True)\n'
        'class Pair:\n'
        '    both = [*zip(a, b, strict=True)]\n'
    )
    changed = {
        mutation.replace_node(source, node, new).splitlines()[node.lineno - 1].strip()
        for place in mutation.list_nodes(ast.parse(source))
        for node, new in mutation.list_changes(place)
    }
    assert changed == {
        'def f(x: int = (6)) -> str | None:', 'def f(x: int = (4)) -> str | None:',
        'if (x is not None):', 'if (not (x is None)):',
        'while (x < -2):', 'while (not (not x < -2)):',
        'while not (x <= -2):', 'while not (x >= -2):',
        'while not x < (2):', 'while not x < -(3):', 'while not x < -(1):',
        'continue',
        'return (setting(1.0 + 1.0) or True)', 'return setting(1.0 + 1.0) and (False)',
    }  # fmt: skip


def test_a_sample_is_decided_by_its_seed_and_a_larger_one_begins_with_it(root):
    area = mutation.Area('src/lta_toy', ('toy.py',), 'test/unit/toy')
    three = mutation.draw_mutants(area, 3, 7, root)
    assert three == mutation.draw_mutants(area, 3, 7, root)
    assert all(one.path == MODULE and one.line == 3 and one.text != TOY for one in three)
    assert {one.before for one in three} == {'return min(x / 2.0, 2.0)'}
    larger = mutation.draw_mutants(mutation.AREAS['vlc'], 30, 7)
    assert larger[:10] == mutation.draw_mutants(mutation.AREAS['vlc'], 10, 7)
    assert larger != mutation.draw_mutants(mutation.AREAS['vlc'], 30, 8)


def test_every_area_has_sources_and_the_likeliest_tests_come_first():
    for area in mutation.AREAS.values():
        assert all(list(Path(mutation.ROOT, area.package).glob(one)) for one in area.modules)
        assert all((mutation.ROOT / name).is_file() for name in area.tests)
    path = Path('src/lta_control/lta_control/laws/cascade.py')
    tests = mutation.select_tests(
        path, mutation.AREAS['control'], mutation.read_tree(), mutation.ROOT
    )
    assert tests[0] == 'test/unit/control/test_cascade.py'
    assert len(tests) == len(set(tests)) > 1
