"""Steps of a linearised state agree with the series of the matrix exponential."""

from lta_discovery.replay.variational_equation import (
    apply_state_changes,
    discretize_dynamics,
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
