# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hide effects of the library in the parameters of the independent simulator."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, final

import numpy as np

from campaigns.challenge.rotors import approximate_lag
from campaigns.challenge.truth import VehicleTruth

Draw = np.random.Generator


@final
@dataclass(frozen=True, slots=True)
class InjectionRule:
    """How a parameter is hidden."""

    field: str  # field of `VehicleTruth` to which the value is added
    # Bounds of the absolute value, in the unit of the parameter
    least: float
    most: float
    axis: int | None = None  # index within the field, if it has several elements
    signs: tuple[int, ...] = (1,)  # allowed signs
    # Different bounds for one of the signs
    others: Mapping[int, tuple[float, float]] | None = None


BOTH: Final = (-1, 1)
ROTORS: Final = 4


def _axis_rules(
    effect: str, names: str, field: str, least: float, most: float
) -> dict[str, InjectionRule]:
    """Return the rules of an effect with several axes and positive values."""
    return {
        f'{effect}.{name}': InjectionRule(field, least, most, axis)
        for axis, name in enumerate(names.split())
    }


def _sensor_rules(effect: str, field: str, least: float, most: float) -> dict[str, InjectionRule]:
    """Return the rules of a sensor offset with three axes."""
    return {
        f'{effect}.{name}': InjectionRule(field, least, most, axis, BOTH)
        for axis, name in enumerate('xyz')
    }


HIDINGS: Final[dict[str, InjectionRule]] = {
    'steady_wind.x': InjectionRule('wind', 0.05, 0.25, 0, BOTH),
    'steady_wind.y': InjectionRule('wind', 0.05, 0.25, 1, BOTH),
    # With more lift than this, the vehicle would rise to the ceiling
    'net_lift.force': InjectionRule('lift', 2e-3, 20e-3, None, BOTH, {1: (2e-3, 12e-3)}),
    'helium_leak.rate': InjectionRule('leak', 5e-5, 4e-4),
    **_axis_rules('added_mass', 'surge sway heave', 'added_mass', 0.03, 0.15),
    'added_inertia.yaw': InjectionRule('yaw_air', 2e-3, 6e-3),
    **_axis_rules('quadratic_drag', 'surge sway heave', 'extra_drag', 0.03, 0.15),
    **_axis_rules('linear_drag', 'surge sway heave', 'linear_drag', 0.01, 0.05),
    **_axis_rules('rotational_drag', 'roll pitch yaw', 'turn_linear', 5e-4, 3e-3),
    'munk_moment.lost': InjectionRule('munk', 0.3, 1.0),
    'cg_height.z': InjectionRule('cg', 6e-3, 0.03, 2, BOTH, {1: (6e-3, 0.02)}),
    'cg_offset.x': InjectionRule('cg', 4e-3, 0.02, 0, BOTH),
    'cg_offset.y': InjectionRule('cg', 4e-3, 0.02, 1, BOTH),
    'motor_deadband.threshold': InjectionRule('deadband', 0.06, 0.2),
    'motor_lag': InjectionRule('slow_lag', 0.03, 0.25),
    'thrust_scale.factor': InjectionRule('thrust', 0.1, 0.3, None, BOTH),
    **_axis_rules('rotor_fault', 'lost_1 lost_2 lost_3 lost_4', 'gains', 0.08, 0.35),
    'command_delay.delay': InjectionRule('delay', 0.03, 0.15),
    'tracker_misalignment.yaw': InjectionRule('tracker', 0.1, 0.4, 0, BOTH),
    'tracker_misalignment.pitch': InjectionRule('tracker', 0.02, 0.08, 1, BOTH),
    'tracker_misalignment.roll': InjectionRule('tracker', 0.02, 0.08, 2, BOTH),
    'tracker_delay.delay': InjectionRule('tracker_delay', 0.03, 0.1),
    **_sensor_rules('imu_bias', 'imu_bias', 0.3, 0.8),
    **_sensor_rules('gyro_bias', 'gyro_bias', 0.03, 0.1),
    'range_offset.offset': InjectionRule('range_offset', 0.04, 0.2, None, BOTH),
    # Of an axis of a commanded wrench
    **{f'wrench_gain.{name}': InjectionRule('wrench_gains', 0.15, 0.5, axis, BOTH)
       for name, axis in (('surge', 0), ('heave', 2), ('yaw', 5))},
}  # fmt: skip
OF_WRENCH: Final = ('wrench_gain',)
# What the log of a pose and a commanded wrench cannot show
OF_ROTORS: Final = (
    'motor_deadband', 'motor_lag', 'thrust_scale', 'rotor_fault', 'imu_bias', 'gyro_bias',
    'range_offset',
)  # fmt: skip
# Parameters whose value is the lost share
SHARES: Final = ('munk_moment.lost', *(f'rotor_fault.lost_{k + 1}' for k in range(ROTORS)))


def effect_of(knob: str) -> str:
    """Return the effect of a parameter 'EFFECT.NAME'."""
    return knob.partition('.')[0]


def draw_hidden_effects(count: int, draw: Draw, of_wrench: bool = False) -> dict[str, float]:
    """
    Draw parameters of different effects, all equally likely, and their values.

    `of_wrench`: of a vehicle whose log has its pose and a commanded wrench.
    """
    unseen = OF_ROTORS if of_wrench else OF_WRENCH
    # Sorted, so that the draw is reproducible
    effects = sorted({effect_of(knob) for knob in HIDINGS} - {*unseen})
    out = {}
    for effect in draw.choice(effects, count, replace=False):
        knob = str(draw.choice([each for each in HIDINGS if effect_of(each) == effect]))
        hiding = HIDINGS[knob]
        sign = int(draw.choice(hiding.signs))
        least, most = (hiding.others or {}).get(sign, (hiding.least, hiding.most))
        # Log-uniform
        out[knob] = sign * float(least * (most / least) ** draw.random())
    return out


def _apply_change(old: float, knob: str, value: float) -> float:
    """Return a true number changed by a hidden value."""
    if knob in SHARES:
        return old * (1.0 - value)
    if knob == 'thrust_scale.factor':
        return old * (1.0 + value)
    return old + value


def inject_effects(truth: VehicleTruth, hidden: Mapping[str, float]) -> VehicleTruth:
    """Return a vehicle with hidden effects."""
    for knob, value in hidden.items():
        hiding = HIDINGS[knob]
        old: Any = getattr(truth, hiding.field)
        if hiding.axis is None:
            new: Any = _apply_change(old, knob, value)
        else:
            new = tuple(
                _apply_change(each, knob, value) if axis == hiding.axis else each
                for axis, each in enumerate(old)
            )
        truth = replace(truth, **{hiding.field: new})
    return truth


def true_values(
    truth: VehicleTruth, file: VehicleTruth, hidden: Mapping[str, float]
) -> dict[str, Any]:
    """
    Return the true parameters of the hidden effects, as the effect library defines them.

    `truth`, `file`: vehicle with hidden effects, and vehicle of the file. `hidden`: hidden
    parameters and their values.
    """
    out: dict[str, dict[str, float]] = {}
    for knob in hidden:
        effect, _, parameter = knob.partition('.')
        hiding = HIDINGS[knob]
        number: Any = getattr(truth, hiding.field)
        begun: Any = getattr(file, hiding.field)
        if hiding.axis is not None:
            number, begun = number[hiding.axis], begun[hiding.axis]
        if knob == 'motor_lag':
            lag, _ = approximate_lag(truth)
            out[effect] = {'up': lag, 'down': lag}
            continue
        if effect == 'quadratic_drag':
            # The parameter of the library is the total quadratic drag
            number += truth.drag[hiding.axis or 0]
        elif knob == 'command_delay.delay':
            number += approximate_lag(truth)[1]
        elif effect in ('cg_height', 'cg_offset'):
            number -= begun  # the library defines these relative to the vehicle file
        elif knob in SHARES:
            # Field: remaining share; parameter: lost share
            number = 1.0 - number
        out.setdefault(effect, {})[parameter] = float(number)
    return out
