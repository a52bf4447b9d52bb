"""Steps within bounds, against what a solver of its own finds."""

from hypothesis import given
from hypothesis import strategies as st
from lta_discovery.forecast.levenberg_marquardt import (
    LEAST,
    next_damping,
    solve_bounded_step,
    START,
)
import numpy as np
import pytest
from scipy.optimize import lsq_linear


def test_a_step_inside_is_that_of_newton() -> None:
    """2 x = 4 and x / 2 = 1."""
    free = np.full(2, np.inf)
    found = solve_bounded_step(np.diag([2.0, 0.5]), np.array([4.0, 1.0]), np.zeros(2), -free, free)
    np.testing.assert_allclose(found, [2.0, 2.0])


def test_a_knob_held_at_its_bound_moves_no_other() -> None:
    """Against (2 1; 1 2) x = (-3, 3): -3 and 3 freely, 0 and 1.5 with the first held."""
    inner, right = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-3.0, 3.0])
    found = solve_bounded_step(inner, right, np.zeros(2), np.zeros(2), np.full(2, 9.0))
    np.testing.assert_allclose(found, [0.0, 1.5])
    least = lsq_linear(np.linalg.cholesky(inner).T, np.linalg.solve(
        np.linalg.cholesky(inner), right), (0.0, 9.0))  # fmt: skip
    np.testing.assert_allclose(found, least.x, atol=1e-6)


@given(st.integers(0, 10**6))
def test_a_step_stays_within_and_goes_down(seed: int) -> None:
    """From the bound on, whatever the information."""
    draw = np.random.default_rng(seed)
    root = draw.normal(size=(5, 4))
    inner, right = root.T @ root + 0.1 * np.eye(4), draw.normal(size=4)
    low, high = np.where(draw.random(4) < 0.5, 0.0, -50.0), np.full(4, 50.0)
    found = solve_bounded_step(inner, right, np.zeros(4), low, high)
    assert np.all((found >= low) & (found <= high))
    assert found @ right >= -1e-9


def test_damping_is_eased_and_raised() -> None:
    """Fivefold, and never below the least."""
    assert next_damping(START, False) == pytest.approx(5.0 * START)
    assert next_damping(LEAST, True) == LEAST
    assert next_damping(1.0, True) == 0.2
    assert next_damping(1.0, False) == 5.0
    assert next_damping(4.9e-5, True) == 1e-5


@pytest.mark.parametrize(
    ('at', 'right', 'expected'),
    [
        ((0.0, 5.0), (3.0, 3.0), (3.0, 5.0)),  # the second is pushed beyond its upper bound
        ((0.0, 5.0), (3.0, -3.0), (3.0, 2.0)),  # the second may move down from its upper bound
        ((0.0, 5.0), (-3.0, 3.0), (0.0, 5.0)),  # both are pushed beyond their bounds
        ((1.0, 4.0), (-3.0, 3.0), (0.0, 5.0)),  # both move as far as their bounds
        ((0.0, 0.0), (9.0, -1.0), (5.0, 0.0)),
    ],
)
def test_a_knob_is_held_only_where_it_is_pushed_beyond_its_bound(
    at: tuple[float, float], right: tuple[float, float], expected: tuple[float, float]
) -> None:
    low, high = np.zeros(2), np.full(2, 5.0)
    found = solve_bounded_step(np.eye(2), np.array(right), np.array(at), low, high)
    np.testing.assert_allclose(found, expected)


def test_holding_one_knob_may_push_another_beyond_its_bound() -> None:
    """
    All three knobs stand at their lower bounds, and the free step is (-41/9, 31/9, 2).

    The first is held. Without it the second would step by -1/5, so it is held as well, and only
    the third moves.
    """
    inner = np.array([[5.0, 4.0, 0.0], [4.0, 5.0, 0.0], [0.0, 0.0, 2.0]])
    right, high = np.array([-9.0, -1.0, 4.0]), np.full(3, 9.0)
    found = solve_bounded_step(inner, right, np.zeros(3), np.zeros(3), high)
    np.testing.assert_allclose(found, [0.0, 0.0, 2.0])
