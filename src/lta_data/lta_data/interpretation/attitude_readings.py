# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
List the ways to read an attitude: order, direction, sequence, signs, unit.

The draft of an import reads columns in each of them, and the check of a bag the attitude that was
recorded; kinematics decide, see `kinematics`.
"""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final, final, NamedTuple

from lta_config.constants import DEGREES_PER_RADIAN
from lta_data.even_grid import hann_kernel, median_period, smooth_columns
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.column_group import ColumnGroup, find_turn, measure_length
from lta_data.interpretation.column_names import HEADINGS, parse_column_name, WORD_PATTERN
import numpy as np
from scipy.spatial.transform import Rotation

UNCLEAR: Final = (7.0, 40.0)  # a larger heading is unlikely in radians, and is in degrees
DEGREES_BEYOND: Final = (3.3, 1.65)  # a larger roll or pitch is in degrees
STILL_TURN: Final = 1.0  # a vehicle in flight turns by more, in degrees
STILL_TILT: Final = 0.5  # a vehicle in flight tilts by more, in degrees
RARE: Final = 0.1  # of a score, that a rare reading must gain
# Signs of yaw, pitch and roll that are tried after the usual ones
RARE_SENSES: Final = (
    (-1, 1, 1), (-1, -1, 1), (1, 1, -1), (1, -1, -1), (-1, 1, -1), (-1, -1, -1),
)  # fmt: skip
NOTHING_STATED: Final[Mapping[str, str]] = MappingProxyType({})
# Words for axis times angle, as RX, RY and RZ of Vicon
ROTATION_VECTORS: Final = frozenset(['r', 'rotvec', 'rvec', 'helical'])


@final
class AttitudeReading(NamedTuple):
    """One reading: its words, its entry in a mapping, and the attitude from body to world."""

    label: str
    entry: dict[str, Any]
    turn: Rotation
    cost: float = 0.0  # that its score must gain, as it is rare or contradicts the names


def list_readings(
    group: ColumnGroup, numbers: Numbers, stated: Mapping[str, str] = NOTHING_STATED
) -> Iterator[AttitudeReading]:
    """
    Yield the readings of a group, the conventional one first.

    `stated`: what the file states: 'sequence' of the angles about x, y and z, and whether the
    'elements' of a matrix follow each other 'by column'.
    """
    if group.kind == 'quaternion':
        yield from _read_quaternions(group, numbers)
    elif group.kind == 'matrix':
        yield from _read_matrices(group, numbers, stated)
    else:
        sequence = stated.get('sequence', '')
        words = parse_column_name(group.columns[0]).words
        if group.axes == ('x', 'y', 'z') and words & ROTATION_VECTORS and not sequence:
            yield from _read_vectors(group, numbers)
        yield from _read_angles(group, numbers, sequence if len(group.columns) == 3 else '')


def _read_both_ways(
    label: str, entry: dict[str, Any], turn: Rotation, cost: float = 0.0
) -> Iterator[AttitudeReading]:
    """Yield an attitude from body to world, and as its inverse."""
    for direction, one in (('body to world', turn), ('world to body', turn.inv())):
        yield AttitudeReading(f'{label}, {direction}', entry | {'direction': direction}, one, cost)


def _read_quaternions(group: ColumnGroup, numbers: Numbers) -> Iterator[AttitudeReading]:
    columns = dict(zip(group.axes, group.columns, strict=True))
    named, length = 'w' in columns, measure_length(numbers)
    ours = [columns[axis] for axis in 'xyzw'] if named else list(group.columns)
    words = ''.join(group.axes) if named else 'xyzw'
    readings: list[tuple[str, list[str], str, bool]] = [(words, ours, 'xyzw', False)]
    if named:
        # The names in one order, and the numbers in the other
        readings += [
            ('xyzw against the names', [columns[axis] for axis in 'wxyz'], 'xyzw', True),
            ('wxyz against the names', ours, 'wxyz', True),
        ]
    else:
        readings.append(('wxyz', ours, 'wxyz', False))
    for label, listed, order, is_rare in readings:
        indices = [group.columns.index(column) for column in listed]
        rows = numbers[:, indices] if order == 'xyzw' else numbers[:, indices][:, [1, 2, 3, 0]]
        turn = Rotation.from_quat(_fill_rows(rows, [0.0, 0.0, 0.0, 1.0]))
        entry: dict[str, Any] = {'quaternion': listed, 'order': order}
        entry |= {} if length == 1.0 else {'length': length}
        yield from _read_both_ways(f'quaternion {label}', entry, turn, RARE * is_rare)


def _read_matrices(
    group: ColumnGroup, numbers: Numbers, stated: Mapping[str, str]
) -> Iterator[AttitudeReading]:
    rows = _fill_rows(numbers, np.eye(3).ravel().tolist())
    readings = [*_read_both_ways('matrix', {'matrix': list(group.columns)},
                                 Rotation.from_matrix(rows.reshape(-1, 3, 3)))]  # fmt: skip
    by_column = stated.get('elements') == 'by column'
    yield from readings[::-1][:1] if by_column else readings


def _read_vectors(group: ColumnGroup, numbers: Numbers) -> Iterator[AttitudeReading]:
    """Yield the readings as axis times angle, as Vicon writes RX, RY, RZ."""
    vectors = _fill_rows(numbers, [0.0] * 3)
    unit = 'deg' if np.abs(vectors).max() > UNCLEAR[0] or group.unit.startswith('deg') else 'rad'
    turn = Rotation.from_rotvec(vectors, degrees=unit == 'deg')
    entry = {'rotation_vector': list(group.columns), 'unit': unit}
    yield from _read_both_ways(f'rotation vector, {unit}', entry, turn)


def _read_angles(group: ColumnGroup, numbers: Numbers, sequence: str) -> Iterator[AttitudeReading]:
    # A heading alone is the attitude of a level vehicle
    alone = len(group.columns) == 1
    usual = ('Z',) if alone else ('ZYX', 'XYZ')
    orders = [
        (one, (0,) if alone else tuple(map('XYZ'.index, one)))
        for one in ((sequence,) if sequence else usual)
    ]
    angles = _fill_rows(numbers, [0.0] * len(group.columns))
    named = [group.unit.replace('°', 'deg')] if group.unit and not find_turn(angles) else []
    for unit in _list_angle_units(group, angles):
        for direction in ('body to world', 'world to body'):
            for name, order in orders:
                for signs, compass in _list_senses(group, angles, name, direction):
                    listed = [group.columns[index] for index in order]
                    quarter = 90.0 if unit == 'deg' else 0.5 * np.pi
                    offsets = [quarter * compass, 0.0, 0.0][: len(order)]
                    turn = Rotation.from_euler(
                        name, angles[:, order] * signs + offsets, degrees=unit == 'deg'
                    )
                    entry: dict[str, Any] = {
                        'euler': listed, 'sequence': name, 'unit': unit, 'direction': direction,
                    }  # fmt: skip
                    if -1 in signs:
                        entry['signs'] = signs
                    if compass:
                        entry['offsets'] = [float(f'{one:.9g}') for one in offsets]
                    label = f'{name}, {unit}, {direction}{_describe_sense(signs, compass)}'
                    rare = [one.startswith(unit) for one in named] == [False] or (
                        not compass and tuple(signs) in RARE_SENSES
                    )
                    yield AttitudeReading(
                        label, entry, turn if direction == 'body to world' else turn.inv(),
                        RARE * rare,
                    )  # fmt: skip


def _list_senses(
    group: ColumnGroup, angles: Numbers, sequence: str, direction: str
) -> list[tuple[list[int], bool]]:
    """Return the signs that angles can have, and whether the first is a compass heading."""
    inverse = direction == 'world to body'
    if sequence == 'Z':
        senses = [([1], False)]
    elif sequence != 'ZYX':
        return [([1, 1, 1], False)] + ([([1, -1, 1], False)] if sequence == 'XYZ' else [])
    else:
        senses = [([1, 1, 1], False), ([1, -1, 1], False)]
        senses = senses[::-1] if is_crazyflie(group) else senses
        senses += [] if inverse else [(list(signs), False) for signs in RARE_SENSES]
    if not inverse and is_compass(group, angles):
        senses += [([-1, -1, 1][: len(group.columns)], True)]
        senses += [([-1, 1, 1], True)] if len(group.columns) == 3 else []
    return senses


def _describe_sense(signs: list[int], compass: bool) -> str:
    """Return what a label adds on signs of angles."""
    if len(signs) == 1:
        heading = ', heading clockwise from north' if compass else ''
        return f'{heading}, roll and pitch taken as 0'
    words = [', heading clockwise from north' if compass else ', yaw inverted'] * (signs[0] < 0)
    words += [', pitch inverted' * (signs[1] < 0), ', roll inverted' * (signs[2] < 0)]
    return ''.join(words)


def is_compass(group: ColumnGroup, angles: Numbers) -> bool:
    """Return whether the yaw of a group may be a compass heading, by its name and its size."""
    words = frozenset(
        word.lower() for column in group.columns for word in WORD_PATTERN.findall(column)
    )
    return bool(words & HEADINGS) and float(angles[:, -1].min()) >= 0.0


def is_crazyflie(group: ColumnGroup) -> bool:
    """Return whether angles have the names of a Crazyflie, whose pitch is positive nose up."""
    words = group.words
    return group.axes == ('roll', 'pitch', 'yaw') and bool(
        words & {'stabilizer'} or {'state', 'estimate'} <= words
    )


def _list_angle_units(group: ColumnGroup, angles: Numbers) -> tuple[str, ...]:
    """Return the units that angles can have by their turns, their names and sizes."""
    if wrapped := find_turn(angles):
        return (wrapped,)
    if group.unit:
        # A name may be wrong, which only other quantities can show
        return ('deg', 'rad') if group.unit.startswith(('deg', '°')) else ('rad', 'deg')
    sizes = np.percentile(np.abs(angles), 99.0, axis=0)
    spread = np.ptp(np.percentile(angles, [1.0, 99.0], axis=0), axis=0)
    tilted = len(sizes) == 3 and bool((sizes[:2] > DEGREES_BEYOND).any())
    if tilted or sizes[-1] > UNCLEAR[1]:
        return ('deg',)
    still = len(sizes) == 3 and sizes[:2].max() < STILL_TILT and sizes[-1] < DEGREES_BEYOND[0]
    return ('rad',) if still or spread.max() < STILL_TURN else ('rad', 'deg')


def _fill_rows(rows: Numbers, instead: list[float]) -> Numbers:
    """Return rows with the last good one in place of NaN and of zero quaternions."""
    good = np.isfinite(rows).all(axis=1)
    if rows.shape[1] == 4:
        good &= (rows != 0.0).any(axis=1)
    last = np.maximum.accumulate(np.where(good, np.arange(len(rows)), -1))
    filled: Numbers = np.where(last.reshape(-1, 1) >= 0, rows[last], np.asarray(instead))
    return filled


FULL_TURN_RADIANS: Final = 2.0 * np.pi
OFFSETS: Final = 58  # whole turns of degrees in a turn of radians


def measure_turn(turn: Rotation, seconds: Numbers) -> float:
    """Return the largest range of yaw, pitch or roll, smoothed over half a second [rad]."""
    angles = np.unwrap(turn.as_euler('ZYX'), axis=0)
    calm = smooth_columns(angles, hann_kernel(0.5, median_period(seconds)))
    return float(np.max(np.ptp(calm, axis=0)))


def magnify_angles(turn: Rotation) -> Rotation:
    """Return the attitudes whose Euler angles are 57.3 times as large."""
    angles = np.unwrap(turn.as_euler('ZYX'), axis=0)
    return Rotation.from_euler('ZYX', angles * DEGREES_PER_RADIAN)


def shrink_angles(turn: Rotation) -> Numbers:
    """
    Return yaw, pitch and roll that are 1/57.3 of continuous Euler angles, shape (n, 3).

    Angles in degrees that were read as radians turn over many times; of the two sets of angles
    of each attitude, the one next to the extrapolated last one is taken. Yaw lacks a constant.
    """
    base = turn.as_euler('ZYX')
    other = np.stack([base[:, 0] + np.pi, np.pi - base[:, 1], base[:, 2] + np.pi], axis=1)
    sets = np.stack([base, other], axis=1)
    angles = np.empty((len(base), 3))
    angles[0] = base[0]
    pace = np.zeros(3)
    for row in range(1, len(base)):
        expected = angles[row - 1] + pace
        moved = sets[row] - expected
        near = sets[row] - FULL_TURN_RADIANS * np.round(moved / FULL_TURN_RADIANS)
        best = near[int(np.argmin(np.abs(near - expected).sum(axis=1)))]
        pace = best - angles[row - 1]
        angles[row] = best
    return angles / DEGREES_PER_RADIAN
