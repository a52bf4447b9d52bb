# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Group the columns of a table: vectors, quaternions, Euler angles, and single columns."""

from collections.abc import Iterator, Mapping, Sequence
import re
from typing import Final

from lta_data.importers.draft.generic_commands import find_named_axes
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.column_group import (
    ATTITUDES,
    ColumnGroup,
    Columns,
    find_turn,
    GEODETIC,
    has_unit_length,
    is_rotation,
    measure_length,
)
from lta_data.interpretation.column_names import (
    ACTIONS,
    ACTUATOR_WORDS,
    ANGLE_AXES,
    ANGLE_WORDS,
    ColumnName,
    COMMAND_WORDS,
    HEIGHT_WORDS,
    KIND_WORDS,
    LATITUDES,
    LONGITUDES,
    match_kind,
    match_role,
    needs_translation,
    parse_column_name,
    tells_uncertainty,
    UNIT_WORDS,
)
import numpy as np

TRIPLES: Final = (('x', 'y', 'z'), ('n', 'e', 'd'), ('0', '1', '2'), ('1', '2', '3'))
SIXES: Final = (tuple('012345'), tuple('123456'))  # force and torque in one vector, as tau
TORQUE_LETTERS: Final = frozenset(['t', 'm'])
KIND_OF_UNIT: Final = {
    'N': 'force', 'mN': 'force', 'N m': 'torque', 'mN m': 'torque', 'm/s': 'velocity',
    'rad/s': 'rates', 'deg/s': 'rates', 'm/s2': 'acceleration', 'rad': 'euler', 'deg': 'euler',
    'm': 'position', 'mm': 'position', 'cm': 'position',
}  # fmt: skip
FOURS: Final = (('0', '1', '2', '3'), ('1', '2', '3', '4'))
# An element of a matrix, by one number or by row and column: Rot[0], R11, r_1_1
MATRIX_ELEMENT: Final = re.compile(r'(.*?\D)(\d)(?:[\])(_,.\[]{0,2}(\d))?[\])]?')
ELEMENTS: Final = tuple(
    ' '.join(indices) for first in (0, 1) for indices in (
        [str(first + k) for k in range(9)],
        [f'{first + i}{first + j}' for i in range(3) for j in range(3)],
    )
)  # fmt: skip
# Of a pose, with and without its last row
POSE_ELEMENTS: Final = tuple(
    ' '.join(f'{first + i}{first + j}' for i in range(rows) for j in range(4))
    for first in (0, 1) for rows in (3, 4)
)  # fmt: skip
LEAST_FIX: Final = 0.02  # longitude in radians; less is that of a simulator at zero, in degrees
FULL_TURN: Final = 360.0  # degrees; larger numbers are in 1e-7 degrees, and altitudes in mm
SAME_HEIGHTS: Final = 0.05  # of their spread, that two altitudes may differ by
LENGTH_SCALES: Final = {'m': 1.0, 'cm': 0.01, 'mm': 0.001}
STEADY_LENGTH: Final = 0.3  # of the length of a specific force; a command varies by more
SPEED_WORDS: Final = frozenset(['speed', 'vel', 'velocity'])
SPEED_AXES: Final = (  # words for the speed along x, y and z of the body
    frozenset(['front', 'forward', 'fwd', 'longitudinal', 'surge']),
    frozenset(['side', 'sideways', 'lateral', 'sway']),
    frozenset(['up', 'upward', 'vertical', 'heave']),
)


def group_columns(
    table: Columns, *, has_linear: bool = False
) -> tuple[list[ColumnGroup], list[ColumnName]]:
    """
    Return the groups of a table, and the names of the other columns.

    `has_linear`: the table has a command of surge, sway or heave beside these columns.
    """
    parsed = [parse_column_name(column) for column in table]
    named = [name for name in parsed if not tells_uncertainty(name.words)]
    commands = [*find_named_axes(named, has_linear=has_linear).values()]
    names = [name for name in named if name not in commands]
    stems: dict[tuple[tuple[str, ...], str], dict[str, ColumnName]] = {}
    matrices = [*_group_matrices(names, table)]
    in_matrix = {column for group in matrices for column in group.columns}
    named, names = (
        [name for name in some if name.column not in in_matrix] for some in (named, names)
    )
    letters = [*matrices, *_group_letters(names), *_group_speeds(names)]
    lettered = {column for group in letters for column in group.columns}
    for name in names:
        # The w of u, v, w is no part of a quaternion with x, y, z
        if name.axis and name.column not in lettered:
            stems.setdefault((name.stem, name.unit), {}).setdefault(name.axis, name)
    _complete_angles(stems, table)
    _complete_quaternion(stems, table)
    groups = [*letters, *_group_wrench(names)]
    grouped = {column for group in groups for column in group.columns}
    for (stem, unit), axes in stems.items():
        for part in _split_angles(axes):
            stem_group = _group_stem(stem, unit, part, table)
            if stem_group is not None and not grouped & {*stem_group.columns}:
                groups.append(stem_group)
                grouped |= {*stem_group.columns}
    if any(group.kind == 'acceleration' for group in groups):
        groups = [_read_gyroscope(group) for group in groups]
    rest = [name for name in named if name.column not in grouped]
    # Without a tracker, a quaternion is zero throughout
    groups = [one for one in groups if one.kind != 'quaternion' or one.stack(table).any()]
    groups = [group for group in groups if not _is_marker(group, groups)]
    if (place := _group_height(rest, groups, table)) is not None:
        groups = [*groups, place]
        rest = [name for name in rest if name.column not in place.columns]
    heading = _group_heading(rest, groups)
    if heading is not None:
        groups = [*groups, heading]
        rest = [name for name in rest if name.column not in heading.columns]
    return groups, rest


def _read_gyroscope(group: ColumnGroup) -> ColumnGroup:
    """Return a group beside an accelerometer: gx, gy, gz are its rates."""
    if group.kind or group.stem_words != {'g'}:
        return group
    return group._replace(kind='rates', reason='the name g beside an accelerometer')


def _complete_angles(
    stems: dict[tuple[tuple[str, ...], str], dict[str, ColumnName]], table: Columns
) -> None:
    """Move an angle without a unit to those of its stem with one: roll_deg, pitch_deg, yaw."""
    for (stem, unit), axes in stems.items():
        others = [
            one for (of, named), one in stems.items()
            if of == stem and named and not unit and {*one} & {*ANGLE_WORDS.values()}
        ]  # fmt: skip
        for angle in {*ANGLE_WORDS.values()} & {*axes}:
            wraps = find_turn(table[axes[angle].column]) == 'rad'
            if len(others) == 1 and angle not in others[0] and not wraps:
                others[0][angle] = axes.pop(angle)


def _complete_quaternion(
    stems: dict[tuple[tuple[str, ...], str], dict[str, ColumnName]], table: Columns
) -> None:
    """Move w that stands alone to x, y and z that have length one with it: x_rot, y_rot, w."""
    alone = stems.get(((), ''), {})
    for axes in stems.values():
        if (
            [*alone] == ['w']
            and {*axes} == {*'xyz'}
            and has_unit_length(_stack({**axes, **alone}, 'xyzw', table))
        ):
            axes['w'] = alone.pop('w')


def _is_marker(group: ColumnGroup, groups: Sequence[ColumnGroup]) -> bool:
    """Return whether a position is that of a marker on a body whose pose the log has."""
    words = group.words
    names = [one.words - KIND_WORDS['quaternion'] for one in groups if one.kind == 'quaternion']
    others = sum(one.kind == 'position' for one in groups) > 1
    return group.kind == 'position' and 'marker' in words and others and any(
        body and body < words and 'marker' not in body for body in names
    )  # fmt: skip


def _group_heading(names: list[ColumnName], groups: list[ColumnGroup]) -> ColumnGroup | None:
    """Return the one heading beside a position without any other attitude."""
    kinds = {group.kind for group in groups}
    headings = [
        name
        for name in names
        if name.axis == 'yaw' and not {'rates', 'setpoint'} & {*_describe(name)}
    ]
    if len(headings) != 1 or 'position' not in kinds or kinds & {*ATTITUDES}:
        return None
    (one,) = headings
    why = 'a heading without roll and pitch'
    return ColumnGroup('euler', match_role(one.words), (one.column,), ('yaw',), one.unit, why)


def _group_height(
    names: list[ColumnName], groups: list[ColumnGroup], table: Columns
) -> ColumnGroup | None:
    """Return the place of x and y, east and north or a geodetic fix, beside an altitude."""
    heights = [name for name in names if name.words & HEIGHT_WORDS and not match_role(name.words)]
    if not heights or any(group.kind == 'position' for group in groups):
        return None
    # Above the sea, above the ground: about the first fix, they are the same
    heights = [one for one in heights if _moves_like(table, one, heights[0])]
    fix = [
        [name.column for name in names if name.words & words] for words in (LATITUDES, LONGITUDES)
    ]
    if all(len(columns) == 1 for columns in fix):
        columns = (fix[0][0], fix[1][0], heights[0].column)
        largest = np.nanmax(np.abs([table[column] for column in columns[:2]]), axis=1)
        named = next(name.unit for name in names if name.column == columns[0])
        unit = 'm' if largest.max() < FULL_TURN else 'mm'
        rise = UNIT_WORDS.get(heights[0].unit, ('m', 1.0))[1] if unit == 'm' else 1.0
        # In degrees, that is a place in the Gulf of Guinea
        near_origin = largest[0] < 0.5 * np.pi and LEAST_FIX < largest[1] < np.pi
        if named == 'rad' or (near_origin and not named):
            unit = 'rad'
        why = 'latitude and longitude'
        return ColumnGroup('position', '', columns, GEODETIC, unit, why, rise)
    for pair in (('x', 'y'), ('e', 'n')):
        for first in (name for name in names if name.axis == pair[0]):
            second = [name for name in names if (name.stem, name.axis) == (first.stem, pair[1])]
            if second and match_kind(first.words) in ('position', ''):
                columns = (first.column, second[0].column, heights[0].column)
                why = 'two horizontal columns beside an altitude'
                unit, rise = _relate_units(first.unit, heights[0].unit)
                role = match_role(first.words)
                return ColumnGroup('position', role, columns, (*pair, 'z'), unit, why, rise)
    return None


def _moves_like(table: Columns, one: ColumnName, other: ColumnName) -> bool:
    """Return whether two heights differ by a constant, in one unit."""
    apart = table[one.column] - table[other.column]
    return bool(np.nanstd(apart) <= SAME_HEIGHTS * np.nanstd(table[other.column]))


def _relate_units(level: str, height: str) -> tuple[str, float]:
    """Return the unit of two horizontal columns, and the factor to it of a height in its own."""
    sizes = [
        LENGTH_SCALES[unit] * factor
        for unit, factor in (UNIT_WORDS.get(one, ('m', 1.0)) for one in (height, level))
    ]
    # Beside feet, a unit that is not named is the metre
    is_metric = UNIT_WORDS.get(height, ('m', 1.0))[1] == 1.0
    if not height or (not level and is_metric):
        return level or height, 1.0
    return level or 'm', float(f'{sizes[0] / sizes[1]:.9g}')


def _describe(name: ColumnName) -> tuple[str, str, str]:
    """Return kind and role by the words of a name, and the kind by its unit."""
    unit = UNIT_WORDS.get(name.unit, ('',))[0]
    return match_kind(name.words), match_role(name.words), 'rates' if unit.endswith('/s') else ''


def _split_angles(axes: Mapping[str, ColumnName]) -> list[dict[str, ColumnName]]:
    """Return a place and the three angles beside it apart."""
    angles = {*ANGLE_WORDS.values()}
    if not angles <= {*axes}:
        return [dict(axes)]
    parts = [
        {a: one for a, one in axes.items() if (a in angles) is which} for which in (True, False)
    ]
    return [part for part in parts if part]


def _group_stem(
    stem: tuple[str, ...], unit: str, axes: Mapping[str, ColumnName], table: Columns
) -> ColumnGroup | None:
    """Return the group of the columns with one stem; None if they are single columns."""
    words = frozenset(word for axis in axes.values() for word in axis.words)
    kind, role = match_kind(words), match_role(words)
    label = '_'.join(stem) or 'no stem'
    if {*'wxyz'} <= {*axes}:
        # In the order of the log
        order = tuple(axis for axis in axes if axis in 'wxyz')
        group = _build('quaternion', role, axes, order, unit, f'axes w, x, y, z of {label}')
        rows = group.stack(table)
        if kind == 'quaternion' or has_unit_length(rows / measure_length(rows)):
            return group
    for four in FOURS:
        if {*four} <= {*axes} and len(axes) == 4 and kind in ('quaternion', 'euler', ''):
            group = _build('quaternion', role, axes, four, unit, f'four columns of {label}')
            if has_unit_length(group.stack(table)):
                return group
    # The derivative of an angle: dphi, dang_phi
    derived = any(word[:1] == 'd' and match_kind([word[1:]]) == 'euler' for word in stem)
    if {'roll', 'pitch', 'yaw'} <= {*axes} and not (derived and not kind):
        angles = ('roll', 'pitch', 'yaw')
        turned = KIND_OF_UNIT.get(UNIT_WORDS.get(unit, ('',))[0])
        rates = turned == 'rates' or (turned is None and kind in ('rates', 'velocity'))
        angle_kind = 'rates' if rates else 'euler'
        return _build(angle_kind, role, axes, angles, unit, f'roll, pitch, yaw of {label}')
    for triple in TRIPLES:
        # A heading may stand beside a place
        if {*triple} <= {*axes} and not {*axes} - {*triple} - {*ANGLE_WORDS.values()}:
            nameless = not ''.join(stem).strip('0123456789')
            stated = KIND_OF_UNIT.get(UNIT_WORDS.get(unit, ('',))[0], '')
            angle_kind = kind or stated or ('position' if nameless or role else '')
            if triple[0] in '01' and words <= COMMAND_WORDS:
                return None  # cmd_1, cmd_2, cmd_3
            # a1, a2, a3
            acting = triple[0] in '01' and words <= ACTIONS and not unit
            if acting and not _feels_gravity(_stack(axes, triple, table)):
                return None
            if angle_kind == 'quaternion':
                angle_kind = 'euler'
            # Vicon: RX, RY, RZ, TX, TY, TZ
            if stem == ('r',) and triple[0] == 'x' and _are_angles(axes, table):
                angle_kind = 'euler'
            if angle_kind or triple[0] in 'xn':
                # Without a kind by name, the motion may tell it
                why = f'the name {label}' if stem else 'columns x, y, z'
                return _build(angle_kind, role, axes, triple, unit, why)
    return None


def _stack(axes: Mapping[str, ColumnName], order: Sequence[str], table: Columns) -> Numbers:
    return np.stack([table[axes[axis].column] for axis in order], axis=1)


def _feels_gravity(rows: Numbers) -> bool:
    """Return whether rows are those of an accelerometer: nearly of one length."""
    low, typical, high = np.nanpercentile(np.linalg.norm(rows, axis=1), [10.0, 50.0, 90.0])
    return bool(high - low < STEADY_LENGTH * typical)


def _are_angles(axes: Mapping[str, ColumnName], table: Columns) -> bool:
    """Return whether RX, RY and RZ stand beside a place TX, TY and TZ."""
    names = {column.lower().split(' ')[0] for column in table}
    return {'tx', 'ty', 'tz'} <= names and len(axes) == 3


def _group_matrices(names: Sequence[ColumnName], table: Columns) -> Iterator[ColumnGroup]:
    """Yield nine columns that are the elements of a rotation matrix, row by row in their names."""
    families: dict[str, dict[str, str]] = {}
    for name in names:
        if match := MATRIX_ELEMENT.fullmatch(name.column):
            families.setdefault(match[1], {})[match[2] + (match[3] or '')] = name.column
    for stem, family in families.items():
        whole = ' '.join(sorted(family))
        place: tuple[str, ...] = ()
        if whole in POSE_ELEMENTS:
            # The last column of a pose as a matrix is its place
            rows = sorted({index[0] for index in family})[:3]
            last = max(index[1] for index in family)
            place = tuple(family[row + last] for row in rows)
            family = {one: family[one] for one in family if one[0] in rows and one[1] != last}
        columns = tuple(family[index] for index in sorted(family))
        if not place and whole not in ELEMENTS:
            continue
        if is_rotation(np.stack([table[column] for column in columns], axis=1)):
            words = parse_column_name(columns[0]).words
            why = f'the elements of {stem.strip(" [(_.")} are those of a rotation'
            yield ColumnGroup('matrix', match_role(words), columns, tuple(sorted(family)), '', why)
            if place:
                why = 'the last column of a pose as a matrix'
                yield ColumnGroup('position', match_role(words), place, ('x', 'y', 'z'), '', why)


def _group_letters(names: list[ColumnName]) -> Iterator[ColumnGroup]:
    """Yield the letters of flight mechanics: u, v, w and p, q, r, also behind a name: blimp_u."""
    bodies: dict[tuple[str, ...], dict[str, ColumnName]] = {}
    for name in names:
        words = (*name.stem, name.axis) if name.axis else name.stem
        if words and not {*words[:-1]} & (ACTUATOR_WORDS | COMMAND_WORDS):
            bodies.setdefault(words[:-1], {})[words[-1]] = name
    for body, by_letter in bodies.items():
        for letters, kind in (('uvw', 'velocity'), ('pqr', 'rates')):
            if {*letters} <= {*by_letter} and match_kind(body) in ('', kind):
                columns = tuple(by_letter[letter].column for letter in letters)
                unit, why = by_letter[letters[0]].unit, f'the letters {letters}'
                yield ColumnGroup(kind, match_role(body), columns, ('x', 'y', 'z'), unit, why)


def _group_speeds(names: list[ColumnName]) -> Iterator[ColumnGroup]:
    """Yield the speeds forward, sideways and up: front_speed, side_speed, up_speed."""
    moved = [name for name in names if len(name.words) == 2 and name.words & SPEED_WORDS]
    speeds = [[one for one in moved if one.words & words] for words in SPEED_AXES]
    if all(len(one) == 1 for one in speeds):
        columns = tuple(one.column for (one,) in speeds)
        unit, why = speeds[0][0].unit, 'speeds along the axes of the body'
        yield ColumnGroup('velocity', '', columns, ('x', 'y', 'z'), unit, why)


def _group_wrench(names: Sequence[ColumnName]) -> Iterator[ColumnGroup]:
    """Yield force and torque, also where only some of their components are commanded."""
    # By the words around force and torque: measured and commanded ones differ by them
    parts: dict[frozenset[str], dict[str, dict[str, ColumnName]]] = {}
    letters_of_torque = TORQUE_LETTERS - ({'t'} if needs_translation(names) else set())
    # T_x beside M_z is a thrust
    there = frozenset().union(*(one.words for one in names if one.axis in {*'xyz'}))
    is_thrust = letters_of_torque <= there and not there & KIND_WORDS['force']
    thrusts = letters_of_torque - {'m'} if is_thrust else frozenset[str]()
    letters_of_torque -= thrusts
    for letters in (False, True):
        for name in names:
            rest = name.words - KIND_WORDS['force'] - KIND_WORDS['torque'] - TORQUE_LETTERS
            axis = ANGLE_AXES.get(name.axis, name.axis)
            unit = UNIT_WORDS.get(name.unit, ('',))[0]
            by_unit = KIND_OF_UNIT.get(unit, '')
            if by_unit not in ('', 'force', 'torque'):  # tx_m is a place
                continue
            kind = by_unit or match_kind(name.words - rest)
            if name.words & thrusts:
                kind = 'force'
            # tx beside fx is a torque; alone it is a place
            if letters and name.words & letters_of_torque and 'force' in parts.get(rest, {}):
                kind = 'torque'
            if kind in ('force', 'torque') and axis in ('x', 'y', 'z'):
                parts.setdefault(rest, {}).setdefault(kind, {}).setdefault(axis, name)
    for six in SIXES:
        tau = {name.axis: name for name in names if name.words & KIND_WORDS['torque']}
        if {*tau} == {*six}:
            for kind, indices in (('force', six[:3]), ('torque', six[3:])):
                axes = {axis: tau[i] for axis, i in zip('xyz', indices, strict=True)}
                parts.setdefault(frozenset(), {}).setdefault(kind, axes)
    # What is commanded before what is measured
    order_of_words = sorted(
        parts, key=lambda rest: (match_role(rest) != 'setpoint', -len(parts[rest]))
    )
    for by_kind in (parts[rest] for rest in order_of_words):
        for kind, by_axis in by_kind.items():
            order = tuple(axis for axis in 'xyz' if axis in by_axis)
            first = by_axis[order[0]]
            why = f'the name {"_".join(first.stem)}'
            yield _build(kind, match_role(first.words), by_axis, order, first.unit, why)


def _build(
    kind: str,
    role: str,
    axes: Mapping[str, ColumnName],
    order: tuple[str, ...],
    unit: str,
    reason: str,
) -> ColumnGroup:
    return ColumnGroup(kind, role, tuple(axes[axis].column for axis in order), order, unit, reason)
