"""Convert logged attitudes of any convention to quaternions x, y, z, w."""

from collections.abc import Callable, Sequence

from lta_config.schema.import_file import OrientationField
from lta_data.importers.axes import attitude_matrix
from lta_data.importers.log_table import LogTable, Numbers
import numpy as np
from scipy.spatial.transform import Rotation


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
