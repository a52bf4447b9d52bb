# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Say what a calibration found, the largest differences first."""

from collections.abc import Iterator, Sequence
import math
from typing import Final

from lta_discovery.calibration.corrections import is_contradicted
from lta_discovery.calibration.result import CalibratedValue, Calibration, Correction
from lta_discovery.formatting import (
    DIVERGED,
    format_error,
    format_number,
    format_parameter,
    format_with_interval,
    SHOWN_UNITS,
    TO_DEG,
)
from lta_discovery.model.calibration_parameters import GAIN_NAMES, HEADING
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import NET_LIFT_FORCE
from lta_discovery.settings import CLEAR
from lta_discovery.state_filter.forecast_scores import (
    CALIBRATED,
    COASTING,
    FILE_MODEL,
    find_main_score,
)
import numpy as np

REPORTED_RATE_CHANGE: Final = (
    0.1  # relative; a smaller change of the pendulum's rate is not reported
)
WRENCH_KINDS: Final = {
    'surge': 'force', 'sway': 'force', 'heave': 'force',
    'roll': 'moment', 'pitch': 'moment', 'yaw': 'moment',
}  # fmt: skip
REPORTED_DELAY: Final = 0.03  # s; a shorter delay is not reported
LISTED: Final = 4  # numbers beyond tolerance that have no words of their own
MARKER_TURNS: Final = ('yaw', 'pitch', 'roll')


def pendulum_rates(nominal: NominalVehicle) -> tuple[float, float]:
    """Return the rates of the free roll and pitch oscillations; 0 where there is none [rad/s]."""
    model = nominal.build_model()
    parameters = nominal.effect_parameters.get('cg_height', {})
    low = -(float(nominal.cg[2]) + float(parameters.get('z', 0.0)))
    inverse = np.asarray(model.inverse, dtype=np.float64).reshape(6, 6)
    stiffness = nominal.mass * 9.81 * low
    roll, pitch = (math.sqrt(max(stiffness * float(inverse[k, k]), 0.0)) for k in (3, 4))
    return roll, pitch


def list_differences(calibration: Calibration) -> list[str]:
    """Return what the vehicle file has wrong, one clause each; gains first."""
    return [
        *_gain_clauses(calibration),
        *_reverse_clauses(calibration),
        *_lift_clauses(calibration),
        *_marker_clauses(calibration),
        *_pendulum_clauses(calibration),
        *_delay_clauses(calibration),
        *_other_clauses(calibration),
    ]


def _gain_clauses(calibration: Calibration) -> Iterator[str]:
    """Yield the gains that differ from the file."""
    for one in calibration.values:
        effect, _, axis = one.name.partition('.')
        gain = one.name in GAIN_NAMES or one.name.endswith('.thrust')
        if not (one.is_far and gain):
            continue
        percent = format_number(100.0 * abs(one.value / one.before), 2)
        if effect == 'wrench_gain':
            if one.value * one.before < 0.0:
                yield f'{axis}: {percent} % of the commanded {WRENCH_KINDS[axis]} acts backwards'
            else:
                yield f'{axis}: {percent} % of the commanded {WRENCH_KINDS[axis]} arrives'
        else:
            side = ', backwards' if one.value < 0.0 else ''
            yield f'{effect.replace("_", " ")}: {percent} % of its thrust arrives{side}'


def _reverse_clauses(calibration: Calibration) -> Iterator[str]:
    """Yield the rotors and axes that push otherwise in reverse, and exponents of axes."""
    for one in calibration.values:
        rotor, _, part = one.name.partition('.')
        kind, _, axis = part.partition('_')
        if kind == 'reverse' and one.is_far:
            word = 'weaker' if one.value < 1.0 else 'stronger'
            percent = format_number(100.0 * abs(one.value - 1.0), 2)
            yield f'{axis or rotor.replace("_", " ")} pushes {percent} % {word} in reverse'
        elif kind == 'exponent' and one.is_far:
            size = format_number(one.value, 2)
            yield f'{axis}: the {WRENCH_KINDS[axis]} follows the command to the power {size}'


def _lift_clauses(calibration: Calibration) -> Iterator[str]:
    """Yield the net lift of the flights if it is far from the file's."""
    lifts = calibration.list_of_flights(NET_LIFT_FORCE)
    if any(one.is_far for one in lifts):
        low, high = (
            format_number(1e3 * each([one.value for one in lifts]), 3) for each in (min, max)
        )
        span = f'{low} mN' if low == high else f'{low} to {high} mN, by flight,'
        yield f'net lift: {span} above that of the file'


def format_lift_warning(lifts: Sequence[CalibratedValue]) -> str:
    """Say that flights have different lifts; `lifts`: the lowest and the highest."""
    low, high = (f'{format_number(1e3 * one.value, 3)} mN in {one.flight}' for one in lifts)
    return (
        f'The net lift differs between flights ({low}, {high}), so it was fitted for each: no '
        'constant difference in lift is reported. Note ballast and filling before each flight.'
    )


def _marker_clauses(calibration: Calibration) -> Iterator[str]:
    """Yield rotation and lever arm of the marker frame."""
    turns = [one for s in MARKER_TURNS if (one := calibration.find(f'marker_offset.{s}'))]
    arms = [one for a in 'xyz' if (one := calibration.find(f'marker_offset.{a}'))]
    turned = any(one.is_far for one in turns)
    if turned:
        size = TO_DEG * math.sqrt(sum(one.value**2 for one in turns))
        yield f'the marker frame is turned by {format_number(size, 2)}\N{DEGREE SIGN}'
    if any(one.is_far for one in arms):
        size = 100.0 * math.sqrt(sum(one.value**2 for one in arms if one.is_known))
        whose = 'its' if turned else "the marker frame's"
        yield f'{whose} origin is {format_number(size, 2)} cm from the hull centre'


def _pendulum_clauses(calibration: Calibration) -> Iterator[str]:
    """Yield the oscillations that are faster or slower than those of the file."""
    both = zip(
        pendulum_rates(calibration.nominal), pendulum_rates(calibration.calibrated), strict=True
    )
    for axis, (before, after), deviation in zip(
        ('roll', 'pitch'), both, calibration.pendulum_deviations, strict=True
    ):
        if min(before, after) <= 0.0:  # a vehicle that turns over does not swing
            continue
        change = abs(after / before - 1.0)
        if change > REPORTED_RATE_CHANGE and abs(math.log(after / before)) > CLEAR * deviation:
            word = 'faster' if after > before else 'slower'
            percent = format_number(100.0 * change, 2)
            yield f'the {axis} pendulum is {percent} % {word}'


def _delay_clauses(calibration: Calibration) -> Iterator[str]:
    """Yield the delay of the commands."""
    late = calibration.find('command_delay.delay')
    if late is not None and late.is_far and late.value > REPORTED_DELAY:
        yield f'commands act {format_number(late.value, 2)} s late'


def _other_clauses(calibration: Calibration) -> Iterator[str]:
    """Yield the other numbers of the vehicle that are beyond tolerance, the clearest first."""
    worded = {*GAIN_NAMES}
    if any(_delay_clauses(calibration)):
        worded.add('command_delay.delay')
    if any(_pendulum_clauses(calibration)):
        worded |= {'vehicle.roll', 'vehicle.pitch', 'cg_height.z'}
    others = [
        one
        for one in calibration.values
        if one.is_far
        and not one.flight
        and one.name not in worded
        and not one.name.startswith('marker_offset.')
        and not one.name.partition('.')[2].startswith(('thrust', 'reverse', 'exponent'))
    ]
    others.sort(key=lambda one: -abs(one.value - one.before) / one.deviation)
    for one in others[:LISTED]:
        before, now, _ = format_in_unit(one)
        yield f'{format_name(one)} {now} (vehicle file: {before})'
    if rest := len(others[LISTED:]):
        yield f'{rest} more number{"s" if rest > 1 else ""}'


def format_headline(calibration: Calibration) -> str:
    """Return the result in one sentence."""
    if calibration.method == 'file':
        return 'No calibration forecasts the training flights better than the vehicle file.'
    clauses = list_differences(calibration)
    text = '; '.join(clauses) if clauses else 'The vehicle file is within its tolerances'
    sentence = f'{text[:1].upper()}{text[1:]}.'
    if is_contradicted(calibration.scores):
        return (
            'The confirming flights contradict the calibration, so keep the vehicle file. '
            f'Estimated from the training flights alone: {sentence}'
        )
    return sentence


def format_forecast_sentence(calibration: Calibration) -> str:
    """Return how well the calibration forecasts, beside file and coasting; '' if unknown."""
    role, scores = calibration.judging_scores
    main = find_main_score(scores)
    if main is None:
        return 'The flights are too short to compare forecasts.'
    where = 'confirming flights' if role == 'confirm' else 'the training flights themselves'
    sizes = [main.positions[name] for name in (FILE_MODEL, CALIBRATED, COASTING)]
    file, now, coast = map(format_error, sizes)
    text = (
        f'Position error {main.horizon:g} s ahead on {where}: {file} with the vehicle file, '
        f'{now} calibrated, {coast} if the vehicle coasted.'
    )
    if sizes[1] > DIVERGED:
        text += (
            ' The forecasts diverge: the file is far off, or the vehicle is unstable without its '
            'controller, as a multirotor is, so that recorded commands do not predict it.'
        )
    elif sizes[1] >= sizes[2]:
        text += ' The calibrated model does not beat coasting, so do not rely on its forecasts.'
    return text


def format_in_unit(one: CalibratedValue) -> tuple[str, str, str]:
    """Return file value, value and interval with a unit that reads well."""
    unit, factor = SHOWN_UNITS.get(one.unit, (one.unit, 1.0))
    if one.unit == 'N':
        unit, factor = 'mN', 1e3
    elif one.unit == 'm':
        unit, factor = 'cm', 100.0
    elif one.unit == 'N/s':
        unit, factor = 'mN/min', 6e4
    before, value = factor * one.before, factor * one.value
    now, low, high = format_with_interval(value, (factor * one.ci95[0], factor * one.ci95[1]))
    end = '' if unit == '1' else f' {unit}'
    return f'{format_number(before)}{end}', f'{now}{end}', f'{low} to {high}'


def format_values(correction: Correction) -> list[str]:
    """Return the clear values of a correction, each with its name and unit."""
    return [f'{format_parameter(one.name)} {format_in_unit(one)[1]}' for one in correction.values]


def format_name(one: CalibratedValue) -> str:
    """Return the name of a number in words."""
    effect, _, part = one.name.partition('.')
    if effect == 'vehicle':
        return 'mass (factor)' if part == 'mass' else f'inertia in {part} (factor)'
    if effect == 'helium_leak':
        return 'loss of lift'
    return format_parameter(one.name)


def format_inseparable(one: CalibratedValue) -> str:
    """Return what a value cannot be separated from, in words."""
    words = ', '.join(each.replace('_', ' ') for each in one.inseparable)
    if one.name == HEADING and not one.is_known:
        return f'cannot be separated from {words}: no wind of the vehicle file shows it'
    if not one.is_known:
        return 'not learned from these flights' + (f'; moves with {words}' if words else '')
    return f'cannot be separated from {words}' if words else ''
