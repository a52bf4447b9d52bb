# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draft each vector of a motion: its unit and its frame, by names, motion and usual sizes."""

from collections.abc import Mapping
from typing import Any, Final

from lta_config.constants import RADIANS_PER_DEGREE, STANDARD_GRAVITY
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.column_groups import LENGTH_SCALES
from lta_data.importers.draft.vertical import FORWARD_SHARE, typical_difference
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.column_group import ColumnGroup, FIX_SCALES
from lta_data.interpretation.column_names import UNIT_WORDS
from lta_data.interpretation.kinematics import (
    AGREEING_SHARE,
    body_rates_of,
    differentiate,
    FILTER_DELAY,
    find_gravity_unit,
    fit_scale,
    MotionEvidence,
    NO_FIT,
    ScaleFit,
    UNIT_FACTORS,
)
import numpy as np
from scipy.spatial.transform import Rotation

NORTH_EAST_DOWN: Final = ('n', 'e', 'd')
EAST_NORTH_DOWN: Final = ('e', 'n', 'd')
UNIT_LOG_TOLERANCE: Final = 0.7  # logarithm of a factor, within which noise can move it
COUNTS: Final = 'counts'  # of a sensor, whose scale the attitude shows
UNRELATED: Final = 0.3  # explained share of a motion below which two contradict each other
UNLIKE: Final = 1.3  # times as much unexplained decides between two frames
# Between body and world axes; below it, the better of two is taken [deg]
FRAMES_APART: Final = 15.0
EXTENTS: Final = (0.3, 30.0)  # usual extents of a flight in a laboratory [m]
CLEAR_TURNING: Final = 0.2  # usual rates, which no error of an attitude explains [rad/s]
IMPOSSIBLE: Final = 60.0  # speed of no vehicle in a laboratory [m/s]
# Of an accelerometer with 16 bits, at ranges of 16, 8, 4 and 2 g
COUNTS_OF_GRAVITY: Final = (2048, 4096, 8192, 16384)
COUNTS_TOLERANCE: Final = 0.05
GRAVITY_TOLERANCE: Final = 0.12  # a slow vehicle accelerates little; 8192 is no number of mm/s2
CLEARLY_AHEAD: Final = 0.15  # more of the way along x decides on the frame
FLIGHT_SPEEDS: Final = (0.02, 20.0)  # usual speeds of a vehicle in flight [m/s]


def _named_unit(group: ColumnGroup) -> tuple[str, float] | None:
    """Return the unit in the names of a group: unit of a mapping, and scale."""
    return UNIT_WORDS.get(group.unit) if group.unit else None


def _build_vector(group: ColumnGroup, unit: str, scale: float = 1.0) -> dict[str, Any]:
    vector: dict[str, Any] = {'columns': list(group.columns), 'unit': unit}
    if group.axes == EAST_NORTH_DOWN or group.rise != 1.0:
        rise = group.rise * (-scale if group.axes == EAST_NORTH_DOWN else scale)
        return vector | {'scale': [scale, scale, rise]}
    return vector if scale == 1.0 else vector | {'scale': scale}


def draft_acceleration(
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
    for counts in COUNTS_OF_GRAVITY:
        if abs(felt / counts - 1.0) < COUNTS_TOLERANCE:
            scale = float(f'{STANDARD_GRAVITY / counts:.9g}')
            parts['acceleration'] = _build_vector(group, 'm/s2', scale)
            choices.add_reason(f'{topic}: acceleration', group.columns, COUNTS,
                               f'its median length {felt:.4g} is gravity where a g has {counts} '
                               'counts')  # fmt: skip
            return scale
    choices.add_reason(f'{topic}: acceleration', group.columns, 'left out',
                       f'its median length {felt:.4g} is gravity in no usual unit')  # fmt: skip
    return 0.0


def draft_rates(
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
        if topic != 'imu' and _contradicts(raw.rates, derived, fit, raw.seconds):
            question = 'The rates are not those of the attitude, and can be a bias of a sensor.'
            options = [('none', 'left out'), ('keep', '')]
            if choices.decide(f'{topic}.rates', options, question) == 'none':
                choices.add_reason(f'{topic}: rates', group.columns, 'left out', question)
                return 0.0
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


def _contradicts(rates: Numbers, derived: Numbers, fit: ScaleFit, seconds: Numbers) -> bool:
    """Return whether rates are not what an attitude that turns implies, in any unit."""
    has_unit = any(
        abs(np.log(fit.factor / factor)) < UNIT_LOG_TOLERANCE
        for factor in UNIT_FACTORS['rates'].values()
    )
    if (has_unit and fit.share > UNRELATED) or not (
        float(np.nanmedian(np.linalg.norm(derived, axis=1))) > CLEAR_TURNING
    ):
        return False
    # A constant vector is alike to another one
    changes, implied = (side - np.nanmean(side, axis=0) for side in (rates, derived))
    return fit_scale(changes, implied, seconds, FILTER_DELAY).share < UNRELATED


def draft_position(
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


def draft_velocity(
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
    in_compass_axes = group.axes in (NORTH_EAST_DOWN, EAST_NORTH_DOWN)
    is_named = in_compass_axes and raw.position is None
    if is_named:
        frame, why = 'world', 'the names north, east, down'
    elif raw.position is not None:
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
            frame = choices.settled.get('velocity.frame', 'body')
            why = f'{why}; in body axes, nothing checks it'
        elif len(close) > 1 and 'velocity.frame' in choices.settled:
            frame = choices.settled['velocity.frame']
        elif fit.share < UNRELATED and moving and key not in choices.answers:
            options = [('none', 'left out'), *((one, '') for one in fits)]
            question = f'The velocity contradicts the position: {why}.'
            frame = choices.decide(key, options, question)
        elif frame == 'world' and in_compass_axes:
            why = f'{why}; as its names say'
        elif len(close) > 1 and _differs(turn) and key not in choices.answers:
            options = [(one, f'{100 * fits[one].share:.0f} % explained') for one in close]
            frame = choices.decide(key, options, 'The velocity fits in both frames.')
    elif 'velocity.frame' in choices.settled:
        frame, why = choices.settled['velocity.frame'], 'as another velocity has it'
    elif turn is not None and _differs(turn):
        ahead = {'body': _measure_way_ahead(raw.velocity)}
        ahead['world'] = _measure_way_ahead(turn.inv().apply(np.nan_to_num(raw.velocity)))
        frame = max(ahead, key=lambda one: ahead[one])
        why = f'the vehicle moves where it points ({100 * ahead[frame]:.0f} % of the way)'
        if ahead[frame] < FORWARD_SHARE or min(ahead.values()) > ahead[frame] - CLEARLY_AHEAD:
            options = [('body', ''), ('world', '')]
            question = 'No position tells whether the velocity is in body or world axes.'
            frame, why = choices.decide(key, options, question), choices.explain(key)
    frame = choices.override(key, frame)
    if not is_named and frame != 'none':  # the names of one topic say nothing of another
        choices.settled.setdefault('velocity.frame', frame)
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


def _measure_way_ahead(velocity: Numbers) -> float:
    """Return how much of the way goes along x, -1 to 1; along y, it can be wind, or the world."""
    speed = np.linalg.norm(velocity, axis=1)
    moving = speed > 0.5 * np.nanpercentile(speed, 90.0)
    if not moving.any():
        return 0.0
    return float((velocity[moving, 0] / speed[moving]).mean())


def _differs(turn: Rotation | None) -> bool:
    """Return whether body and world axes differ in a flight."""
    return turn is not None and typical_difference(Rotation.identity(), turn) > FRAMES_APART
