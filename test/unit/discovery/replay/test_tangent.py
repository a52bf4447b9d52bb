"""Steps of a linearised state agree with the series of the matrix exponential."""

from lta_discovery.replay.linearized_flight import hat_functions
from lta_discovery.replay.variational_equation import (
    apply_state_changes,
    discretize_dynamics,
    propagate_changes,
    WIDTH,
)
import numpy as np
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

RNG = np.random.default_rng(6)
STEP = 0.04


def test_a_step_is_the_exponential_to_fourth_order() -> None:
    """It is exact for a matrix whose fourth power is 0, since all further terms vanish."""
    chain = np.zeros((WIDTH, WIDTH))
    for row, column, value in ((0, 1, 30.0), (1, 2, -20.0), (2, 3, 50.0), (5, 7, 10.0)):
        chain[row, column] = value
    whole = np.zeros((2 * WIDTH, 2 * WIDTH))
    whole[:WIDTH, :WIDTH], whole[:WIDTH, WIDTH:] = chain, np.eye(WIDTH)
    exact = expm(STEP * whole)
    a, b = discretize_dynamics(chain, STEP)
    np.testing.assert_allclose(a, exact[:WIDTH, :WIDTH], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(b, exact[:WIDTH, WIDTH:], rtol=1e-12, atol=1e-14)


def test_the_series_ends_with_its_fourth_order() -> None:
    """If F h = 1, A is 1 + 1 + 1/2 + 1/6 + 1/24, and B is h (1 + 1/2 + 1/6 + 1/24)."""
    a, b = discretize_dynamics(np.eye(WIDTH) / STEP, STEP)
    np.testing.assert_allclose(a, (2.0 + 17.0 / 24.0) * np.eye(WIDTH))
    np.testing.assert_allclose(b, STEP * (1.0 + 17.0 / 24.0) * np.eye(WIDTH))


def test_changes_are_carried_from_step_to_step() -> None:
    """The recursion is x1 = A0 x0 + B0 g, x2 = A1 x1 + B1 g."""
    a, push = RNG.normal(size=(3, 2, WIDTH, WIDTH)), RNG.normal(size=(3, 2, WIDTH, 4))
    out = propagate_changes(a, push)
    assert out.shape == (3, 3, WIDTH, WIDTH + 4)
    for piece in range(3):
        np.testing.assert_array_equal(out[piece, 0], np.eye(WIDTH, WIDTH + 4))
        first = np.hstack([a[piece, 0], push[piece, 0]])
        np.testing.assert_allclose(out[piece, 1], first)
        then = np.hstack([a[piece, 1] @ first[:, :WIDTH],
                          a[piece, 1] @ first[:, WIDTH:] + push[piece, 1]])  # fmt: skip
        np.testing.assert_allclose(out[piece, 2], then)


def test_a_change_adds_to_place_and_speeds_and_rotates_in_the_body_frame() -> None:
    state, change = RNG.normal(size=(2, 13)), RNG.normal(size=(2, 12))
    state[:, 3:7] /= np.linalg.norm(state[:, 3:7], axis=1, keepdims=True)
    after = apply_state_changes(state, change)
    np.testing.assert_allclose(after[:, :3], state[:, :3] + change[:, :3])
    np.testing.assert_allclose(after[:, 7:], state[:, 7:] + change[:, 6:])
    turn = Rotation.from_quat(state[:, 3:7]) * Rotation.from_rotvec(change[:, 3:6])
    np.testing.assert_allclose(
        Rotation.from_quat(after[:, 3:7]).as_matrix(), turn.as_matrix(), atol=1e-12
    )


def test_a_force_between_two_knots_is_interpolated_linearly() -> None:
    """Nine knots over 16 steps are two steps apart; shares are those in the middle of a step."""
    share = hat_functions(16, 9)
    assert share.shape == (16, 9)
    np.testing.assert_allclose(share[0, :3], [0.75, 0.25, 0.0])
    np.testing.assert_allclose(share[5, 1:5], [0.0, 0.25, 0.75, 0.0])
    np.testing.assert_allclose(share[15, 6:], [0.0, 0.25, 0.75])
    np.testing.assert_allclose(share.sum(axis=1), 1.0)
