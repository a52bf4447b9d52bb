# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draft the motion of one table: position, attitude, velocity, rates and inertial sensor."""

from collections.abc import Iterator, Mapping
from typing import Any, Final, final, NamedTuple

from lta_data.data_quality import limits
from lta_data.even_grid import sort_samples
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.vector_drafts import (
    draft_acceleration,
    draft_position,
    draft_rates,
    draft_velocity,
    EAST_NORTH_DOWN,
    NORTH_EAST_DOWN,
)
from lta_data.importers.draft.vertical import (
    choose_reading,
    DECIDING_ADVANTAGE,
    EQUAL_SCORES,
    FORWARD_SHARE,
    FORWARDNESS_GAIN,
)
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.attitude_readings import is_crazyflie, list_readings
from lta_data.interpretation.column_group import ColumnGroup
from lta_data.interpretation.jumps import find_steps, find_tracker_jumps
from lta_data.interpretation.kinematics import (
    AGREEING_SHARE,
    differentiate,
    FILTER_DELAY,
    find_sensor_axes,
    fit_scale,
    measure_forwardness,
    MotionEvidence,
    score_attitude,
)
import numpy as np
from scipy.spatial.transform import Rotation

PITCH_DOWN: Final = np.array([1.0, -1.0, 1.0])  # from angles that are positive nose up
DRAFTED_ROWS: Final = 20_000  # rows that are looked at
USUAL_EXTENT: Final = 3.0  # of a flight in a laboratory [m]
INNER: Final = [2.0, 98.0]  # percentiles that a few wild positions do not move
MOST_DEGREES: Final = 400.0  # of a roll or pitch; larger ones are in another unit


@final
class MotionDraft(NamedTuple):
    """Entries of one odometry or IMU topic, and its evidence in SI units."""

    parts: dict[str, Any]
    evidence: MotionEvidence
    turn: Rotation | None
    axis_names: str = ''  # letters in the names of the place, such as 'ned'; '' for ours


def draft_motion(
    topic: str,
    seconds: Numbers,
    groups: Mapping[str, ColumnGroup],
    numbers: Mapping[str, Numbers],
    choices: DraftChoices,
    turn: Rotation | None = None,
) -> MotionDraft:
    """
    Return the parts of an odometry topic in the units and frames that fit.

    `groups` and `numbers` are by kind: position, velocity, rates, attitude, acceleration. Numbers
    `sensed` are the rates of an inertial sensor. `turn`: the attitude, where another topic has it.
    """
    seconds, rows = seconds[:DRAFTED_ROWS], {k: v[:DRAFTED_ROWS] for k, v in numbers.items()}
    if 'velocity' in groups and 'position' in groups and groups['position'].is_geodetic:
        velocity = groups['velocity']
        # A fix becomes a place east, north and up
        speed, turned = differentiate(rows['position'], seconds), _turn_rows(rows['velocity'])
        shares = [fit_scale(one, speed, seconds, FILTER_DELAY).share
                  for one in (turned, rows['velocity'])]  # fmt: skip
        clearly = max(shares[1] + DECIDING_ADVANTAGE, AGREEING_SHARE)
        if velocity.axes == NORTH_EAST_DOWN or shares[0] > clearly:
            groups = {**groups, 'velocity': _turn_names(velocity)}
            rows['velocity'] = turned
    parts: dict[str, Any] = {}
    for kind, why in _list_unusable(groups, numbers):
        part = 'orientation' if kind == 'attitude' else kind
        choices.add_reason(f'{topic}: {part}', groups[kind].columns, 'left out', why)
        groups = {one: group for one, group in groups.items() if one != kind}
        del rows[kind]
    scales = {'acceleration': draft_acceleration(topic, groups, rows, parts, choices)}
    # Without gravity in it, an acceleration says nothing about the attitude
    felt = rows.get('acceleration') if scales['acceleration'] else None
    place = _blank_lost_rows(rows, seconds)
    raw = MotionEvidence(
        seconds, place, rows.get('velocity'), rows.get('rates'), felt, rows.get('sensed')
    )
    is_mirrored = 'attitude' in groups and _have_mirrored_pitch(groups, rows, raw, choices)
    if is_mirrored:
        raw = raw._replace(rates=rows['rates'] * PITCH_DOWN)
    reading = None
    if 'attitude' in groups:
        reading = choose_reading(topic, groups['attitude'], rows['attitude'], raw, choices)
        parts['orientation'] = reading.entry
    turn = turn if reading is None else reading.turn
    if raw.sensed is not None and turn is not None and raw.acceleration is not None:
        # The accelerometer in the axes of the attitude
        axes, _ = find_sensor_axes(raw.sensed, turn, seconds)
        raw = raw._replace(acceleration=raw.acceleration @ axes.T)
    placed = groups.get('position')
    mirror = 1.0
    if 'attitude' in groups and placed is not None and _is_mirrored(turn, raw):
        groups, raw, mirror = _place_as_attitude(topic, groups, raw, choices)
    # An attitude in axes north, east, down, to which the place was turned
    is_turned = (
        placed is not None
        and placed.axes != NORTH_EAST_DOWN
        and groups['position'].axes == EAST_NORTH_DOWN
    )
    scales['rates'] = draft_rates(topic, groups, raw, turn, parts, choices)
    if is_mirrored:
        usual = parts['rates'].get('scale', 1.0)
        parts['rates']['scale'] = [usual, -usual, usual]
        choices.add_reason(f'{topic}: rates', groups['rates'].columns[1:2], 'inverted',
                           "as the pitch of Crazyflie's firmware")  # fmt: skip
    scales['position'] = draft_position(topic, groups, raw, scales, turn, parts, choices)
    if mirror < 0.0:
        parts['position']['scale'] = [1.0, mirror, 1.0]
    scales['velocity'] = draft_velocity(topic, groups, raw, scales, turn, parts, choices)
    si = MotionEvidence(
        seconds,
        *(
            None if (values := getattr(raw, kind)) is None or not scales[kind]
            else values * scales[kind]
            for kind in ('position', 'velocity', 'rates', 'acceleration')
        ),
    )  # fmt: skip
    # An estimate jumps where a tracker corrects it
    if si.position is not None and topic.startswith('ground_truth'):
        whole = rows['position'] * scales['position']
        _tell_jumps(topic, groups['position'], seconds, whole, choices)
    order = ('position', 'orientation', 'velocity', 'rates', 'acceleration')
    named = groups.get('position') or groups.get('velocity')
    axes_named = '' if named is None or named.axes == EAST_NORTH_DOWN else ''.join(named.axes)
    axes_named = 'ned' if is_turned else axes_named
    return MotionDraft(
        {name: parts[name] for name in order if name in parts}, si, turn, axes_named
    )


def _place_as_attitude(
    topic: str,
    groups: Mapping[str, ColumnGroup],
    raw: MotionEvidence,
    choices: DraftChoices,
) -> tuple[Mapping[str, ColumnGroup], MotionEvidence, float]:
    """
    Return position and velocity in the axes of an attitude that has others.

    A name tells it, or the user is asked. The last result is the sign of the position's y.
    """
    both = [kind for kind in ('position', 'velocity') if kind in groups]
    ned = [kind for kind in both if groups[kind].axes == NORTH_EAST_DOWN]
    other, answer = ('east, north, up', 'north, east, down'), 'world'
    if groups['position'].axes != NORTH_EAST_DOWN:
        other = other[::-1]
        options = [
            ('world', 'the attitude is that of axes north, east, down, the place east, north, '
             'up'), ('mirrored', 'y of the place counts the other way'),
            ('sideways', 'it flies sideways'),
        ]  # fmt: skip
        question = 'Position and attitude are in different axes: which?'
        answer = choices.decide(f'{topic}.position.axes', options, question)
    if answer == 'world':
        groups = {**groups, **{kind: _turn_names(groups[kind]) for kind in ned or both}}
        raw = raw._replace(**{kind: _turn_rows(getattr(raw, kind)) for kind in ned or both})
        choices.add_reason(f'{topic}: position', groups['position'].columns, other[1],
                           f'the attitude turns in axes {other[0]}')  # fmt: skip
    return groups, raw, -1.0 if answer == 'mirrored' else 1.0


def _list_unusable(
    groups: Mapping[str, ColumnGroup], numbers: Mapping[str, Numbers]
) -> Iterator[tuple[str, str]]:
    """Yield the kinds of groups that say nothing, and why."""
    for kind, group in groups.items():
        rows = numbers[kind][np.isfinite(numbers[kind]).all(axis=1)]
        if not len(rows):
            yield kind, 'it was never measured: no row has all its numbers'
        elif kind == 'position' and not rows.any():
            yield kind, 'it is zero in all rows: nothing measured it'
        # Neither radians nor degrees, but for example 0.01 degrees
        elif group.kind == 'euler' and (
            (np.percentile(np.abs(rows[:, :-1]), 99.0, axis=0) > MOST_DEGREES).any()
            or _wraps_at(rows[:, -1]) > MOST_DEGREES
        ):
            yield kind, 'its angles are larger than those in degrees; divide them first'


def _wraps_at(angles: Numbers) -> float:
    """Return the full turn, in the unit of the angles; 0.0 if they do not begin anew at zero."""
    back = float(np.max(np.abs(np.diff(angles)), initial=0.0))
    return back if angles.min() >= 0.0 and back > 0.9 * angles.max() else 0.0


def _turn_names(group: ColumnGroup) -> ColumnGroup:
    """Return columns of north, east, down in the order of our axes."""
    columns = tuple(group.columns[k] for k in (1, 0, 2))
    return group._replace(columns=columns, axes=EAST_NORTH_DOWN)


def _turn_rows(rows: Numbers) -> Numbers:
    """Return north, east, down as east, north, up, shape (n, 3)."""
    return np.asarray(rows[:, [1, 0, 2]] * [1.0, 1.0, -1.0])


def _have_mirrored_pitch(
    groups: Mapping[str, ColumnGroup],
    rows: Mapping[str, Numbers],
    raw: MotionEvidence,
    choices: DraftChoices,
) -> bool:
    """Return whether rates count the pitch nose up, as the angles of a Crazyflie do."""
    if 'rates' not in groups or not is_crazyflie(groups['rates']):
        return False
    readings = list(list_readings(groups['attitude'], rows['attitude'], choices.settled))
    best = [
        max(score_attitude(one.turn, evidence)[0] for one in readings if not one.cost)
        for evidence in (raw._replace(rates=rows['rates'] * PITCH_DOWN), raw)
    ]
    # An accelerometer can show that somebody has turned it
    return best[0] > best[1] - EQUAL_SCORES


def _tell_jumps(
    topic: str,
    group: ColumnGroup,
    seconds: Numbers,
    position: Numbers,
    choices: DraftChoices,
) -> None:
    """Add a row where the position jumps, as that of several bodies in turn does; in m."""
    time, place = sort_samples(seconds[: len(position)], position).select_complete()
    if len(time) < limits.LEAST_SAMPLES:
        return
    jumps, size = find_steps(time, place, limits.JUMP_SIZE)
    if jumps.any():
        choices.add_reason(
            f'{topic}: position', group.columns, 'doubtful',
            f'{jumps.sum()} of {len(time)} rows jump by up to {size[jumps].max():.2g} m, which no '
            'vehicle does: other markers, or other bodies in turn',
        )  # fmt: skip


def _blank_lost_rows(rows: Mapping[str, Numbers], seconds: Numbers) -> Numbers | None:
    """
    Return the positions, NaN where a tracker that lost the body writes zeros.

    Where it took other markers for a moment, they are interpolated: jumps would decide on units.
    """
    if 'position' not in rows:
        return None
    lost = np.asarray(~rows['position'].any(axis=1))
    if 'attitude' in rows and rows['attitude'].shape[1] == 4:
        lost |= ~rows['attitude'].any(axis=1)
    position = np.where(lost[:, None] & ~lost.all(), np.nan, rows['position'])
    rising = np.diff(np.fmax.accumulate(seconds), prepend=-np.inf) > 0.0
    jumped = np.zeros(len(seconds), dtype=np.bool_)
    # Jumps are sought in m, before the unit is known: a flight is not much longer than usual
    extent = np.ptp(np.nanpercentile(position, INNER, axis=0), axis=0).max()
    scale = USUAL_EXTENT / max(extent, USUAL_EXTENT)
    jumped[rising] = find_tracker_jumps(seconds[rising], scale * position[rising])
    steady = rising & ~jumped & np.isfinite(position).all(axis=1)
    for column in position.T if jumped.any() else ():
        column[jumped] = np.interp(seconds[jumped], seconds[steady], column[steady])
    return position


def _is_mirrored(turn: Rotation | None, raw: MotionEvidence) -> bool:
    """Return whether a place contradicts an attitude that rates confirm: it is left-handed."""
    sensed = raw.rates if raw.rates is not None else raw.sensed
    if turn is None or sensed is None or raw.position is None:
        return False
    if find_sensor_axes(sensed, turn, raw.seconds)[1].share < AGREEING_SHARE:
        return False
    mirrored = raw._replace(position=raw.position * [1.0, -1.0, 1.0])
    steady, other = (measure_forwardness(turn, one)[0] for one in (raw, mirrored))
    return other > FORWARD_SHARE and other > steady + FORWARDNESS_GAIN
