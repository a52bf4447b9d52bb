# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find which way is up: gravity, the tilt of a rotorcraft, names, heights."""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_config.schema.import_file import FIELD_AXES
from lta_data.importers.axes import signed_permutation
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.column_groups import LENGTH_SCALES
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.attitude_readings import (
    AttitudeReading,
    is_compass,
    is_crazyflie,
    list_readings,
    UNCLEAR,
)
from lta_data.interpretation.column_group import ColumnGroup
from lta_data.interpretation.column_names import parse_column_name
from lta_data.interpretation.kinematics import (
    differentiate,
    fit_scale,
    measure_forwardness,
    MotionEvidence,
    score_attitude,
)
from lta_data.interpretation.vertical import describe_heights, judge_heights, judge_tilt
import numpy as np
from scipy.spatial.transform import Rotation

Axes = str | list[str]
# World and body axes whose x, y or z points up; the opposite where it points down
UPWARDS: Final[tuple[Axes, ...]] = (['y', 'z', 'x'], 'Y_UP', 'ENU')
DOWNWARDS: Final[tuple[Axes, ...]] = (['z', 'y', '-x'], ['x', 'z', '-y'], ['x', '-y', '-z'])
NAMED_BODIES: Final = ('FLU', 'FRD', 'Y_UP')
# Mean cosine to the vertical of the axis of a vehicle in flight, at least
LEVEL_COSINE: Final = 0.9
# Mean cosine of every other pair of axes of a vehicle that turns, at most
TURNING_COSINE: Final = 0.85
LEVEL_TOLERANCE: Final = 1e-12  # of a cosine
PULLS: Final = 0.1  # share of what an accelerometer feels beside gravity that tells its sign
FLATTER: Final = 3.0  # times as far along z as along y moves what can have y up
UP_BY_NAME: Final = {
    'ned': (-1, 'the names north, east, down'), 'latlonalt': (1, 'altitudes count up'),
    'px4': (-1, 'the axes of PX4 are north, east, down'),
}  # fmt: skip
DOWNWARD_CONVENTIONS: Final = ('ned', 'px4')
CONFLICT: Final = 'world.up'


@final
class VerticalAxes(NamedTuple):
    """World and body axes as in a mapping, and why."""

    world: Axes
    body: Axes
    reason: str


@final
class _Vertical(NamedTuple):
    """The axes of world and body that are along the vertical, and whether they point alike."""

    world: int
    body: int
    same: bool


def find_axes(
    evidence: MotionEvidence, turn: Rotation | None, convention: str, choices: DraftChoices
) -> VerticalAxes:
    """
    Return the axes of a log.

    Parameters
    ----------
    evidence : MotionEvidence
        In SI units, in the axes of the log.
    turn : Rotation or None
        From body to world, both of the log.
    convention : str
        Letters in the names of the position's columns, such as 'ned', or 'px4' by the name of
        the table, which heights can contradict.
    choices : DraftChoices
        For the question that remains.

    """
    # A heading alone, without roll and pitch, says nothing of the vertical
    if turn is None or turn.as_matrix()[:, 2, 2].min() > 1.0 - LEVEL_TOLERANCE:
        axes = _find_without_attitude(evidence, convention, choices)
        down = axes.world in ('NED', DOWNWARDS[2])
        # A heading alone is that of a level vehicle, about z of the world
        return axes if turn is None or not down else axes._replace(body='FRD')
    vertical = _find_vertical(evidence, turn)
    floats = choices.vehicle is not None and choices.vehicle.floats
    sign, why = _vote_up(evidence, turn, vertical, '' if vertical.world != 2 else convention,
                         with_tilt=not floats)  # fmt: skip
    usual = choices.settled.get(CONFLICT, '')
    letter = 'xyz'[vertical.world]
    if not sign and (usual or vertical.world != 2):
        sign = 1 if vertical.world != 2 or usual == 'up' else -1
        why = f'z {usual}, as messages of ROS have it' if vertical.world == 2 else (
            f'the {"xyz"[vertical.body]} axis of the body stays along {letter} of the world while '
            'the vehicle turns')  # fmt: skip
    if not sign:
        options = [('up', 'z of the world points up'), ('down', 'z of the world points down')]
        answer = choices.decide(CONFLICT, options, why)
        sign, why = (1 if answer == 'up' else -1), choices.explain(CONFLICT)
    sign = {'up': 1, 'down': -1}.get(choices.override(CONFLICT, ''), sign)
    world = (UPWARDS if sign > 0 else DOWNWARDS)[vertical.world]
    if convention in DOWNWARD_CONVENTIONS and vertical.world == 2 and sign < 0:
        world = 'NED'
    if world == 'Y_UP' and evidence.rates is None and 'rate' not in choices.settled:
        why += '; left-handed axes, as of Unity, would come out mirrored, which nothing here tells'
    body_up = sign if vertical.same else -sign
    body = name_axes(spread_axes((UPWARDS if body_up > 0 else DOWNWARDS)[vertical.body]))
    choices.add_reason('axes: world', [], _format_axes(world), why)
    relation = 'is along' if vertical.same else 'is opposite to'
    choices.add_reason('axes: body', [], _format_axes(body),
                       f'{"xyz"[vertical.body]} of the body {relation} {letter} of the '
                       'world')  # fmt: skip
    return VerticalAxes(world, body, why)


def spread_axes(axes: Axes) -> Numbers:
    """Return the matrix from axes of a log to ours, shape (3, 3)."""
    return signed_permutation(FIELD_AXES[axes] if isinstance(axes, str) else axes)


def name_axes(matrix: Numbers) -> Axes:
    """Return the axes of a body by the matrix from them to ours: a name, or our axes in theirs."""
    listed = tuple(
        ('-' if row.sum() < 0.0 else '') + 'xyz'[int(np.abs(row).argmax())]
        for row in np.asarray(matrix)
    )
    return next((name for name in NAMED_BODIES if FIELD_AXES[name] == listed), [*listed])


def _format_axes(axes: Axes) -> str:
    if isinstance(axes, str):
        return axes
    up = axes[2]
    return f'[{", ".join(axes)}] ({up[-1]} {"down" if up[0] == "-" else "up"})'


def _find_vertical(evidence: MotionEvidence, turn: Rotation) -> _Vertical:
    """
    Return the vertical axes: along what an accelerometer feels, else those that stay together.

    A vehicle in flight keeps one axis of its body along the vertical while it yaws.
    """
    means = turn.as_matrix().mean(axis=0)
    sizes = np.abs(means)
    world, body = (int(one) for one in np.unravel_index(sizes.argmax(), sizes.shape))
    others = np.delete(sizes.ravel(), 3 * world + body)
    if sizes[world, body] < LEVEL_COSINE or others.max() > TURNING_COSINE:
        world = body = 2
    if (pull := _mean_pull(evidence, turn)) is not None:
        world = int(np.abs(pull).argmax())
        body = int(sizes[world].argmax())
    return _Vertical(world, body, bool(means[world, body] > 0.0))


def _mean_pull(evidence: MotionEvidence, turn: Rotation) -> Numbers | None:
    """Return the mean specific force in the world if most of it has one direction [m/s2]."""
    if evidence.acceleration is None:
        return None
    pull: Numbers = turn.apply(np.nan_to_num(evidence.acceleration)).mean(axis=0)
    size = float(np.linalg.norm(pull))
    return pull if size > 3.0 and np.abs(pull).max() > 0.7 * size else None


def _vote_up(
    evidence: MotionEvidence,
    turn: Rotation,
    vertical: _Vertical,
    convention: str,
    *,
    with_tilt: bool,
) -> tuple[int, str]:
    """
    Return whether the vertical axis of the world points up (1) or down (-1), and why.

    0 if nothing says it, or if gravity and the rest contradict each other. `with_tilt`: the tilt
    of the vehicle may say it.
    """
    letter = 'xyz'[vertical.world]
    by_name, named = UP_BY_NAME.get(convention, (0, ''))
    by_height, heights = judge_heights(evidence.position, vertical.world)
    if (pull := _mean_pull(evidence, turn)) is not None:
        felt = float(pull[vertical.world])
        sign = 1 if felt > 0.0 else -1
        words = (
            f'the accelerometer feels {abs(felt):.3g} m/s2 along {"+" if sign > 0 else "-"}'
            f'{letter} at rest, so {letter} points {"up" if sign > 0 else "down"}'
        )
        against = by_name or by_height
        if against in (0, sign) or _judge_pulls(evidence, turn, pull) > 0:
            return sign, words
        return 0, (
            f'{words}; but {named or heights}. The accelerometer, or the position, can have '
            'the other sign.'
        )
    if convention == 'px4' and by_height > 0:
        return 0, f'{named}, but {heights}.'
    if by_name:
        return by_name, named
    by_tilt, share = (0, 0.0)
    if with_tilt and (vertical.world, vertical.body) == (2, 2):
        by_tilt, share = _judge_tilt(evidence, turn, vertical.same)
    if by_tilt and by_height and by_tilt != by_height:
        return 0, f'{heights}, but the vehicle accelerates against its tilt; both readings fit.'
    if by_tilt:
        return by_tilt, (
            f'the vehicle accelerates towards its tilt ({100 * share:.0f} % explained)'
            + (f'; {heights}' if by_height else '')
        )
    if by_height:
        return by_height, heights
    return 0, f'No accelerometer is there, and {describe_heights(evidence.position)}.'


def _judge_pulls(evidence: MotionEvidence, turn: Rotation, pull: Numbers) -> int:
    """
    Return whether an accelerometer feels what the place accelerates by (1), or the opposite (-1).

    0 if nothing of it can be told.
    """
    if evidence.position is None or evidence.acceleration is None:
        return 0
    count = min(len(turn), len(evidence.position))
    seconds = evidence.seconds[:count]
    moved = differentiate(differentiate(evidence.position[:count], seconds), seconds)
    felt = turn[:count].apply(np.nan_to_num(evidence.acceleration[:count])) - pull
    fit = fit_scale(felt, moved - np.nanmean(moved, axis=0), seconds)
    against = fit_scale(-felt, moved - np.nanmean(moved, axis=0), seconds)
    return int(fit.share > PULLS) - int(against.share > PULLS)


def _judge_tilt(evidence: MotionEvidence, turn: Rotation, same: bool) -> tuple[int, float]:
    """Return which way is up by the tilt of the vehicle, and the share that it explains."""
    if evidence.position is None:
        return 0, 0.0
    count = min(len(turn), len(evidence.seconds))
    body_up, fit = judge_tilt(turn[:count], evidence.position[:count], evidence.seconds[:count])
    return (body_up if same else -body_up), fit.cosine**2


def _find_without_attitude(
    evidence: MotionEvidence, convention: str, choices: DraftChoices
) -> VerticalAxes:
    """Return the axes by gravity in the body, and by heights in the world."""
    body: Axes = 'FLU'
    if evidence.acceleration is not None:
        felt = np.nanmedian(evidence.acceleration, axis=0)
        axis = int(np.abs(felt).argmax())
        body = name_axes(spread_axes((UPWARDS if felt[axis] > 0.0 else DOWNWARDS)[axis]))
        why = f'gravity at rest: {felt[axis]:.3g} m/s2 along {"xyz"[axis]}'
        choices.add_reason('axes: body', [], _format_axes(body), why)
    world: Axes = 'ENU'
    if evidence.position is not None:
        sign, heights = judge_heights(evidence.position)
        question = f'No attitude is there, and {describe_heights(evidence.position)}.'
        by_name, why = UP_BY_NAME.get(convention, (0, heights))
        options = [('up', 'z points up'), ('down', 'z points down')]
        if convention == 'px4' and sign > 0:
            sign, question = 0, f'{why}, but {heights}.'
        else:
            sign = by_name or sign
        if convention not in UP_BY_NAME and _can_be_y_up(evidence.position, sign):
            options.append(('y', 'y points up, as in files of Motive'))
            sign = 0
        answer = choices.override(CONFLICT, '')
        if not sign:
            answer = choices.decide(CONFLICT, options, question)
            why = choices.explain(CONFLICT)
        sign = {'up': 1, 'down': -1, 'y': 1}.get(answer, sign)
        world = (UPWARDS if sign > 0 else DOWNWARDS)[1 if answer == 'y' else 2]
        if convention in DOWNWARD_CONVENTIONS and sign < 0:
            world = 'NED'
        choices.add_reason('axes: world', [], _format_axes(world), why)
    return VerticalAxes(world, body, '')


def _can_be_y_up(position: Numbers, sign: int) -> bool:
    """Return whether y of a place can be its height: above a floor, and z is not so or far."""
    spread = np.ptp(np.nanpercentile(position, [2.0, 98.0], axis=0), axis=0)
    above = judge_heights(position, 1)[0] > 0
    return above and (sign <= 0 or bool(spread[2] > FLATTER * spread[1]))


DECIDING_ADVANTAGE: Final = 0.05  # advantage of a reading that decides
SAME_ATTITUDE: Final = 3.0  # readings that differ by less are the same in this flight [deg]
EQUAL_SCORES: Final = 0.02  # scores of readings that agree equally well
# Two readings whose scores differ by more than so many times what the better one leaves
# unexplained (1 - score), and more than noise, do not agree equally well
MORE_UNEXPLAINED: Final = 3.0
MEASURED_SCORE: Final = 1e-3  # of a score, that noise may change
FORWARD_SHARE: Final = 0.85  # of the way is along one direction of the body of an airship
AHEAD_WEIGHT: Final = 0.3  # weight of a motion along x, which tells a compass heading from a yaw
DECIDING_LEAN: Final = 0.15  # more of the acceleration, that another reading must explain
SAME_WAY: Final = 0.008  # of a forwardness, that says nothing of the pitch
UPRIGHT: Final = 0.7  # mean cosine to the vertical of an axis that stays along it
LEANING_ROWS: Final = 5000  # rows that are looked at
FORWARDNESS_GAIN: Final = 0.15  # by which another reading must keep to its direction less


def typical_difference(one: Rotation, other: Rotation) -> float:
    """Return the 90th percentile of the angle between two attitudes [deg]."""
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
    top_score = max(score for score, _ in scored)
    tolerance = min(EQUAL_SCORES, MORE_UNEXPLAINED * (1.0 - top_score) + MEASURED_SCORE)
    best = next(i for i, (score, _) in enumerate(scored) if score >= top_score - tolerance)
    first = readings[best]
    rivals = [
        reading for i, reading in enumerate(readings)
        if scored[best][0] - scored[i][0] < DECIDING_ADVANTAGE and not reading.cost
        and typical_difference(first.turn, reading.turn) > SAME_ATTITUDE
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
        level = [
            i for i, one in enumerate(readings) if _measure_uprightness(one, (2,)) > UPRIGHT
        ] or [0]
        first = readings[level[0]]
        why = 'the convention; no rates, velocity or acceleration to check it with'
        if 'sequence' in choices.settled:
            why = 'the sequence that the file states'
        elif is_crazyflie(group):
            why = "the convention of Crazyflie's firmware, whose pitch is positive nose up"
        elif level[0]:
            why = 'the first order that keeps the vehicle upright'
        floats = choices.vehicle is not None and choices.vehicle.floats
        leans = [0.0 if floats else _measure_lean(one, evidence) for one in readings]
        leaning = int(np.argmax(leans))
        ways = [measure_forwardness(reading.turn, evidence) for reading in readings]
        forward = [steady + AHEAD_WEIGHT * ahead for steady, ahead in ways]
        # Of two senses of the pitch that fit alike, the usual one is the first. x is along the
        # vertical in no convention, but in quaternions that are read in a wrong order
        upright = [_measure_uprightness(one) for one in readings]
        there = [i for i, up in enumerate(upright) if up > UPRIGHT] or [*range(len(readings))]
        # A way overrules names only where others keep the vehicle level, and these do not
        if any(not readings[i].cost for i in level):
            there = [i for i in there if not readings[i].cost] or level
        most = max(forward[i] for i in there)
        best = next(i for i in there if forward[i] >= most - SAME_WAY)
        if leans[leaning] > leans[level[0]] + DECIDING_LEAN:
            first = readings[leaning]
            why = f'the vehicle accelerates towards its tilt ({100 * leans[leaning]:.0f} %)'
        elif leans[leaning] > DECIDING_LEAN:
            why += f'; the vehicle accelerates towards its tilt ({100 * leans[leaning]:.0f} %)'
        elif (
            ways[best][0] > FORWARD_SHARE and forward[best] - forward[level[0]] > FORWARDNESS_GAIN
        ):
            first = readings[best]
            why = f'the vehicle moves where it points ({100 * ways[best][0]:.0f} % of the way)'
        elif len(group.columns) == 3 and not _are_named(group):
            senses = [one for one in readings if one.entry.get('signs') == [1, -1, 1]]
            options = [(one.label, '') for one in (first, *senses[:1])]
            question = 'Nothing tells the sign of the pitch; that of a Crazyflie is inverted.'
            first = labels[choices.decide(key, options, question)]
            why = choices.explain(key)
        elif ways[best][0] < FORWARD_SHARE and is_compass(group, numbers):
            senses = [one for one in (readings[best], *readings) if 'offsets' in one.entry]
            options = [(one.label, '') for one in (first, *senses[:1])]
            question = 'A heading can be a yaw, or clockwise from north.'
            first = labels[choices.decide(key, options, question)]
            why = choices.explain(key)
    choices.add_reason(f'{topic}: orientation', group.columns, first.label, why)
    return first


def _measure_uprightness(reading: AttitudeReading, axes: Sequence[int] = (1, 2)) -> float:
    """Return the cosine by which one of some axes of the body stays along that of the world."""
    means = np.abs(reading.turn.as_matrix().mean(axis=0))
    return max(float(means[k, k]) for k in axes)


def _measure_lean(reading: AttitudeReading, evidence: MotionEvidence) -> float:
    """Return the share of the horizontal acceleration, in any unit, that a tilt explains."""
    if evidence.position is None:
        return 0.0
    rows = slice(0, min(LEANING_ROWS, len(reading.turn), len(evidence.position)))
    fits = (
        judge_tilt(reading.turn[rows], scale * evidence.position[rows], evidence.seconds[rows])
        for scale in LENGTH_SCALES.values()
    )
    return max(fit.cosine**2 - reading.cost if way else 0.0 for way, fit in fits)


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
