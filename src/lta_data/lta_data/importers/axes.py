"""
Other people's axes, turned into ours exactly: signs and permutations, never a product that rounds.

A vector's numbers are only picked and negated. Axial vectors (angular rates, torques) keep their
sense when axes are mirrored, so that they get the sign of the mirror as well. An attitude q from
their body to their world becomes W q B^-1, which is linear in q: one 4 x 4 matrix, no
normalisation; with the same turn on both sides it only picks and negates, too.
"""

from collections.abc import Sequence

from lta_config.errors import BadInput
from lta_data.importers.log_table import Numbers
import numpy as np
from scipy.spatial.transform import Rotation

EXACT = 1e-12  # how far from a whole number what should be one can come out of a product


def signed_permutation(axes: Sequence[str] | None) -> Numbers:
    """
    Return the signed permutation that `axes` names.

    Parameters
    ----------
    axes : sequence of 3 str or None
        Our x, y, z in terms of theirs, such as ['x', '-y', '-z']; theirs are ours if None.

    Returns
    -------
    ndarray, shape (3, 3)
        Ours from theirs.

    """
    turned = np.zeros((3, 3))
    for row, axis in enumerate(axes or ('x', 'y', 'z')):
        turned[row, 'xyz'.index(axis[-1])] = -1.0 if axis.startswith('-') else 1.0
    return turned


def convert_vectors(
    vectors: Numbers, axes: Sequence[str] | None, *, axial: bool = False
) -> Numbers:
    """
    Return vectors in our axes, their numbers picked and negated.

    Parameters
    ----------
    vectors : ndarray, shape (n, 3)
        In their axes.
    axes : sequence of 3 str or None
        As `signed_permutation` takes them.
    axial : bool
        Whether a mirror keeps the sense of it: angular rates and torques.

    """
    if axes is None:
        return vectors
    signed = signed_permutation(axes)
    mirror = round(np.linalg.det(signed)) if axial else 1
    picked = np.argmax(np.abs(signed), axis=1)
    signs = signed[np.arange(3), picked] * mirror
    found: Numbers = vectors[:, picked] * signs
    return found


def attitude_matrix(world: Sequence[str] | None, body: Sequence[str] | None) -> Numbers:
    """
    Return what takes a quaternion from their body to their world into one between ours.

    Returns
    -------
    ndarray, shape (4, 4)
        For quaternions x, y, z, w as columns.

    Raises
    ------
    BadInput
        If one side is mirrored and the other is not: that is no rotation.

    """
    sides = [signed_permutation(world), signed_permutation(body)]
    mirrors = [np.linalg.det(side) for side in sides]
    if mirrors[0] * mirrors[1] < 0.0:
        raise BadInput(
            'The axes of world and body are of different handedness, so that no rotation leads '
            'from one to the other; correct a sign in "world" or "body".'
        )
    to_world, to_body = (
        Rotation.from_matrix(side * mirror) for side, mirror in zip(sides, mirrors, strict=True)
    )
    parts = [(to_world * Rotation.from_quat(unit) * to_body.inv()).as_quat() for unit in np.eye(4)]
    product = np.stack(parts, axis=1)
    whole = np.round(product)
    exact: Numbers = np.where(np.abs(product - whole) < EXACT, whole, product)
    return exact
