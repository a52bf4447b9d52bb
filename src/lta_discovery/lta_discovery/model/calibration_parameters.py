# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define the calibration parameters: numbers that any vehicle file must have, with wide priors.

Discovery takes them as tolerances of a file that was measured. A calibration takes them as unknown
within `CALIBRATION`. Everything else that discovery can name is an effect, which a model may lack.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
import math
from typing import Final

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.model.candidates import DIFF_STEP
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import (
    CALIBRATION,
    FreeParameter,
    list_free_parameters,
    NET_LIFT_FORCE,
)
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import AirEffect, AXES
from lta_model.state import ACTUATORS
import numpy as np

DUTY_PARAMETERS: Final = ('rotor_', 'motor_lag')  # of vehicles that are commanded by duties
HEADING: Final = 'tracker_misalignment.yaw'
HEADING_SIZE: Final = 0.2  # rad; heading of the tracker, where the vehicle file has moving air
NET_LIFT_TOLERANCE: Final = 0.01  # of the weight; net lift of a flight
LIFT_TREND: Final = 4e-5  # of the weight per second; change of the lift in a flight
THRUST: Final = 1.0  # relative; each rotor
REVERSE: Final = 0.5  # relative; share of its thrust that a rotor has in reverse
REVERSED_DUTY: Final = -0.05  # duty; a rotor that gets a lower one is flown in reverse
# Relative, and tolerances in the vehicle file. Added mass follows from the size of the hull.
FLOWS: Final = {
    'linear_drag': 0.3,
    'quadratic_drag': 0.3,
    'hull_lift': 0.3,
    'oblique_lift': 0.3,
    'added_mass': 0.1,
    'added_inertia': 0.1,
}
FLYING: Final = 0.5  # m/s; speed at which linear and quadratic drag are compared
TURNING: Final = 0.5  # rad/s; rate at which linear and quadratic damping are compared
CROSS: Final = 0.5  # what a command does on another axis, by the RMS commands of both
ROTOR_ARM: Final = 0.3  # m; of rotors below the hull centre
MEASURED: Final = 0.05  # tolerance of these in a vehicle file that was measured
PER_FLIGHT: Final = frozenset({NET_LIFT_FORCE, 'helium_leak.rate'})
# With poses alone the clock of the flight is that of the tracker
POSE_ONLY: Final = frozenset({'clock_offset.offset'})
LARGEST_GAIN: Final = 20.0  # largest gain
THRUST_CHANGE: Final = 4.0  # largest relative change of a rotor's thrust, which may turn it around
BACKWARD: Final = 0.95  # largest relative loss in reverse
EXPONENTS: Final = (0.5, 3.0)  # bounds of the exponent of a commanded force
REVERSES: Final = (0.05, 5.0)  # bounds of the share of a commanded force that acts in reverse
COMMAND_SPREAD: Final = 0.1  # of the mean size of a command; a larger spread shows its exponent
GAIN_NAMES: Final = frozenset(f'wrench_gain.{axis}' for axis in AXES)
LARGEST_MASS_FACTOR: Final = 1.2  # largest logarithm of a factor on mass and inertia


def prior_deviation(knob: FreeParameter, nominal: NominalVehicle) -> float:
    """Return the standard deviation of a parameter before a calibration; 0 for an effect."""
    weight, effect = STANDARD_GRAVITY * nominal.mass, knob.name.partition('.')[0]
    if knob.name == NET_LIFT_FORCE:
        return NET_LIFT_TOLERANCE * weight
    if knob.name == 'helium_leak.rate':
        return LIFT_TREND * weight
    if knob.name.startswith('rotor_') and knob.name.endswith('.thrust'):
        return THRUST
    if knob.name.endswith('.reverse'):
        return REVERSE
    if knob.name == HEADING:
        return HEADING_SIZE if has_map_fixed_air(nominal) else 0.0
    if effect == 'rotor_misalignment':
        # As in a file that was measured: without it, the markers would turn instead
        return knob.tolerance
    if effect == 'rotational_drag':
        return _damping_deviation(knob.name.partition('.')[2], nominal)
    if effect == 'linear_drag':
        return _drag_deviation(knob.name.partition('.')[2], nominal)
    if '_from_' in knob.name:
        return knob.tolerance
    if effect in FLOWS:
        # The tolerance of the file is a share of its value
        return knob.tolerance * FLOWS[effect] / MEASURED
    return CALIBRATION.get(knob.name, 0.0)


def has_map_fixed_air(nominal: NominalVehicle) -> bool:
    """
    Return whether the vehicle file has moving air, which alone is fixed to the map.

    Without it, a vehicle flies alike in every direction: no flight shows how the map is turned.
    """
    return any(
        isinstance(EFFECTS.get(effect), AirEffect) and any(values.values())
        for effect, values in nominal.effect_parameters.items()
    )


def _drag_deviation(axis: str, nominal: NominalVehicle) -> float:
    """
    Return the deviation of a linear drag: the whole drag at a usual speed.

    An estimate from the hull alone has none, which fins, strings and slow flow give.
    """
    linear, square = (
        abs(nominal.parameter_value(f'{kind}_drag', axis)) for kind in ('linear', 'quadratic')
    )
    return max(FLOWS['linear_drag'] * linear, FLYING * square)


def _damping_deviation(name: str, nominal: NominalVehicle) -> float:
    """
    Return the deviation of a damping of rotation: the whole damping of the most damped axis.

    Swings show how it divides into a linear and a quadratic part, one of which the file may lack.
    An estimate from the hull alone has hardly any damping in roll, where fins and gondola give it.
    """
    linear, square = (
        max(abs(nominal.parameter_value('rotational_drag', f'{axis}{end}')) for axis in AXES[3:])
        for end in ('', '_2')
    )
    if name.endswith('_2'):
        return max(square, linear / TURNING)
    return max(linear, TURNING * square)


# Tolerances of calibrated numbers that have none in discovery: a frame set by eye.
BY_EYE: Final[dict[str, float]] = {
    **{f'marker_offset.{axis}': 0.02 for axis in 'xyz'},
    **{f'marker_offset.{angle}': math.radians(2.0) for angle in ('yaw', 'pitch', 'roll')},
    'tracker_misalignment.pitch': math.radians(0.5),
    'tracker_misalignment.roll': math.radians(0.5),
    HEADING: math.radians(2.0),
    **{f'rotor_{i}.reverse': 0.05 for i in range(1, ACTUATORS + 1)},
    **{f'wrench_gain.{kind}_{axis}': 0.05 for kind in ('exponent', 'reverse') for axis in AXES},
    'helium_leak.rate': 5e-5,
}


def ordinary_tolerances(nominal: NominalVehicle) -> dict[str, float]:
    """Return the tolerance of each parameter of a vehicle that was measured with care."""
    tolerances = {knob.name: knob.tolerance for knob in list_free_parameters(nominal, wrench=True)}
    return {**tolerances, **BY_EYE}


def list_calibration_parameters(
    nominal: NominalVehicle,
    commanded: Sequence[bool],
    only_pose: bool,
    reversed_rotors: Sequence[int] = (),
    laws: Mapping[str, float] | None = None,
) -> list[FreeParameter]:
    """
    Return the parameters of a calibration, with their deviations before it as tolerances.

    `commanded`: axes on which a wrench was commanded; none for vehicles commanded by duties,
    sequence of 6 bool. `only_pose`: whether nothing but the pose was measured. `reversed_rotors`:
    numbers, from 1, of the rotors that are flown in reverse. `laws`: what else a commanded wrench
    can show of `wrench_gain`, with deviations (`list_wrench_laws`).
    """
    out, units = [], {one.name: one.unit for one in EFFECTS['wrench_gain'].parameters}
    for knob in [
        *list_free_parameters(nominal, any(commanded)),
        *list_marker_parameters(),
        *(build_reverse_parameter(nominal, i) for i in reversed_rotors),
        *(
            FreeParameter(
                f'wrench_gain.{name}',
                units[name],
                {('wrench_gain', name): 1.0},
                DIFF_STEP,
                DIFF_STEP,
                wide,
            )
            for name, wide in (laws or {}).items()
        ),
    ]:
        wide = prior_deviation(knob, nominal)
        effect, _, part = knob.name.partition('.')
        kind = EFFECTS.get(effect)
        uncommanded = knob.name in GAIN_NAMES and not commanded[AXES.index(part)]
        unseen = only_pose and (
            knob.name in POSE_ONLY
            or getattr(kind, 'channel', 'pose') in ('rates', 'force', 'range', 'pressure')
        )
        unmoved = any(commanded) and knob.name.startswith(DUTY_PARAMETERS)
        if wide == 0.0 or uncommanded or unseen or unmoved:
            continue
        low, high = knob.low, knob.high
        if knob.name in GAIN_NAMES:
            low, high = -LARGEST_GAIN, LARGEST_GAIN
        elif effect == 'wrench_gain' and part.startswith(('exponent', 'reverse')):
            ends = EXPONENTS if part.startswith('exponent') else REVERSES
            low, high = (end - nominal.parameter_value(effect, part) for end in ends)
        elif knob.name.endswith('.thrust'):
            low, high = -THRUST_CHANGE, THRUST_CHANGE - 2.0
        elif knob.name.endswith('.reverse'):
            low, high = -BACKWARD, THRUST_CHANGE
        elif effect == 'vehicle':
            low, high = -LARGEST_MASS_FACTOR, LARGEST_MASS_FACTOR
        elif knob.name == 'helium_leak.rate':
            low = -math.inf
        out.append(
            replace(
                knob,
                tolerance=wide,
                typical=0.0,
                low=low,
                high=high,
                per_flight=knob.per_flight or knob.name in PER_FLIGHT,
            )
        )
    return out


def list_marker_parameters() -> list[FreeParameter]:
    """Return the parameters of the markers' frame."""
    return [
        FreeParameter(
            f'marker_offset.{parameter.name}',
            parameter.unit,
            {('marker_offset', parameter.name): 1.0},
            1e-3,
            1e-3,
            low=parameter.low,
            high=parameter.high,
        )
        for parameter in EFFECTS['marker_offset'].parameters
    ]


def build_reverse_parameter(nominal: NominalVehicle, rotor: int) -> FreeParameter:
    """
    Return the relative change of what a rotor (1 is the first) pushes in reverse.

    The model has the wrench of reversed thrust in `rotor_envelope_interaction`, as what it differs
    by from that of forward thrust.
    """
    moves = {
        ('rotor_envelope_interaction', f'{axis}_{rotor}'): number
        for axis, number in zip(AXES, reversed_column(nominal, rotor), strict=True)
    }
    return FreeParameter(f'rotor_{rotor}.reverse', '1', moves, DIFF_STEP, DIFF_STEP)


def reversed_column(nominal: NominalVehicle, rotor: int) -> list[float]:
    """Return the wrench per newton of reversed thrust of a rotor (1 is the first) [1, m]."""
    return [
        nominal.parameter_value('rotor_thrust', f'{axis}_{rotor}')
        + nominal.parameter_value('rotor_envelope_interaction', f'{axis}_{rotor}')
        for axis in AXES
    ]


def list_reversed_rotors(
    duties: Sequence[np.ndarray[tuple[int, int], np.dtype[np.float64]]], reversible: Sequence[bool]
) -> list[int]:
    """
    Return the numbers, from 1, of the rotors that are flown in reverse.

    `duties`: commands of each flight, shape (n, rotors).
    """
    return [
        i + 1
        for i, both in enumerate(reversible)
        if both and any(bool((each[:, i] < REVERSED_DUTY).any()) for each in duties if len(each))
    ]


def commanded_axes(wrench: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> list[bool]:
    """Return on which axes a wrench, shape (n, 6), was commanded."""
    return [bool(size > 0.0) for size in np.ptp(wrench, axis=0)]


def list_wrench_laws(
    commands: np.ndarray[tuple[int, int], np.dtype[np.float64]],
) -> dict[str, float]:
    """
    Return the parameters of `wrench_gain` beyond the gains that commands can show, by deviation.

    An exponent needs commands of several sizes, a reverse commands of either sign, and what a
    command does on other axes varying commands. `commands`: of a wrench, shape (n, 6).
    """
    out: dict[str, float] = {}
    if not len(commands):
        return out
    for axis, column in zip(AXES, commands.T, strict=True):
        sizes = np.abs(column[column != 0.0])
        if len(sizes) and sizes.std() > COMMAND_SPREAD * sizes.mean():
            out[f'exponent_{axis}'] = CALIBRATION[f'wrench_gain.exponent_{axis}']
        ends = -float(column.min(initial=0.0)), float(column.max(initial=0.0))
        if min(ends) > -REVERSED_DUTY * max(ends):
            out[f'reverse_{axis}'] = CALIBRATION[f'wrench_gain.reverse_{axis}']
    usual = dict(zip(AXES, np.sqrt(np.mean(np.square(commands), axis=0)).tolist(), strict=True))
    for one in EFFECTS['wrench_gain'].parameters:
        axis, across, source = one.name.removesuffix('_size').partition('_from_')
        if across and usual[source] > 0.0 and np.ptp(commands[:, AXES.index(source)]) > 0.0:
            # A vehicle whose moments are not commanded has rotors somewhere below the hull
            share = CROSS * usual[axis] / usual[source]
            out[one.name] = ROTOR_ARM if axis in AXES[3:] else share
    return {name: deviation for name, deviation in out.items() if deviation > 0.0}


def set_references(
    nominal: NominalVehicle, commands: np.ndarray[tuple[int, int], np.dtype[np.float64]]
) -> NominalVehicle:
    """
    Return a vehicle whose gains hold at the size of the commands of a wrench, shape (n, 6).

    There the gain is known best, whatever the exponent. With an exponent of 1 it changes nothing.
    """
    for axis, column in zip(AXES, commands.T, strict=True):
        sizes = np.abs(column[column != 0.0])
        if len(sizes) and nominal.parameter_value('wrench_gain', f'exponent_{axis}') == 1.0:
            # Mean of the logarithms, weighted by the squares, to which errors of the gain belong
            mean = float(np.exp(np.average(np.log(sizes), weights=sizes**2)))
            nominal = nominal.with_value('wrench_gain', f'reference_{axis}', float(f'{mean:.2g}'))
    return nominal
