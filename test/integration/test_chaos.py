"""A dozen faults in three whole graphs: what `make chaos` does with each kind, many times."""

from pathlib import Path
import sys

import pytest

FOLDER = Path(__file__).resolve().parents[1] / 'score'
sys.path.append(str(FOLDER))

from campaign import Case, tried_once  # noqa: E402
from chaos_together import TOGETHER  # noqa: E402

LIMIT = 600.0  # s; twenty where nobody else works


@pytest.mark.parametrize(
    'way',
    [pytest.param(way, marks=() if way == 'lockstep' else pytest.mark.long) for way in TOGETHER],
)
def test_each_fault_is_named_and_survived_or_ends_in_order(way):
    outcome = tried_once(Case(way, 0), FOLDER / 'chaos_together.py', LIMIT)
    assert outcome['wrong'] == '', outcome


def test_they_are_a_dozen_kinds():
    kinds = [kind for some in TOGETHER.values() for kind in some]
    assert len(kinds) == len(set(kinds)) == 12
