"""The count of hops, by hand."""

from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[1] / 'score'


@pytest.fixture
def hops(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    import hops

    return hops


@pytest.mark.parametrize(
    ('calls', 'expected'),
    [
        ([], (0, 0, 0, 0)),
        (['a.py:f'], (1, 1, 0, 0)),
        # b.py and c.py are entered; a.py and b.py are left and entered again
        (['a.py:f', 'b.py:g', 'b.py:h', 'a.py:i', 'c.py:j', 'b.py:k'], (3, 6, 4, 2)),
        (['a.py:f', 'b.py:g', 'c.py:h'], (3, 3, 2, 0)),  # flows forward
    ],
)
def test_hops_of_a_step(hops, calls, expected):
    assert hops.count_hops(calls) == expected
