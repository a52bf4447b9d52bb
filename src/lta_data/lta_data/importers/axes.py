# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Convert vectors, attitudes and fixes of any convention to ours, exactly where axes only change.

The numbers of a vector are only permuted and negated. Axial vectors (angular rates, torques) also
get the sign of the determinant if axes are mirrored. An attitude q from the log's body to its
world becomes W q B^-1, which is linear in q: one 4 x 4 matrix, no normalisation. With the same
rotation on both sides it only permutes and negates, too.
"""

from collections.abc import Callable, Sequence
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.schema.import_file import OrientationField
from lta_data.importers.protocol import LogTable, Numbers
import numpy as np
from scipy.spatial.transform import Rotation

WHOLE_NUMBER_TOLERANCE = 1e-12  # tolerance of matrix elements that should be whole numbers


def signed_permutation(axes: Sequence[str] | None) -> Numbers:
    """
    Return the signed permutation matrix from the log's axes to LTA's, shape (3, 3).

    `axes` are LTA's x, y, z in terms of the log's, such as ['x', '-y', '-z']; None for equal axes.
    """
    turned = np.zeros((3, 3))
    for row, axis in enumerate(axes or ('x', 'y', 'z')):
        turned[row, 'xyz'.index(axis[-1])] = -1.0 if axis.startswith('-') else 1.0
    return turned


def convert_to_lta_axes(
    vectors: Numbers, axes: Sequence[str] | None, *, axial: bool = False
) -> Numbers:
    """
    Return vectors in LTA's axes, permuted and negated only.

    `axes` as in `signed_permutation`; `axial` marks angular rates and torques.
    """
    if axes is None:
        return vectors
    signed = signed_permutation(axes)
    # A reflection reverses axial vectors relative to polar ones.
    mirror = round(np.linalg.det(signed)) if axial else 1
    picked = np.argmax(np.abs(signed), axis=1)
    signs = signed[np.arange(3), picked] * mirror
    converted: Numbers = vectors[:, picked] * signs
    return converted


def attitude_matrix(world: Sequence[str] | None, body: Sequence[str] | None) -> Numbers:
    """
    Return the matrix that converts quaternions from the log's axes to LTA's.

    The result has shape (4, 4): for quaternions x, y, z, w as columns. Raise `BadInput` if exactly
    one side is mirrored: that is not a rotation.
    """
    sides = [signed_permutation(world), signed_permutation(body)]
    mirrors = [np.linalg.det(side) for side in sides]
    if mirrors[0] * mirrors[1] < 0.0:
        raise BadInput(
            'The axes "world" and "body" of the mapping have different handedness, so no rotation '
            'relates them; correct a sign in one of them.'
        )
    to_world, to_body = (
        Rotation.from_matrix(side * mirror) for side, mirror in zip(sides, mirrors, strict=True)
    )
    # The map is linear: its columns are the images of the unit quaternions.
    parts = [(to_world * Rotation.from_quat(unit) * to_body.inv()).as_quat() for unit in np.eye(4)]
    product = np.stack(parts, axis=1)
    whole = np.round(product)
    exact: Numbers = np.where(np.abs(product - whole) < WHOLE_NUMBER_TOLERANCE, whole, product)
    return exact


def compute_quaternions(convention: OrientationField, table: LogTable) -> Numbers:
    """
    Return the attitude of each row, from the log's body frame to its world frame.

    Quaternions are divided by `length`, and else not normalised. In the other forms a row with a
    NaN becomes NaN, and a matrix that is not a rotation becomes the nearest rotation.

    The result has shape (n, 4): x, y, z, w.
    """
    numbers = np.stack([table.columns[name] for name in convention.columns], axis=1)
    if convention.quaternion is not None:
        # w x y z to x y z w
        quaternions = numbers if convention.order == 'xyzw' else numbers[:, [1, 2, 3, 0]]
        if convention.length != 1.0:
            quaternions = quaternions / convention.length
    elif convention.euler is not None:
        angles = numbers * np.asarray(convention.signs or [1] * numbers.shape[1], dtype=np.float64)
        angles = angles + np.asarray(convention.offsets or [0.0] * numbers.shape[1])
        quaternions = _finite_quaternions(
            angles,
            lambda rows: Rotation.from_euler(
                convention.sequence, rows, degrees=convention.unit == 'deg'
            ),
        )
    elif convention.rotation_vector is not None:
        quaternions = _finite_quaternions(
            numbers, lambda rows: Rotation.from_rotvec(rows, degrees=convention.unit == 'deg')
        )
    else:
        quaternions = _finite_quaternions(
            numbers, lambda rows: Rotation.from_matrix(rows.reshape(-1, 3, 3))
        )
    if convention.direction == 'world to body':
        # The inverse rotation is the conjugate.
        quaternions = quaternions * np.array([-1.0, -1.0, -1.0, 1.0])
    return quaternions


def convert_attitude(
    attitude: Numbers, world: Sequence[str] | None, body: Sequence[str] | None
) -> Numbers:
    """Convert attitudes between the log's axes to attitudes from FLU to ENU, shape (n, 4)."""
    # Equal axes: keep every bit.
    if world is None and body is None:
        return attitude
    return apply_matrix(attitude, attitude_matrix(world, body))


def apply_matrix(vectors: Numbers, by: Numbers) -> Numbers:
    """Multiply rows by a matrix; entries that are only selected keep every bit."""
    result = np.zeros((len(vectors), len(by)))
    for row, weights in enumerate(by):
        # Not a matrix product: 0 * NaN would spread NaN to all columns
        for column in np.flatnonzero(weights):
            result[:, row] += vectors[:, column] * weights[column]
    return result


def rotate_into_body(vectors: Numbers, attitude: Numbers) -> Numbers:
    """
    Rotate world vectors into the body frame.

    `vectors`, shape (n, 3). `attitude`, shape (n, 4): body to world; NaN or zero gives NaN.
    """
    length = np.linalg.norm(attitude, axis=1)
    # A zero quaternion means unknown, and scipy refuses it
    usable = np.isfinite(length) & (length > 0.0)
    result = np.full((len(vectors), 3), np.nan)
    if usable.any():
        result[usable] = Rotation.from_quat(attitude[usable]).apply(vectors[usable], inverse=True)
    return result


def _finite_quaternions(numbers: Numbers, rotations: Callable[[Numbers], Rotation]) -> Numbers:
    """Return the quaternions of complete rows, NaN for the others."""
    result = np.full((len(numbers), 4), np.nan)
    whole = np.isfinite(numbers).all(axis=1)
    if whole.any():
        result[whole] = rotations(numbers[whole]).as_quat()
    return result


# WGS 84: equatorial radius [m] and first eccentricity squared
EQUATOR: Final = 6_378_137.0
ECCENTRICITY: Final = 6.694_379_990_14e-3


@final
class LocalMap:
    """
    A map about the first fix that it is given.

    Flat: 1 km from its origin it is off by some centimetres.
    """

    def __init__(self) -> None:
        self._origin: Numbers | None = None

    def project(self, fixes: Numbers) -> Numbers:
        """
        Return places east, north and up of the first fix, shape (n, 3) [m].

        `fixes`, shape (n, 3): latitude [deg], longitude [deg], altitude [m]; NaN without a fix, as
        in the result, where latitude and longitude are zero.
        """
        # A receiver without a fix writes zeros
        fixes = np.where((fixes[:, :2] == 0.0).all(axis=1)[:, None], np.nan, fixes)
        good = np.flatnonzero(np.isfinite(fixes).all(axis=1))
        if self._origin is None and len(good):
            self._origin = fixes[good[0]].copy()
        if self._origin is None:
            return np.full(fixes.shape, np.nan)
        north, east, up = (fixes - self._origin).T
        latitude = np.radians(self._origin[0])
        bend = 1.0 - ECCENTRICITY * np.sin(latitude) ** 2
        meridian = EQUATOR * (1.0 - ECCENTRICITY) / bend**1.5
        parallel = EQUATOR / np.sqrt(bend) * np.cos(latitude)
        # Over the date line
        east = (east + 180.0) % 360.0 - 180.0
        return np.stack([np.radians(east) * parallel, np.radians(north) * meridian, up], axis=1)
