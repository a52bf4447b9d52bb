"""Quaternions in rows, against scipy."""

from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_exponential,
    quaternion_logarithm,
    quaternion_product,
    rotate_vectors,
    rotation_matrix,
)
import numpy as np
from scipy.spatial.transform import Rotation

RNG = np.random.default_rng(1)
AXIS = np.array([0.6, 0.0, 0.8])
A, B = RNG.normal(size=(2, 50, 3))


def test_operations_are_those_of_scipy() -> None:
    a, b = Rotation.from_rotvec(A), Rotation.from_rotvec(B)
    qa, qb = quaternion_exponential(A), quaternion_exponential(B)
    np.testing.assert_allclose(rotation_matrix(qa), a.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(
        rotation_matrix(quaternion_product(qa, qb)), (a * b).as_matrix(), atol=1e-12
    )
    np.testing.assert_allclose(
        rotate_vectors(quaternion_conjugate(qa), B), a.inv().apply(B), atol=1e-12
    )
    turn = quaternion_logarithm(quaternion_product(quaternion_conjugate(qa), qb))
    np.testing.assert_allclose(turn, (a.inv() * b).as_rotvec(), atol=1e-10)


def test_small_rotations_keep_their_size() -> None:
    tiny = np.array([[1e-9, -2e-9, 3e-9], [0.0, 0.0, 0.0], [1e-5, 0.0, 0.0]])
    np.testing.assert_allclose(
        quaternion_logarithm(quaternion_exponential(tiny)), tiny, rtol=1e-7, atol=1e-16
    )


def test_a_turn_by_pi_keeps_its_axis_and_a_larger_one_gets_the_opposite_axis() -> None:
    np.testing.assert_allclose(quaternion_logarithm(np.array([0.6, 0.0, 0.8, 0.0])), np.pi * AXIS)
    turned = quaternion_logarithm(quaternion_exponential((np.pi + 0.1) * AXIS))
    np.testing.assert_allclose(turned, -(np.pi - 0.1) * AXIS)
