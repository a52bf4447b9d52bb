"""
Convert vectors and attitudes between axis conventions exactly, without rounding.

The numbers of a vector are only permuted and negated. Axial vectors (angular rates, torques) also
get the sign of the determinant if axes are mirrored. An attitude q from the log's body to its
world becomes W q B^-1, which is linear in q: one 4 x 4 matrix, no normalisation. With the same
rotation on both sides it only permutes and negates, too.
"""

from collections.abc import Sequence

from lta_config.errors import BadInput
from lta_data.importers.log_table import Numbers
import numpy as np
from scipy.spatial.transform import Rotation

EXACT = 1e-12  # tolerance of matrix elements that should be whole numbers


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
    exact: Numbers = np.where(np.abs(product - whole) < EXACT, whole, product)
    return exact
