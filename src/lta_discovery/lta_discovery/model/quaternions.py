# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Provide operations on quaternions (x y z w, in rows) and rotation vectors."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SMALL_ANGLE: Final = 1e-8  # rad; below it a rotation is its own rotation vector


def quaternion_product(a: Array, b: Array) -> Array:
    """Return the Hamilton product of quaternions, shape (..., 4)."""
    ax, ay, az, aw = np.moveaxis(a, -1, 0)
    bx, by, bz, bw = np.moveaxis(b, -1, 0)
    return np.stack(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ],
        axis=-1,
    )


def quaternion_conjugate(q: Array) -> Array:
    """Return the inverse rotations of unit quaternions."""
    back: Array = q * np.array([-1.0, -1.0, -1.0, 1.0])
    return back


def quaternion_exponential(vector: Array) -> Array:
    """Return the quaternions of rotation vectors, shape (..., 3) [rad]."""
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    # Avoids a division by 0; the result is replaced by the limit
    safe = np.where(angle > SMALL_ANGLE, angle, 1.0)
    sine = np.where(angle > SMALL_ANGLE, np.sin(0.5 * angle) / safe, 0.5)
    return np.concatenate([vector * sine, np.cos(0.5 * angle)], axis=-1)


def quaternion_logarithm(q: Array) -> Array:
    """Return the shortest rotation vectors of quaternions [rad]."""
    # q and -q are the same rotation: choose the one with the shorter angle
    q = np.where(q[..., 3:] < 0.0, -q, q)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    safe = np.where(sine > SMALL_ANGLE, sine, 1.0)
    return q[..., :3] * np.where(sine > SMALL_ANGLE, angle / safe, 2.0)


def rotation_matrix(q: Array) -> Array:
    """Return the rotation matrices, shape (..., 3, 3)."""
    eye = np.eye(3)
    return np.stack(
        [rotate_vectors(q, np.broadcast_to(e, (*q.shape[:-1], 3))) for e in eye], axis=-1
    )


def rotate_vectors(q: Array, v: Array) -> Array:
    """Rotate vectors by unit quaternions."""
    axis, scalar = q[..., :3], q[..., 3:]
    # v + 2 s (u x v) + 2 u x (u x v), without building a matrix
    turn = 2.0 * np.cross(axis, v)
    return v + scalar * turn + np.cross(axis, turn)
