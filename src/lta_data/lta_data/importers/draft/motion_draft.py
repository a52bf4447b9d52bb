"""Draft the motion of one table: position, attitude, velocity, rates and inertial sensor."""

from collections.abc import Iterator, Mapping
from typing import Any, Final, final, NamedTuple

from lta_config.constants import RADIANS_PER_DEGREE
from lta_data.data_quality import limits
from lta_data.even_grid import sort_samples
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.column_groups import LENGTH_SCALES
from lta_data.importers.draft.vertical import (
    choose_reading,
    DECIDING_ADVANTAGE,
    EQUAL_SCORES,
    FORWARD_SHARE,
    FORWARDNESS_GAIN,
    typical_difference,
)
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.attitude_readings import is_crazyflie, list_readings
from lta_data.interpretation.column_group import ColumnGroup, FIX_SCALES
from lta_data.interpretation.column_names import UNIT_WORDS
from lta_data.interpretation.jumps import find_steps, find_tracker_jumps
from lta_data.interpretation.kinematics import (
    AGREEING_SHARE,
    body_rates_of,
    differentiate,
    FILTER_DELAY,
    find_gravity_unit,
    find_sensor_axes,
    fit_scale,
    measure_forwardness,
    MotionEvidence,
    NO_FIT,
    score_attitude,
    UNIT_FACTORS,
)
import numpy as np
from scipy.spatial.transform import Rotation

PITCH_DOWN: Final = np.array([1.0, -1.0, 1.0])  # from angles that are positive nose up
DRAFTED_ROWS: Final = 20_000  # rows that are looked at
NORTH_EAST_DOWN: Final = ('n', 'e', 'd')
EAST_NORTH_DOWN: Final = ('e', 'n', 'd')
UNIT_LOG_TOLERANCE: Final = 0.7  # logarithm of a factor, within which noise can move it
COUNTS: Final = 'counts'  # of a sensor, whose scale the attitude shows
UNRELATED: Final = 0.3  # explained share of a motion below which two contradict each other
UNLIKE: Final = 1.3  # times as much unexplained decides between two frames
# Between body and world axes; below it, the better of two is taken [deg]
FRAMES_APART: Final = 15.0
EXTENTS: Final = (0.3, 30.0)  # usual extents of a flight in a laboratory [m]
USUAL_EXTENT: Final = 3.0  # in the middle of these [m]
INNER: Final = [2.0, 98.0]  # percentiles that a few wild positions do not move
IMPOSSIBLE: Final = 60.0  # speed of no vehicle in a laboratory [m/s]
GRAVITY_TOLERANCE: Final = 0.12  # a slow vehicle accelerates little; 8192 is no number of mm/s2
MOST_DEGREES: Final = 400.0  # of a roll or pitch; larger ones are in another unit
FLIGHT_SPEEDS: Final = (0.02, 20.0)  # usual speeds of a vehicle in flight [m/s]


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
    scales = {'acceleration': _draft_acceleration(topic, groups, rows, parts, choices)}
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
    scales['rates'] = _draft_rates(topic, groups, raw, turn, parts, choices)
    if is_mirrored:
        usual = parts['rates'].get('scale', 1.0)
        parts['rates']['scale'] = [usual, -usual, usual]
        choices.add_reason(f'{topic}: rates', groups['rates'].columns[1:2], 'inverted',
                           "as the pitch of Crazyflie's firmware")  # fmt: skip
    scales['position'] = _draft_position(topic, groups, raw, scales, turn, parts, choices)
    if mirror < 0.0:
        parts['position']['scale'] = [1.0, mirror, 1.0]
    scales['velocity'] = _draft_velocity(topic, groups, raw, scales, turn, parts, choices)
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


def _named_unit(group: ColumnGroup) -> tuple[str, float] | None:
    """Return the unit in the names of a group: unit of a mapping, and scale."""
    return UNIT_WORDS.get(group.unit) if group.unit else None


def _build_vector(group: ColumnGroup, unit: str, scale: float = 1.0) -> dict[str, Any]:
    vector: dict[str, Any] = {'columns': list(group.columns), 'unit': unit}
    if group.axes == EAST_NORTH_DOWN or group.rise != 1.0:
        rise = group.rise * (-scale if group.axes == EAST_NORTH_DOWN else scale)
        return vector | {'scale': [scale, scale, rise]}
    return vector if scale == 1.0 else vector | {'scale': scale}


def _draft_acceleration(
    topic: str,
    groups: Mapping[str, ColumnGroup],
    rows: Mapping[str, Numbers],
    parts: dict[str, Any],
    choices: DraftChoices,
) -> float:
    """Draft an accelerometer by the size of gravity; return the factor to m/s2, 0 if unusable."""
    group = groups.get('acceleration')
    if group is None:
        return 0.0
    felt = float(np.nanmedian(np.linalg.norm(rows['acceleration'], axis=1)))
    if unit := find_gravity_unit(felt, GRAVITY_TOLERANCE):
        scale = float(f'{1.0 / UNIT_FACTORS["force"][unit]:.12g}')
        parts['acceleration'] = _build_vector(group, 'm/s2', scale)
        choices.add_reason(f'{topic}: acceleration', group.columns, unit,
                           f'its median length {felt:.4g} is gravity in {unit}')  # fmt: skip
        return scale
    choices.add_reason(f'{topic}: acceleration', group.columns, 'left out',
                       f'its median length {felt:.4g} is gravity in no usual unit')  # fmt: skip
    return 0.0


def _draft_rates(
    topic: str,
    groups: Mapping[str, ColumnGroup],
    raw: MotionEvidence,
    turn: Rotation | None,
    parts: dict[str, Any],
    choices: DraftChoices,
) -> float:
    """Draft angular rates: their unit, and whether they are in the body or the world."""
    group = groups.get('rates')
    if group is None or raw.rates is None:
        return 0.0
    key = f'{topic}.rates.unit'
    named = _named_unit(group)
    unit, why, frame, fit = '', '', '', NO_FIT
    if turn is not None:
        derived = body_rates_of(turn, raw.seconds)
        in_world = turn.apply(np.nan_to_num(derived))
        fits = {
            'body': fit_scale(raw.rates, derived, raw.seconds, FILTER_DELAY),
            'world': fit_scale(raw.rates, in_world, raw.seconds, FILTER_DELAY),
        }
        frame = max(fits, key=lambda one: fits[one].share - 0.02 * (one == 'world'))
        fit = fits[frame]
        if fit.share > AGREEING_SHARE:
            why = f'{fit.factor:.3g} times the derivative of the attitude ({frame} axes)'
            far = {
                one: abs(np.log(fit.factor / factor))
                for one, factor in UNIT_FACTORS['rates'].items()
            }
            unit = min(far, key=lambda one: far[one])
            options = [(one, '') for one in sorted(far, key=lambda one: far[one])]
            if named and named[0] != unit:
                question = f'The names say {named[0]}, but the rates are {why}.'
                unit = choices.decide(key, options, question)
                why = choices.explain(key)
            elif far[unit] > UNIT_LOG_TOLERANCE:
                options.insert(0, (COUNTS, f'{1.0 / fit.factor:.4g} rad/s each, by the attitude'))
                question = f'The rates are {why}, as counts of a sensor, or with another time.'
                unit = choices.decide(key, options, question)
                why = choices.explain(key)
    if not unit and named:
        unit, why = named[0], 'the unit in the names'
    if not unit:
        size = float(np.nanpercentile(np.abs(raw.rates), 99.0))
        unit = 'deg/s' if size > 12.0 else 'rad/s'
        why = f'99 % are below {size:.3g}'
        if 3.0 < size <= 12.0:
            options = [('rad/s', f'up to {size / RADIANS_PER_DEGREE:.0f} deg/s'),
                       ('deg/s', f'up to {size:.1f} deg/s')]  # fmt: skip
            unit = choices.decide(key, options, f'The rates reach {size:.3g}.')
    unit = choices.override(key, unit)
    scale = 1.0 / UNIT_FACTORS['rates'].get(unit, 1.0)
    if unit == COUNTS and fit.share > AGREEING_SHARE:
        scale = float(f'{1.0 / fit.factor:.6g}')
    if unit in ('mrad/s', 'mdeg/s', COUNTS):  # as stateEstimateZ of a Crazyflie
        parts['rates'] = _build_vector(group, 'rad/s', scale)
    else:
        parts['rates'] = _build_vector(group, unit)
    if frame == 'world' and fit.share > AGREEING_SHARE:
        parts['rates']['frame'] = 'world'
    choices.add_reason(f'{topic}: rates', group.columns, unit, why)
    return scale


def _draft_position(
    topic: str,
    groups: Mapping[str, ColumnGroup],
    raw: MotionEvidence,
    scales: Mapping[str, float],
    turn: Rotation | None,
    parts: dict[str, Any],
    choices: DraftChoices,
) -> float:
    """Draft a position: its unit by name, by velocity, by acceleration or by its speed."""
    group = groups.get('position')
    if group is None or raw.position is None:
        return 0.0
    if group.is_geodetic:
        parts['position'] = _build_vector(group, 'm') | {'geodetic': True}
        if group.unit != 'm':
            scales_of_fix = np.array(FIX_SCALES[group.unit]) * [1.0, 1.0, group.rise]
            parts['position']['scale'] = [*map(float, scales_of_fix)]
        choices.add_reason(f'{topic}: position', group.columns, 'east, north, up',
                           'from the first fix, in m')  # fmt: skip
        return 1.0
    key = f'{topic}.position.unit'
    named = _named_unit(group)
    unit, why = (named[0], 'the unit in the names') if named else ('', '')
    speed = differentiate(raw.position, raw.seconds)
    fast = float(np.nanpercentile(np.linalg.norm(speed, axis=1), 75.0))
    by_motion, factor = _find_length_unit(groups.get('velocity'), raw, speed, turn)
    why = why or f'the velocity is {factor:.3g} times its derivative'
    # Both can be in mm: the factor alone does not say it
    if not unit and by_motion and fast * LENGTH_SCALES[by_motion] < FLIGHT_SPEEDS[1]:
        unit = by_motion
    elif unit and by_motion not in ('', unit):
        question = f'The names say {unit}, but the velocity is {factor:.3g} times the derivative.'
        unit = choices.decide(key, [(by_motion, ''), (unit, '')], question)
        why = choices.explain(key)
    elif unit and fast * LENGTH_SCALES[unit] > IMPOSSIBLE:
        options = [(one, f'{fast * LENGTH_SCALES[one]:.3g} m/s') for one in ('mm', 'cm', 'm')]
        unit = choices.decide(key, options, f'The names say {unit}, which is too fast a flight.')
        why = choices.explain(key)
    if not unit:
        extent = float(np.max(np.nanpercentile(raw.position, 98, axis=0)
                              - np.nanpercentile(raw.position, 2, axis=0)))  # fmt: skip
        fitting = _list_length_units(fast, extent)
        unit, why = fitting[0], f'moves over {extent:.3g} at {fast:.3g} per second'
        if len(fitting) > 1 and choices.settled.get('position.unit') in fitting:
            unit = choices.settled['position.unit']
            why = 'as other positions, or messages of ROS, have it'
        elif len(fitting) > 1 and key not in choices.answers:
            scaled = ((u, LENGTH_SCALES[u]) for u in fitting)
            options = [(u, f'{extent * one:.3g} m at {fast * one:.3g} m/s') for u, one in scaled]
            unit = choices.decide(key, options, 'No velocity tells the unit of the position.')
    unit = choices.override(key, unit)
    choices.settled.setdefault('position.unit', unit)
    # Feet are 0.3048 m
    factor = named[1] if named and named[0] == unit else 1.0
    parts['position'] = _build_vector(group, unit, factor)
    choices.add_reason(f'{topic}: position', group.columns, unit, why)
    return LENGTH_SCALES.get(unit, 1.0) * factor


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


def _find_length_unit(
    group: ColumnGroup | None, raw: MotionEvidence, speed: Numbers, turn: Rotation | None
) -> tuple[str, float]:
    """
    Return the unit of a place by a velocity in m/s, and the factor of both; '' without one.

    `speed`: the derivative of the place.
    """
    if group is None or raw.velocity is None:
        return '', 0.0
    turned = speed if turn is None else turn.inv().apply(np.nan_to_num(speed))
    fits = [fit_scale(raw.velocity, one, raw.seconds, FILTER_DELAY) for one in (speed, turned)]
    best = max(fits, key=lambda fit: fit.share)
    if best.share < AGREEING_SHARE:
        return '', 0.0
    named = _named_unit(group)
    factor = best.factor * (named[1] if named else 1.0)
    far = {one: abs(np.log(factor / scale)) for one, scale in LENGTH_SCALES.items()}
    unit = min(far, key=lambda one: far[one])
    return (unit, best.factor) if far[unit] < UNIT_LOG_TOLERANCE else ('', 0.0)


def _list_length_units(fast: float, extent: float) -> list[str]:
    """Return the units in which a usual speed and an extent are those of a flight; 'm' if none."""
    moving = [
        u
        for u, scale in LENGTH_SCALES.items()
        if FLIGHT_SPEEDS[0] <= fast * scale <= FLIGHT_SPEEDS[1]
    ]
    inside = [u for u in moving if EXTENTS[0] <= extent * LENGTH_SCALES[u] <= EXTENTS[1]]
    # A smaller unit, in which the flight would only be short, cannot be excluded
    short = [u for u in moving if 0.5 * EXTENTS[0] < extent * LENGTH_SCALES[u] < EXTENTS[0]]
    return [*inside, *short] or moving or ['m']


def _draft_velocity(
    topic: str,
    groups: Mapping[str, ColumnGroup],
    raw: MotionEvidence,
    scales: Mapping[str, float],
    turn: Rotation | None,
    parts: dict[str, Any],
    choices: DraftChoices,
) -> float:
    """Draft a velocity: unit and frame by the derivative of the position."""
    group = groups.get('velocity')
    if group is None or raw.velocity is None:
        return 0.0
    named = _named_unit(group)
    scale = named[1] if named else 1.0
    key = f'{topic}.velocity.frame'
    frame, why = 'body', 'nothing to compare it with'
    if raw.position is not None:
        speed = differentiate(raw.position * scales['position'], raw.seconds)
        fits = {'world': fit_scale(raw.velocity, speed, raw.seconds, FILTER_DELAY)}
        if turn is not None:
            fits['body'] = fit_scale(raw.velocity, turn.inv().apply(np.nan_to_num(speed)),
                                     raw.seconds, FILTER_DELAY)  # fmt: skip
        frame = max(fits, key=lambda one: fits[one].share)
        fit = fits[frame]
        why = f'the derivative of the position agrees in {frame} axes ({100 * fit.share:.0f} %'
        why += ''.join(f'; in {one} axes {100 * other.share:.0f} %' for one, other in
                       fits.items() if one != frame) + ')'  # fmt: skip
        if not named and fit.share > AGREEING_SHARE:
            scale = 1.0 / min(
                UNIT_FACTORS['velocity'].values(), key=lambda one: abs(np.log(fit.factor / one))
            )
        # By what they leave unexplained: at small angles both explain nearly all
        left = 1.0 - fit.share
        close = [
            one
            for one, other in fits.items()
            if one == frame or (1.0 - other.share) < UNLIKE * left
        ]
        moving = float(np.nanpercentile(np.linalg.norm(speed, axis=1), 75.0)) > FLIGHT_SPEEDS[0]
        if turn is None and fit.share < UNRELATED:
            frame, why = 'body', f'{why}; in body axes, nothing checks it'
        elif len(close) > 1 and 'velocity.frame' in choices.settled:
            frame = choices.settled['velocity.frame']
        elif fit.share < UNRELATED and moving and key not in choices.answers:
            options = [('none', 'left out'), *((one, '') for one in fits)]
            question = f'The velocity contradicts the position: {why}.'
            frame = choices.decide(key, options, question)
        elif frame == 'world' and group.axes in (NORTH_EAST_DOWN, EAST_NORTH_DOWN):
            why = f'{why}; as its names say'
        elif len(close) > 1 and _differs(turn) and key not in choices.answers:
            options = [(one, f'{100 * fits[one].share:.0f} % explained') for one in close]
            frame = choices.decide(key, options, 'The velocity fits in both frames.')
    frame = choices.settled.setdefault('velocity.frame', choices.override(key, frame))
    if frame == 'none':
        choices.add_reason(f'{topic}: velocity', group.columns, 'left out', why)
        return scale
    if frame == 'world' and turn is None:
        choices.add_reason(f'{topic}: velocity', group.columns, 'left out',
                           'in world axes, and no attitude turns it into body axes')  # fmt: skip
        return scale
    parts['velocity'] = _build_vector(group, 'm/s', scale)
    if frame == 'world':
        parts['velocity']['frame'] = 'world'
    choices.add_reason(f'{topic}: velocity', group.columns, f'{frame} axes, x {scale:g} m/s', why)
    return scale


def _differs(turn: Rotation | None) -> bool:
    """Return whether body and world axes differ in a flight."""
    return turn is not None and typical_difference(Rotation.identity(), turn) > FRAMES_APART
