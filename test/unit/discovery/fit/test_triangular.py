"""Triangular solves of stacks against SciPy one by one, and flights side by side."""

from lta_discovery.fit.triangular import invert_lower, SMALL, solve_lower
from lta_discovery.parallel import map_parallel
import numpy as np
import pytest
from scipy.linalg import solve_triangular


@pytest.mark.parametrize('count', [1, SMALL, SMALL + 1, 5 * SMALL + 3])
def test_stacks_are_solved_as_each_by_itself(count: int) -> None:
    draw = np.random.default_rng(count)
    wide = draw.standard_normal((3, count, 2 * count))
    roots = np.linalg.cholesky(wide @ np.swapaxes(wide, 1, 2))
    right = draw.standard_normal((3, count, 4))
    found, inverses = solve_lower(roots, right), invert_lower(roots)
    for root, sides, answer, inverse in zip(roots, right, found, inverses, strict=True):
        expected = solve_triangular(root, sides, lower=True)
        assert answer == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())
        identity = np.eye(count)
        assert inverse @ root == pytest.approx(identity, abs=1e-9 * np.linalg.cond(root))
        assert np.all(inverse[np.triu_indices(count, 1)] == 0.0)


def test_work_side_by_side_keeps_its_order_and_raises_what_it_raises(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr('os.sched_getaffinity', lambda _pid: {0, 1, 2})
    assert map_parallel(lambda one: one * one, range(7)) == [one * one for one in range(7)]
    with pytest.raises(ZeroDivisionError):
        map_parallel(lambda one: 1 / one, [2, 0, 3])
    monkeypatch.setattr('os.sched_getaffinity', lambda _pid: {0})
    assert map_parallel(str, [1, 2]) == ['1', '2']
