# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Axes by hand, and attitudes against rotation matrices."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.errors import BadInput
from lta_config.schema.import_file import FIELD_AXES, OrientationField
from lta_data.importers.axes import (
    apply_matrix,
    attitude_matrix,
    compute_quaternions,
    convert_attitude,
    convert_to_lta_axes,
    rotate_into_body,
    signed_permutation,
)
from lta_data.importers.protocol import LogTable
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

NUMBERS = st.floats(-1e6, 1e6, allow_nan=False)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)
UNITS = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)
ROTATIONS = list(FIELD_AXES.values())


def table(**columns):
    """Return a table of some columns."""
    count = len(next(iter(columns.values())))
    times = np.arange(count, dtype=np.int64)
    arrays = {name: np.asarray(values, dtype=float) for name, values in columns.items()}
    return LogTable(times, times, times, arrays)


@pytest.mark.parametrize(
    ('axes', 'theirs', 'expected'),
    [
        ('NED', [1, 0, 0], [0, 1, 0]),  # north
        ('NED', [0, 1, 0], [1, 0, 0]),  # east
        ('NED', [0, 0, 1], [0, 0, -1]),  # down
        ('FRD', [1, 0, 0], [1, 0, 0]),  # forward
        ('FRD', [0, 1, 0], [0, -1, 0]),  # right
        ('FRD', [0, 0, 1], [0, 0, -1]),  # down
        ('NWU', [1, 0, 0], [0, 1, 0]),  # north
        ('NWU', [0, 1, 0], [-1, 0, 0]),  # west
        ('Y_UP', [0, 1, 0], [0, 0, 1]),  # up
        ('OPTICAL', [0, 0, 1], [1, 0, 0]),  # the way a camera looks
        ('OPTICAL', [1, 0, 0], [0, -1, 0]),  # right in the picture
    ],
)
def test_named_axes_turn_known_directions(axes, theirs, expected):
    assert convert_to_lta_axes(np.array([theirs], dtype=float), FIELD_AXES[axes]).tolist() == [
        expected
    ]
    assert np.linalg.det(signed_permutation(FIELD_AXES[axes])) == pytest.approx(1.0)


@given(VECTORS, st.sampled_from(ROTATIONS))
def test_numbers_are_only_picked_and_negated(vector, axes):
    found = convert_to_lta_axes(np.array([vector]), axes)[0]
    assert sorted(np.abs(found)) == sorted(np.abs(vector))
    assert found == pytest.approx(signed_permutation(axes) @ vector)


def test_a_mirror_keeps_the_sense_of_a_turn():
    # Seen in a mirror through the x-z plane, a turn about y keeps its sense; x and z swap theirs.
    found = convert_to_lta_axes(np.array([[1.0, 2.0, 3.0]]), ('x', '-y', 'z'), axial=True)
    assert found.tolist() == [[-1.0, 2.0, -3.0]]


@given(UNITS, st.sampled_from(ROTATIONS), st.sampled_from(ROTATIONS), VECTORS)
def test_attitudes_follow_the_axes_of_both_sides(q, world, body, vector):
    """What a vector of the body is in the world is the same thing before and after."""
    q = np.array([q]) / np.linalg.norm(q)
    theirs = Rotation.from_quat(q).apply(vector)
    found = Rotation.from_quat(convert_attitude(q, world, body)).apply(
        convert_to_lta_axes(np.array([vector]), body)
    )
    assert found == pytest.approx(
        convert_to_lta_axes(theirs, world), abs=1e-8 * (1 + np.abs(vector).max())
    )


@given(UNITS, st.sampled_from(ROTATIONS))
def test_the_same_turn_on_both_sides_changes_no_digit(q, axes):
    found = convert_attitude(np.array([q]), axes, axes)[0]
    assert sorted(np.abs(found[:3])) == sorted(np.abs(q[:3]))
    assert found[3] == q[3]


def test_level_and_north_in_ned_is_a_quarter_turn_to_the_left_in_enu():
    found = convert_attitude(
        np.array([[0.0, 0.0, 0.0, 1.0]]), FIELD_AXES['NED'], FIELD_AXES['FRD']
    )
    assert Rotation.from_quat(found).as_euler('ZYX', degrees=True)[0] == pytest.approx([90, 0, 0])


def test_a_rotation_between_a_mirrored_and_a_true_side_is_refused():
    with pytest.raises(BadInput, match='different handedness'):
        attitude_matrix(('x', '-y', 'z'), None)


@given(UNITS, VECTORS)
def test_a_mirror_on_both_sides_is_consistent(q, vector):
    mirror = ('x', '-y', 'z')
    q = np.array([q]) / np.linalg.norm(q)
    theirs = Rotation.from_quat(q).apply(vector)
    found = Rotation.from_quat(convert_attitude(q, mirror, mirror)).apply(
        convert_to_lta_axes(np.array([vector]), mirror)
    )
    assert found == pytest.approx(
        convert_to_lta_axes(theirs, mirror), abs=1e-8 * (1 + np.abs(vector).max())
    )


def turn(axis, angle):
    """Return the textbook matrix of a turn about an axis."""
    c, s = np.cos(angle), np.sin(angle)
    return {
        'x': np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        'y': np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        'z': np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


@pytest.mark.parametrize('sequence', ['ZYX', 'XYZ', 'zyx', 'xyz', 'ZXZ', 'zxy', 'Z', 'yx'])
def test_angles_by_every_convention(sequence):
    angles = [0.3, -0.7, 1.9][: len(sequence)]
    product = np.eye(3)
    for letter, angle in zip(sequence, angles, strict=True):
        one = turn(letter.lower(), angle)
        product = product @ one if sequence.isupper() else one @ product
    names = ['a', 'b', 'c'][: len(sequence)]
    rows = table(**{name: [np.degrees(angle)] for name, angle in zip(names, angles, strict=True)})
    given_ = OrientationField(euler=names, sequence=sequence, unit='deg')
    assert Rotation.from_quat(compute_quaternions(given_, rows)).as_matrix()[0] == pytest.approx(
        product
    )


def test_signs_order_direction_matrix_and_rotation_vector():
    product = turn('z', 0.4) @ turn('y', 0.2)
    rows = table(
        yaw=[0.4], nose_up=[-0.2], **{f'm{i}': [value] for i, value in enumerate(product.ravel())}
    )
    angles = OrientationField(euler=['yaw', 'nose_up'], sequence='ZY', signs=[1, -1])
    cells = OrientationField(matrix=[f'm{i}' for i in range(9)])
    for form in (angles, cells):
        assert Rotation.from_quat(compute_quaternions(form, rows)).as_matrix()[0] == pytest.approx(
            product
        )
    back = OrientationField(matrix=[f'm{i}' for i in range(9)], direction='world to body')
    assert Rotation.from_quat(compute_quaternions(back, rows)).as_matrix()[0] == pytest.approx(
        product.T
    )
    rows = table(w=[0.9], x=[0.1], y=[0.2], z=[0.3])
    form = OrientationField(quaternion=['w', 'x', 'y', 'z'], order='wxyz')
    assert compute_quaternions(form, rows).tolist() == [[0.1, 0.2, 0.3, 0.9]]  # and not normalised
    form = OrientationField(rotation_vector=['x', 'y', 'z'], unit='deg')
    vector = np.radians([0.1, 0.2, 0.3])
    assert Rotation.from_quat(compute_quaternions(form, rows)).as_rotvec()[0] == pytest.approx(
        vector
    )


def test_what_is_not_whole_is_nan_and_nothing_else():
    rows = table(a=[0.1, np.nan, 0.1], b=[0.0, 0.0, 0.0], c=[0.0, 0.0, 0.0])
    found = compute_quaternions(OrientationField(euler=['a', 'b', 'c']), rows)
    assert np.isnan(found).all(axis=1).tolist() == [False, True, False]
    still = rotate_into_body(np.ones((2, 3)), np.array([[0.0, 0, 0, 0], [0, 0, 0, 1]]))
    assert np.isnan(still).all(axis=1).tolist() == [True, False]
    assert apply_matrix(
        np.zeros((1, 4)), attitude_matrix(FIELD_AXES['NED'], FIELD_AXES['FRD'])
    ).tolist() == [[0] * 4]
