"""
Tell by the motion what a vector is, whatever its name says.

Rates are the derivative of an attitude, a velocity is that of a place, and an accelerometer feels
gravity. A vector whose name contradicts its motion is read as the motion says.
"""

from collections.abc import Sequence
from typing import Final

from lta_config.constants import STANDARD_GRAVITY
from lta_data.importers.draft.attitude_readings import AttitudeReading, list_readings
from lta_data.importers.draft.column_groups import ATTITUDES, ColumnGroup, Columns
from lta_data.importers.draft.kinematics import body_rates_of, differentiate, fit_scale
from lta_data.importers.draft.name_hints import KINDS, parse_column_name
from lta_data.importers.protocol import Numbers
import numpy as np
from scipy.spatial.transform import Rotation

CLEAR: Final = 0.8  # share of a vector that a derivative explains
UNRELATED: Final = 0.3  # share below which a name is contradicted
LOOKED_AT: Final = 4000  # rows
LEAST: Final = 50  # rows
GRAVITIES: Final = (1.0, STANDARD_GRAVITY, 1e3, 1e3 * STANDARD_GRAVITY)  # g, m/s2, mg, mm/s2
# Words for vectors that are neither a place nor derived from one
NO_PLACES: Final = frozenset([
    'mag', 'magnetic', 'magnetometer', 'wind', 'err', 'error', 'bias', 'cov', 'covariance', 'std',
    'var', 'noise', 'residual', 'gain', 'current', 'voltage', 'temp', 'param', 'parameter',
    'input', 'cmd', 'command', 'control', 'ctrl',
])  # fmt: skip
# Kinds that a motion may give to a group, or take from it
VECTORS: Final = ('', 'velocity', 'rates', 'acceleration', 'euler')


def settle_kinds(
    groups: Sequence[ColumnGroup], table: Columns, seconds: Numbers
) -> list[ColumnGroup]:
    """Return the groups with the kinds that their motions show; those without any are left out."""
    placed = _find_places(groups)
    settled = [_settle_kind(group, placed, table, seconds) for group in placed]
    return [group for group in settled if group.kind]


def _find_places(groups: Sequence[ColumnGroup]) -> list[ColumnGroup]:
    """Return groups in which vectors without a kind that stand for a body are its places."""
    bodies = [_list_words(one) - KINDS['quaternion'] - KINDS['euler']
              for one in groups if one.kind in ATTITUDES]  # fmt: skip
    has_place = any(group.kind == 'position' for group in groups)
    placed = []
    for group in groups:
        words = _list_words(group)
        named = bool(words) and words in bodies
        alone = not has_place and not bodies and not words & NO_PLACES
        if not group.kind and (named or alone):
            why = 'a body, whose attitude has the same name' if named else 'the only vectors'
            group = group._replace(kind='position', reason=why)
        placed.append(group)
    return placed


def _list_words(group: ColumnGroup) -> frozenset[str]:
    return frozenset(word for name in group.columns for word in parse_column_name(name).stem)


def _settle_kind(
    group: ColumnGroup, groups: Sequence[ColumnGroup], table: Columns, seconds: Numbers
) -> ColumnGroup:
    if group.kind not in VECTORS or len(group.columns) != 3 or len(seconds) < LEAST:
        return group
    rows = group.stack(table)[:LOOKED_AT]
    if not np.isfinite(rows).any() or group.role == 'setpoint':
        return group
    at = seconds[:LOOKED_AT]
    others = [one for one in groups if one is not group and one.role != 'setpoint']
    attitudes = [one for one in others if one.kind in ATTITUDES]
    readings = [
        reading for one in attitudes
        for reading in list_readings(one, one.stack(table)[:LOOKED_AT]) if not reading.cost
    ]  # fmt: skip
    turning = _explain_by_turning(rows, readings, at)
    if group.kind != 'rates' and turning > CLEAR:
        why = f'{100 * turning:.0f} % of it is the derivative of the attitude'
        return group._replace(kind='rates', reason=f'{why}, although it is {group.reason}')
    if group.kind == 'rates' and not group.unit.endswith('/s'):
        if turning < UNRELATED and _are_angles(rows, readings):
            why = 'its columns follow roll, pitch and yaw, and not their derivatives'
            return group._replace(kind='euler', reason=why)
        derived = differentiate(rows, at)
        places = [one.stack(table)[:LOOKED_AT] for one in others if one.kind == 'position']
        if not attitudes and any(follows_course(rows, place, at) for place in places):
            why = 'its last column follows the course of the vehicle'
            return group._replace(kind='euler', reason=why)
        others_turn = [one for one in others if one.kind in ('rates', '')]
        if not attitudes and any(
            fit_scale(one.stack(table)[:LOOKED_AT], derived, at).share > CLEAR
            for one in others_turn
        ):
            why = f'{", ".join(others_turn[0].columns)} are its derivative'
            return group._replace(kind='euler', reason=why)
    if not group.kind and _turns_by_rates(group, rows, others, table, at):
        why = 'the rates are its derivative, as angles'
        return group._replace(kind='euler', reason=why)
    if group.kind != 'velocity':
        for place in (one for one in others if one.kind == 'position'):
            speed = differentiate(place.stack(table)[:LOOKED_AT], at)
            moving = _explain_by_moving(rows, speed, readings, at)
            if moving > CLEAR:
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
    rates = [one.stack(table)[:LOOKED_AT] for one in others if one.kind == 'rates']
    readings = list_readings(group._replace(kind='euler'), rows) if rates else ()
    return any(
        explain_changes(one, body_rates_of(reading.turn, seconds), seconds) > CLEAR
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
        if np.nanmin(alike) > np.sqrt(CLEAR):
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
    fits = any(abs(felt / one - 1.0) < 0.1 for one in GRAVITIES)
    return bool(fits and high - low < 0.3 * felt)
