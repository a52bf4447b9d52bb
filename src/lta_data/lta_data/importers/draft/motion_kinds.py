# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Tell by the motion what a vector is, whatever its name says, also in arrays without names.

Rates are the derivative of an attitude, a velocity is that of a place, and an accelerometer feels
gravity. A vector whose name contradicts its motion is read as the motion says. An array without
names is cut into blocks of three, or four where they are a unit quaternion.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations
import re
from typing import Final

from lta_data.importers.protocol import Numbers
from lta_data.interpretation.attitude_readings import AttitudeReading, list_readings
from lta_data.interpretation.column_group import (
    ATTITUDES,
    ColumnGroup,
    Columns,
    has_unit_length,
    is_rotation,
)
from lta_data.interpretation.column_names import (
    ACTUATOR_WORDS,
    COMMAND_WORDS,
    JOYSTICKS,
    KIND_WORDS,
    parse_column_name,
    TURN_WORDS,
)
from lta_data.interpretation.kinematics import (
    body_rates_of,
    differentiate,
    find_gravity_unit,
    fit_scale,
)
import numpy as np
from scipy.spatial.transform import Rotation

DERIVATIVE_SHARE: Final = 0.8  # share of a vector that a derivative explains
UNRELATED: Final = 0.3  # share below which a name is contradicted
MOTION_ROWS: Final = 4000  # rows
MIN_MOTION_ROWS: Final = 50  # rows
# Words for vectors that are neither a place nor derived from one
NO_PLACES: Final = frozenset([
    'mag', 'magnetic', 'magnetometer', 'wind', 'noise', 'gain', 'current', 'voltage', 'temp',
    'param', 'parameter', 'input', 'cmd', 'command', 'control', 'ctrl',
])  # fmt: skip
# Kinds that a motion may give to a group, or take from it
VECTOR_KINDS: Final = ('', 'velocity', 'rates', 'acceleration', 'euler')


def settle_kinds(
    groups: Sequence[ColumnGroup], table: Columns, seconds: Numbers
) -> list[ColumnGroup]:
    """Return the groups with the kinds that their motions show; those without any are left out."""
    placed = find_places(groups)
    settled = [_settle_kind(group, placed, table, seconds) for group in placed]
    return [group for group in settled if group.kind]


def find_places(groups: Sequence[ColumnGroup]) -> list[ColumnGroup]:
    """Return groups in which vectors without a kind that stand for a body are its places."""
    bodies = [one.stem_words - KIND_WORDS['quaternion'] - KIND_WORDS['euler'] - TURN_WORDS
              for one in groups if one.kind in ATTITUDES]  # fmt: skip
    has_place = any(group.kind == 'position' for group in groups)
    placed = []
    for group in groups:
        words = group.stem_words
        named = bool(words) and words in bodies
        alone = not has_place and not bodies and not words & NO_PLACES
        if not group.kind and (named or alone):
            why = 'a body, whose attitude has the same name' if named else 'the only vectors'
            group = group._replace(kind='position', reason=why)
        placed.append(group)
    return placed


def _settle_kind(
    group: ColumnGroup, groups: Sequence[ColumnGroup], table: Columns, seconds: Numbers
) -> ColumnGroup:
    if group.kind not in VECTOR_KINDS or len(group.columns) != 3 or len(seconds) < MIN_MOTION_ROWS:
        return group
    rows = group.stack(table)[:MOTION_ROWS]
    if not np.isfinite(rows).any() or group.role == 'setpoint':
        return group
    at = seconds[:MOTION_ROWS]
    others = [one for one in groups if one is not group and one.role != 'setpoint']
    attitudes = [one for one in others if one.kind in ATTITUDES]
    readings = [
        reading for one in attitudes
        for reading in list_readings(one, one.stack(table)[:MOTION_ROWS]) if not reading.cost
    ]  # fmt: skip
    turning = _explain_by_turning(rows, readings, at)
    if group.kind != 'rates' and turning > DERIVATIVE_SHARE:
        why = f'{100 * turning:.0f} % of it is the derivative of the attitude'
        return group._replace(kind='rates', reason=f'{why}, although it is {group.reason}')
    if group.kind == 'rates' and not group.unit.endswith('/s'):
        if turning < UNRELATED and _are_angles(rows, readings):
            why = 'its columns follow roll, pitch and yaw, and not their derivatives'
            return group._replace(kind='euler', reason=why)
        derived = differentiate(rows, at)
        places = [one.stack(table)[:MOTION_ROWS] for one in others if one.kind == 'position']
        if not attitudes and any(follows_course(rows, place, at) for place in places):
            why = 'its last column follows the course of the vehicle'
            return group._replace(kind='euler', reason=why)
        others_turn = [one for one in others if one.kind in ('rates', '')]
        if not attitudes and any(
            fit_scale(one.stack(table)[:MOTION_ROWS], derived, at).share > DERIVATIVE_SHARE
            for one in others_turn
        ):
            why = f'{", ".join(others_turn[0].columns)} are its derivative'
            return group._replace(kind='euler', reason=why)
    if not group.kind and _turns_by_rates(group, rows, others, table, at):
        why = 'the rates are its derivative, as angles'
        return group._replace(kind='euler', reason=why)
    if group.kind != 'velocity':
        for place in (one for one in others if one.kind == 'position'):
            speed = differentiate(place.stack(table)[:MOTION_ROWS], at)
            moving = _explain_by_moving(rows, speed, readings, at)
            if moving > DERIVATIVE_SHARE:
                why = f'{100 * moving:.0f} % of it is the derivative of {", ".join(place.columns)}'
                return group._replace(kind='velocity', reason=why)
    if not group.kind and feels_gravity(rows):
        return group._replace(kind='acceleration', reason='it feels gravity')
    return group


def _turns_by_rates(
    group: ColumnGroup,
    rows: Numbers,
    others: Sequence[ColumnGroup],
    table: Columns,
    seconds: Numbers,
) -> bool:
    """Return whether a vector is three angles, whose body rates the log has."""
    rates = [one.stack(table)[:MOTION_ROWS] for one in others if one.kind == 'rates']
    readings = list_readings(group._replace(kind='euler'), rows) if rates else ()
    return any(
        explain_changes(one, body_rates_of(reading.turn, seconds), seconds) > DERIVATIVE_SHARE
        for reading in readings
        for one in rates
    )


def _explain_by_turning(
    rows: Numbers, readings: Sequence[AttitudeReading], seconds: Numbers
) -> float:
    """Return the largest share of a vector that the rates of an attitude explain."""
    shares = [0.0]
    for reading in readings:
        derived = body_rates_of(reading.turn, seconds)
        in_world = reading.turn.apply(np.nan_to_num(derived))
        shares += [explain_changes(rows, one, seconds) for one in (derived, in_world)]
    return max(shares)


def _explain_by_moving(
    rows: Numbers, speed: Numbers, readings: Sequence[AttitudeReading], seconds: Numbers
) -> float:
    """Return the largest share of a vector that a velocity explains, in world or body axes."""
    turned = [reading.turn.inv().apply(np.nan_to_num(speed)) for reading in readings]
    return max(explain_changes(rows, one, seconds) for one in (speed, *turned))


def explain_changes(rows: Numbers, derived: Numbers, seconds: Numbers) -> float:
    """Return the share of the changes that is explained: all constant vectors are alike."""
    left, right = (side - np.nanmean(side, axis=0) for side in (rows, derived))
    return fit_scale(left, right, seconds).share


def _are_angles(rows: Numbers, readings: Sequence[AttitudeReading]) -> bool:
    """Return whether three columns are the roll, pitch and yaw of an attitude, but for signs."""
    good = np.isfinite(rows).all(axis=1)
    for reading in readings[:2]:
        angles = np.unwrap(Rotation.as_euler(reading.turn, 'ZYX')[:, ::-1], axis=0)
        pairs = zip(np.unwrap(rows[good], axis=0).T, angles[good].T, strict=True)
        with np.errstate(invalid='ignore', divide='ignore'):
            alike = [abs(np.corrcoef(one, other)[0, 1]) for one, other in pairs]
        if np.nanmin(alike) > np.sqrt(DERIVATIVE_SHARE):
            return True
    return False


def follows_course(rows: Numbers, place: Numbers, seconds: Numbers) -> bool:
    """Return whether the last of three columns is a heading along which a place moves."""
    speed = differentiate(place, seconds)
    fast = np.linalg.norm(speed[:, :2], axis=1)
    moving = np.isfinite(fast) & (fast > 0.5 * np.nanpercentile(fast, 90.0))
    course = np.unwrap(np.arctan2(speed[moving, 1], speed[moving, 0]))
    if not len(course) or np.ptp(course) < 1.0:
        return False
    return any(
        np.std(np.unwrap(scale * rows[moving, 2]) - course) < 0.2 * np.std(course)
        for scale in (1.0, np.pi / 180.0)
    )


def feels_gravity(rows: Numbers) -> bool:
    """Return whether the length of a vector is that of gravity in a usual unit."""
    low, felt, high = np.nanpercentile(np.linalg.norm(rows, axis=1), [10.0, 50.0, 90.0])
    # A direction has length one, without the noise of a sensor
    is_direction = max(abs(low - 1.0), abs(high - 1.0)) < DIRECTION
    return bool(find_gravity_unit(float(felt), 0.1) and high - low < 0.3 * felt) and not (
        is_direction
    )


DIRECTION: Final = 1e-4  # of the length of a vector, by which that of a direction is not one
MIN_STATE_NUMBERS: Final = 6  # numbers of a state vector
ANGLE_SHARE_GAIN: Final = 0.02  # of a share that tells angles from the coordinates of a place
ARRAY_ELEMENT: Final = re.compile(r'(.*?)[\[(_.]?(\d+)[\])]?')
Block = tuple[str, ...]


def find_state_vectors(
    columns: Sequence[str], table: Columns, seconds: Numbers
) -> list[ColumnGroup]:
    """Return the groups of numbered columns without a name whose motion says what they are."""
    arrays = [*_list_arrays(columns)]
    poses = [pose for array in arrays if (pose := _find_pose(array, table))]
    if poses:
        return poses[0]
    blocks = [block for array in arrays for block in _cut(array, table)]
    rows = {block: _stack(block, table) for block in blocks}
    blocks = [block for block in blocks if np.isfinite(rows[block]).all() and np.ptp(rows[block])]
    at, kinds = seconds[:MOTION_ROWS], dict[Block, tuple[str, str]]()
    turns = {block: _read(block, rows[block]) for block in blocks}
    pairs = [(one, other) for one, other in permutations(blocks, 2) if len(other) == 3]
    for turned, rate in pairs:
        _pair_turning(kinds, turned, rate, (rows, turns, at), clearly=True)
    attitudes = [one for one in blocks if len(one) == 4 or kinds.get(one, ('',))[0] == 'euler']
    for place, moved in pairs:
        if len(place) == 3 and kinds.keys().isdisjoint({place, moved}):
            speed = differentiate(rows[place], at)
            turned_speeds = [one.turn.inv().apply(speed) for a in attitudes for one in turns[a]]
            share = max(explain_changes(rows[moved], v, at) for v in (speed, *turned_speeds))
            if share > DERIVATIVE_SHARE:
                kinds[place] = 'position', f'{_name(moved)} are its derivative'
                kinds[moved] = 'velocity', f'the derivative of {_name(place)}'
                break
    for turned, rate in pairs:
        _pair_turning(kinds, turned, rate, (rows, turns, at), clearly=False)
    _add_single(kinds, blocks, rows, at)
    return [_build(block, *kind) for block, kind in kinds.items()]


def _find_pose(array: Sequence[str], table: Columns) -> list[ColumnGroup]:
    """Return attitude and place of three rows of four numbers, as KITTI's poses are written."""
    if len(array) not in (12, 16):
        return []
    turned = tuple(array[4 * row + column] for row in range(3) for column in range(3))
    if not is_rotation(np.stack([table[one] for one in turned], axis=1)):
        return []
    place = tuple(array[3:12:4])
    why = 'the numbers of a pose as a matrix, row by row'
    return [
        ColumnGroup('matrix', '', turned, tuple('012345678'), '', why),
        _build(place, 'position', why),
    ]


def _pair_turning(
    kinds: dict[Block, tuple[str, str]],
    turned: Block,
    rate: Block,
    motion: tuple[Mapping[Block, Numbers], Mapping[Block, list[AttitudeReading]], Numbers],
    *,
    clearly: bool,
) -> None:
    """
    Add an attitude and its body rates to the kinds, if these explain them.

    `motion`: rows, readings as attitudes, and times. `clearly`: more than a place and a velocity
    do, which small angles and their rates are alike.
    """
    rows, turns, seconds = motion
    if not kinds.keys().isdisjoint({turned, rate}):
        return
    share = max(explain_changes(rows[rate], body_rates_of(one.turn, seconds), seconds)
                for one in turns[turned])  # fmt: skip
    plain = 0.0
    if clearly and len(turned) == 3:
        plain = explain_changes(rows[rate], differentiate(rows[turned], seconds), seconds)
    if share > max(
        DERIVATIVE_SHARE, plain + ANGLE_SHARE_GAIN if plain > DERIVATIVE_SHARE else 0.0
    ):
        kinds[turned] = _name_attitude(turned), f'{_name(rate)} are its derivative'
        kinds[rate] = 'rates', f'the derivative of {_name(turned)}'


def _add_single(
    kinds: dict[Block, tuple[str, str]],
    blocks: Sequence[Block],
    rows: Mapping[Block, Numbers],
    seconds: Numbers,
) -> None:
    """Add quaternions, accelerometers, and the angles that follow the course of a place."""
    for block in blocks:
        if len(block) == 4:
            kinds.setdefault(block, ('quaternion', 'four numbers of length one'))
        elif feels_gravity(rows[block]):
            kinds.setdefault(block, ('acceleration', 'it feels gravity'))
    rest = [block for block in blocks if block not in kinds]
    if len(blocks) == 1 and rest:
        kinds[rest[0]] = 'position', 'the only three numbers'
    is_placed = any(kind == 'position' for kind, _ in kinds.values())
    if any(kind in ('euler', 'quaternion') for kind, _ in kinds.values()):
        # Beside an attitude, one more block is the place
        if len(rest) == 1 and not is_placed:
            kinds[rest[0]] = 'position', 'the only numbers beside the attitude'
        return
    for place, turned in permutations(rest, 2):
        if follows_course(rows[turned], rows[place], seconds):
            kinds[place] = 'position', f'{_name(turned)} follow its course'
            kinds[turned] = 'euler', f'its last number follows the course of {_name(place)}'
            return


def _list_arrays(columns: Sequence[str]) -> Iterator[list[str]]:
    """Yield the columns of each array in their order: its name, and numbers without a gap."""
    arrays: dict[str, dict[int, str]] = {}
    for column in columns:
        match = ARRAY_ELEMENT.fullmatch(column)
        words = parse_column_name(column).words
        if match and not words & (ACTUATOR_WORDS | COMMAND_WORDS | JOYSTICKS):
            name = '' if match[1] == 'column' else match[1]
            arrays.setdefault(name, {})[int(match[2])] = column
    for name, array in arrays.items():
        first = min(array)
        is_long = len(array) >= (MIN_STATE_NUMBERS if name else 3)
        if is_long and [*sorted(array)] == [*range(first, first + len(array))]:
            yield [array[index] for index in sorted(array)]


def _cut(array: Sequence[str], table: Columns) -> Iterator[Block]:
    """Yield the blocks of an array."""
    begin = 0
    while begin + 3 <= len(array):
        four = tuple(array[begin : begin + 4])
        size = 4 if len(four) == 4 and has_unit_length(_stack(four, table)) else 3
        yield tuple(array[begin : begin + size])
        begin += size


def _stack(block: Block, table: Columns) -> Numbers:
    rows = np.stack([table[column] for column in block], axis=1)
    return np.asarray(rows, dtype=np.float64)[:MOTION_ROWS]


def _read(block: Block, rows: Numbers) -> list[AttitudeReading]:
    readings = list_readings(_build(block, _name_attitude(block), ''), rows)
    return [one for one in readings if not one.cost]


def _name_attitude(block: Block) -> str:
    return 'quaternion' if len(block) == 4 else 'euler'


def _name(block: Block) -> str:
    return f'{block[0]} to {block[-1]}'


def _build(block: Block, kind: str, reason: str) -> ColumnGroup:
    axes = {'quaternion': ('0', '1', '2', '3'), 'euler': ('roll', 'pitch', 'yaw')}
    return ColumnGroup(kind, '', block, axes.get(kind, ('x', 'y', 'z')), '', reason)
