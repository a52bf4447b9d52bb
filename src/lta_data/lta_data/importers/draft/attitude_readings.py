"""Try the readings of an attitude: order, direction, sequence, unit; physics or users decide."""

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, final, NamedTuple

from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.column_groups import ColumnGroup, find_turn, measure_length
from lta_data.importers.draft.kinematics import measure_forwardness, MotionEvidence, score_attitude
from lta_data.importers.draft.name_hints import HEADINGS, parse_column_name, WORDS
from lta_data.importers.protocol import Numbers
import numpy as np
from scipy.spatial.transform import Rotation

LONGEST: Final = 20_000  # rows that are looked at
UNCLEAR: Final = (7.0, 40.0)  # a larger heading is unlikely in radians, and is in degrees
UPRIGHT: Final = (3.3, 1.65)  # a larger roll or pitch is in degrees
STILL: Final = 1.0  # a vehicle in flight turns by more, in degrees
CLEAR: Final = 0.05  # advantage of a reading that decides
SAME: Final = 3.0  # readings that differ by less are the same in this flight [deg]
ALIKE: Final = 0.02  # scores of readings that agree equally well
FORWARD: Final = 0.85  # of the way is along one direction of the body of an airship
AHEAD: Final = 0.3  # weight of a motion along x, which tells a compass heading from a yaw
CLEARLY: Final = 0.15  # by which another reading must keep to its direction less
RARE: Final = 0.1  # of a score, that a rare reading must gain
# Signs of yaw, pitch and roll that are tried after the usual ones
RARE_SENSES: Final = (
    (-1, 1, 1), (-1, -1, 1), (1, 1, -1), (1, -1, -1), (-1, 1, -1), (-1, -1, -1),
)  # fmt: skip
NOTHING: Final[Mapping[str, str]] = MappingProxyType({})
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
    group: ColumnGroup, numbers: Numbers, stated: Mapping[str, str] = NOTHING
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
    words = frozenset(word.lower() for column in group.columns for word in WORDS.findall(column))
    return bool(words & HEADINGS) and float(angles[:, -1].min()) >= 0.0


def is_crazyflie(group: ColumnGroup) -> bool:
    """Return whether angles have the names of a Crazyflie, whose pitch is positive nose up."""
    words = frozenset().union(*(parse_column_name(column).words for column in group.columns))
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
    tilted = len(sizes) == 3 and bool((sizes[:2] > UPRIGHT).any())
    if tilted or sizes[-1] > UNCLEAR[1]:
        return ('deg',)
    return ('rad',) if spread.max() < STILL else ('rad', 'deg')


def _fill_rows(rows: Numbers, instead: list[float]) -> Numbers:
    """Return rows without NaN and without zero quaternions."""
    good = np.isfinite(rows).all(axis=1)
    if rows.shape[1] == 4:
        good &= (rows != 0.0).any(axis=1)
    filled: Numbers = np.where(good.reshape(-1, 1), rows, np.asarray(instead))
    return filled


def typical_difference(one: Rotation, other: Rotation) -> float:
    """Return the 90th percentile of the angle between two attitudes. [deg]"""
    return float(np.percentile(np.degrees((one.inv() * other).magnitude()), 90.0))


def choose_reading(
    topic: str,
    group: ColumnGroup,
    numbers: Numbers,
    evidence: MotionEvidence,
    choices: DraftChoices,
) -> AttitudeReading:
    """Return the reading that agrees best with the rest, or the answer of the user."""
    readings = list(list_readings(group, numbers, choices.settled))
    key = f'{topic}.orientation'
    answer = choices.override(key, '')
    labels = {reading.label: reading for reading in readings}
    scored = [score_attitude(reading.turn, evidence) for reading in readings]
    scored = [(score - one.cost, why) for (score, why), one in zip(scored, readings, strict=True)]
    # At a similar score, the conventional reading is the first
    most = max(score for score, _ in scored)
    best = next(i for i, (score, _) in enumerate(scored) if score > most - ALIKE)
    first = readings[best]
    rivals = [
        reading for i, reading in enumerate(readings)
        if scored[best][0] - scored[i][0] < CLEAR and not reading.cost
        and typical_difference(first.turn, reading.turn) > SAME
    ]  # fmt: skip
    if answer:
        first = labels[choices.decide(key, [(label, '') for label in labels], '')]
        why = 'as you decided'
    elif scored[best][1]:
        why = '; '.join(scored[best][1])
        rivals = [rival for rival in rivals if _differs_in_sense(first, rival)]
        if rivals and scored[best][0] > 0.3:
            options = [(one.label, 'agrees equally well') for one in (first, *rivals[:3])]
            first = labels[choices.decide(key, options, f'Several readings fit: {why}.')]
    elif not group.unit and _is_unclear_heading(readings, numbers):
        units = {one.entry['unit']: one.label for one in reversed(readings)}
        options = [(units[unit], '') for unit in ('rad', 'deg')]
        first = labels[choices.decide(key, options, 'Nothing tells the unit of the heading.')]
        why = choices.explain(key)
    else:
        upright = [abs(float(np.mean(r.turn.as_matrix()[:, 2, 2]))) for r in readings]
        level = [i for i, up in enumerate(upright) if up > 0.7] or [0]
        first = readings[level[0]]
        why = 'the convention; no rates, velocity or acceleration to check it with'
        if 'sequence' in choices.settled:
            why = 'the sequence that the file states'
        elif is_crazyflie(group):
            why = "the convention of Crazyflie's firmware, whose pitch is positive nose up"
        elif level[0]:
            why = 'the first order that keeps the vehicle upright'
        ways = [measure_forwardness(reading.turn, evidence) for reading in readings]
        forward = [steady + AHEAD * ahead for steady, ahead in ways]
        best = int(np.argmax(forward))
        if ways[best][0] > FORWARD and forward[best] - forward[level[0]] > CLEARLY:
            first = readings[best]
            why = f'the vehicle moves where it points ({100 * ways[best][0]:.0f} % of the way)'
        elif len(group.columns) == 3 and not _are_named(group):
            senses = [one for one in readings if one.entry.get('signs') == [1, -1, 1]]
            options = [(one.label, '') for one in (first, *senses[:1])]
            question = 'Nothing tells the sign of the pitch; that of a Crazyflie is inverted.'
            first = labels[choices.decide(key, options, question)]
            why = choices.explain(key)
        elif ways[best][0] < FORWARD and is_compass(group, numbers):
            senses = [one for one in (readings[best], *readings) if 'offsets' in one.entry]
            options = [(one.label, '') for one in (first, *senses[:1])]
            question = 'A heading can be a yaw, or clockwise from north.'
            first = labels[choices.decide(key, options, question)]
            why = choices.explain(key)
    choices.add_reason(f'{topic}: orientation', group.columns, first.label, why)
    return first


def _are_named(group: ColumnGroup) -> bool:
    """Return whether three angles have names, and are not numbers of an array."""
    are_numbered = all(column.rstrip('])')[-1:].isdigit() for column in group.columns)
    axes = {parse_column_name(column).axis for column in group.columns}
    return group.kind != 'euler' or not are_numbered or bool(axes & {*group.axes})


def _is_unclear_heading(readings: Sequence[AttitudeReading], numbers: Numbers) -> bool:
    """Return whether a heading can be several turns in radians, or a few degrees."""
    size = float(np.nanpercentile(np.abs(numbers[:, -1]), 99.0))
    units = {reading.entry.get('unit') for reading in readings if 'euler' in reading.entry}
    return len(units) > 1 and size > UNCLEAR[0]


def _differs_in_sense(first: AttitudeReading, rival: AttitudeReading) -> bool:
    """Return whether a rival is no mere other sequence of nearly the same small angles."""
    return 'euler' not in rival.entry or rival.entry['unit'] != first.entry['unit']
