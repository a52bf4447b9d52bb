"""The tools of `make campaign mutation`: what is changed, where, and what becomes of a toy."""

from pathlib import Path
import shutil

from campaigns import mutants, mutation
from campaigns.mutation_trial import Copy, INCOMPETENT, KILLED, STOPPED, SURVIVED, Trial
import pytest

TOY = 'def half(x: float) -> float:\n    """Return half."""\n    return min(x / 2.0, 2.0)\n'
SEEN = 'from toy import half\n\n\ndef test_half():\n    assert half(2.0) == 1.0\n'
MODULE = Path('src/lta_toy/toy.py')


@pytest.fixture
def root(tmp_path):
    """Return a tree of one module, and one test that sees only half of it."""
    texts = {
        'config/empty.yaml': '',
        'src/lta_toy/setup.py': '',
        str(MODULE): TOY,
        'test/unit/toy/test_toy.py': SEEN,
        'pyproject.toml': '[tool.pytest.ini_options]\nmarkers = ["long: x"]\n',
    }
    for name, text in texts.items():
        (tmp_path / 'root' / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / 'root' / name).write_text(text)
    return tmp_path / 'root'


def fate(root, tmp_path, old, new):
    """Return what becomes of the toy with one change."""
    copy = Copy(root, tmp_path / 'copy')
    trial = Trial('toy', ['test/unit/toy/test_toy.py'], 20, False)
    outcome = copy.tried(MODULE, TOY.replace(old, new), trial)
    assert (copy.folder / MODULE).read_text() == TOY  # put back
    assert (root / MODULE).read_text() == TOY  # never touched
    return outcome


def test_what_a_test_sees_is_killed_and_what_none_sees_survives(root, tmp_path):
    outcome = fate(root, tmp_path, 'x / 2.0', 'x * 2.0')
    assert (outcome.fate, outcome.why) == (KILLED, 'test/unit/toy/test_toy.py::test_half')


def test_what_no_test_sees_survives(root, tmp_path):
    assert fate(root, tmp_path, '2.0)\n', '3.0)\n').fate == SURVIVED


def test_what_never_ends_is_stopped_by_the_time_that_it_computes(root, tmp_path):
    copy = Copy(root, tmp_path / 'copy')
    text = TOY.replace('    return', '    while True:\n        pass\n    return')
    outcome = copy.tried(MODULE, text, Trial('toy', ['test/unit/toy/test_toy.py'], 2, False))
    assert outcome.fate == STOPPED


def test_what_crashes_is_killed(root, tmp_path):
    outcome = fate(root, tmp_path, 'return min', '__import__("os").abort()\n    return min')
    assert (outcome.fate, outcome.why) == (KILLED, 'it crashed: SIGABRT')


def test_what_cannot_be_imported_counts_for_nothing(root, tmp_path):
    outcome = fate(root, tmp_path, 'def half', 'half = 1 / 0\ndef half')
    assert (outcome.fate, outcome.why) == (INCOMPETENT, 'ZeroDivisionError: division by zero')


def test_the_copy_holds_what_changes_and_leads_to_the_rest(root, tmp_path):
    copy = Copy(root, tmp_path / 'copy')
    assert not (copy.folder / 'src').is_symlink()
    assert (copy.folder / 'pyproject.toml').is_symlink()


def test_no_place_is_left_where_no_behaviour_is_decided():
    source = (
        'Either = int | str\n'
        'def f(x: int | None) -> str | None:\n'
        '    if x is None:\n'
        "        raise ValueError(f'{1 + 1} is wrong')\n"
        '    return setting(1.0 + 1.0)\n'
        'LARGE = 1000\n'
        '@dataclass(frozen=True, slots=True, eq=False)\n'
        'class Pair:\n'
        '    both = [*zip(a, b, strict=True)]\n'
    )
    places = mutants.undecided(source)

    def left_out(text):
        line = next(k for k, one in enumerate(source.splitlines(), 1) if text in one)
        column = source.splitlines()[line - 1].index(text)
        return any(a <= (line, column) and (line, column + len(text)) <= b for a, b in places)

    out = ('int | str', 'int | None', 'str | None', '1 + 1', '1.0 + 1.0', '1000',
           'frozen=True', 'slots=True', 'strict=True')  # fmt: skip
    assert all(map(left_out, out))
    assert not left_out('is None')
    assert not left_out('eq=False')


def test_a_sample_is_decided_by_its_seed_and_a_larger_one_begins_with_it(root):
    pytest.importorskip('cosmic_ray', reason='pip install -r requirements-mutation.txt')
    area = mutation.Area('src/lta_toy', ('toy.py',), 'test/unit/toy')
    three = mutation.sample(area, 3, 7, root)
    assert three == mutation.sample(area, 3, 7, root) != mutation.sample(area, 3, 8, root)
    five = mutation.sample(area, 5, 7, root)
    assert five[:3] == three
    assert all(one.path == MODULE and one.line == 3 and one.text != TOY for one in five)
    assert {one.before for one in five} == {'return min(x / 2.0, 2.0)'}


def test_the_likeliest_tests_come_first(tmp_path):
    """A tree of one package is enough; reading all of them takes seconds."""
    for name in ('src/lta_control', 'test/unit/control'):
        shutil.copytree(mutation.ROOT / name, tmp_path / name)
    path = Path('src/lta_control/lta_control/pid.py')
    imports = mutation.read_imports(tmp_path)
    tests = mutation.tests_of(path, mutation.AREAS['control'], imports, tmp_path)
    assert tests[0] == 'test/unit/control/test_pid.py'
    assert 'test/unit/control/test_cascade.py' in tests
    assert len(tests) == len(set(tests))


def test_every_area_has_sources_and_tests():
    for area in mutation.AREAS.values():
        assert len(mutation.sources(area)) > 5
        assert all((mutation.ROOT / name).is_file() for name in area.tests)


def test_an_area_counts_as_it_says():
    fates = [KILLED] * 7 + [STOPPED, INCOMPETENT, SURVIVED, SURVIVED]
    rows = [{'fate': fate, 'reason': ''} for fate in fates]
    rows[-1]['reason'] = 'Never negative.'
    # 8 of 9: Wilson's interval from its own formula is 0.56499 to 0.98011.
    line = '| toy | 11 | 8 | 1 | 1 | 1 | 1 | 89 % (57 to 98) |'
    assert mutation.format_area('toy', rows) == line
