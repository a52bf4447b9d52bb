# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define the free parameters of a vehicle: tolerances, per-flight errors, and candidates.

A free parameter moves some model parameters together, in its own unit. Its tolerance is the
standard deviation of the nominal model, as a *nuisance*; its typical size is that of the effect,
as a *candidate*. Some are both: a thrust error of 3 % is tolerance, one of 10 % is a discovery.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
import math
from typing import Final, final, Literal

from lta_config.errors import BadInput
from lta_discovery.model.candidates import (
    companion_values,
    DESIGN,
    DIFF_STEP,
    fine_step,
    first_step,
    FITTED,
    JOINT_PARAMETERS,
    NO_CANDIDATE,
    SIGNS,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import ActuatorEffect, AXES, MeasurementEffect, WrenchEffect
from lta_model.state import ACTUATORS
import numpy as np
from numpy.typing import NDArray

NET_LIFT_FORCE: Final = 'net_lift.force'
Target = tuple[str, str]
Reach = Literal['chain', 'wrench', 'body', 'memory', 'reading', 'delay']


@final
@dataclass(frozen=True, slots=True)
class FreeParameter:
    """A direction in which a model can differ from the vehicle file."""

    name: str  # 'thrust_scale.factor', or of the vehicle itself 'vehicle.mass'
    unit: str
    # Change of each model parameter per unit. The effect 'vehicle' has `mass`, and `roll`,
    # `pitch`, `yaw` of the inertia, as logarithms of a factor.
    moves: Mapping[Target, float]
    step: float  # of the finite difference at 0
    fine: float  # of the finite difference elsewhere
    # Standard deviation of the nominal model's error; 0 where there is none
    tolerance: float = 0.0
    typical: float = 0.0  # standard deviation of the effect if present; 0 if it is not a candidate
    low: float = -math.inf
    high: float = math.inf
    per_flight: bool = False  # whether its error differs from flight to flight
    # Initial parameters of an absent effect; with these and a value of 0, the effect changes
    # nothing
    companions: Mapping[Target, float] = field(default_factory=dict)

    def apply_to(self, nominal: NominalVehicle, value: float) -> NominalVehicle:
        """Return the vehicle with this parameter increased by a value."""
        nominal = self.enable_effect(nominal)
        for (effect, parameter), rate in self.moves.items():
            if effect == 'vehicle':
                # Logarithmic, so that successive changes add up, as linearization assumes.
                nominal = _scale_mass_properties(nominal, parameter, math.exp(rate * value))
            else:
                now = nominal.parameter_value(effect, parameter)
                nominal = nominal.with_value(effect, parameter, now + rate * value)
        return nominal

    def enable_effect(self, nominal: NominalVehicle) -> NominalVehicle:
        """Return the vehicle with the effect present, but without influence yet."""
        absent = {target[0] for target in self.companions} - set(nominal.effect_parameters)
        for (effect, parameter), companion in self.companions.items():
            # Parameters that the vehicle file sets stay as they are
            if effect in absent:
                nominal = nominal.with_value(effect, parameter, companion)
        return nominal

    def step_at(self, value: float) -> float:
        """Return the step of the finite difference at a value, turned around at a bound."""
        step = self.step if value == 0.0 else self.fine
        # The model may reject values outside the bounds
        return step if self.low <= value + step <= self.high else -step

    @property
    def is_calibration(self) -> bool:
        """Whether it is a number that any vehicle file must have, instead of an effect."""
        return is_calibration(self.name)

    @property
    def channels(self) -> set[str]:
        """Channels of the measurement effects that it changes; '' for other effects."""
        kinds = [EFFECTS.get(effect) for effect, _ in self.moves]
        return {kind.channel if isinstance(kind, MeasurementEffect) else '' for kind in kinds}

    @property
    def reaches(self) -> Reach:
        """Part of the replay that has to be recomputed when it changes."""
        effects = {effect for effect, _ in self.moves}
        if 'wrench_gain' in effects:
            return 'wrench'
        kinds = {effect: EFFECTS.get(effect) for effect in effects}
        if any(isinstance(kind, ActuatorEffect) for kind in kinds.values()):
            return 'chain'
        if 'command_delay' in effects:
            return 'delay'
        if any(isinstance(kind, MeasurementEffect) for kind in kinds.values()):
            return 'reading'
        return 'memory' if any(getattr(kind, 'memory', ()) for kind in kinds.values()) else 'body'


def _scale_mass_properties(nominal: NominalVehicle, what: str, factor: float) -> NominalVehicle:
    """Return the vehicle with its mass (at constant net lift) or one axis of inertia scaled."""
    if what == 'mass':
        more = nominal.mass * (factor - 1.0)
        # A vehicle heavier than air has no lift to keep.
        lifted = nominal.displaced + more if nominal.displaced > 0.0 else 0.0
        return replace(nominal, mass=nominal.mass + more, displaced=lifted)
    inertia, axis = nominal.inertia.copy(), ('roll', 'pitch', 'yaw').index(what)
    # Row and column by the root: the diagonal scales by the factor, symmetry is kept
    inertia[axis, :] *= math.sqrt(factor)
    inertia[:, axis] *= math.sqrt(factor)
    return replace(nominal, inertia=inertia)


# Relative tolerances of parameters.
RELATIVE_TOLERANCES: Final[dict[str, float]] = {
    'linear_drag': 0.05,
    'quadratic_drag': 0.05,
    'rotational_drag': 0.05,
    'added_mass': 0.05,
    'added_inertia': 0.05,
}
# Relative tolerances of whole effects, for all parameters in which the effect is linear.
WHOLE: Final[dict[str, float]] = {
    'strip_damping': 0.1,
    'hull_lift': 0.05,
    'oblique_lift': 0.5,
    'rotor_envelope_interaction': 0.2,
}
# Bounds of the relative change of an effect that a vehicle of the same kind may lack.
ABSENT_EFFECT_BOUNDS: Final = {'oblique_lift': (-1.0, 1.0)}
# Tolerances of numbers that a vehicle file has from computed flows, which nobody measured.
COMPUTED: Final[dict[str, float]] = {'munk_moment.lost': 0.2, 'gas_rotation.share': 0.05}
# Tolerances of every vehicle (standard deviations), in the unit of the parameter.
TOLERANCES: Final[dict[str, float]] = {
    'vehicle.mass': 0.01,
    'vehicle.roll': 0.04,
    'vehicle.pitch': 0.04,
    'vehicle.yaw': 0.04,
    'thrust_scale.factor': 0.03,
    'cg_height.z': 0.003,
    'cg_offset.x': 0.0005,
    'cg_offset.y': 0.0005,
    'motor_lag': 0.006,
    'command_delay.delay': 0.005,
}
# Of a change of the motors' lag; deviation of the delay beside it. Stages in series, of speed
# controller, motor and propeller, act as one stage after a delay: two equal ones as one with 1.41
# times their time constant after 0.59 times it, which is 0.41 of that lag
DELAY_WITH_LAG: Final = 0.2
THRUST_SPREAD: Final = 0.02  # of the thrust of each
GAIN_SPREAD: Final = 0.2  # of each axis of a commanded wrench, which is rarely met exactly
WITHIN: Final = (-0.5, 1.0)  # bounds of relative changes of mass, inertia, thrust
TOE: Final = 0.5 * math.pi / 180.0  # rad; misalignment of a rotor axis
# Calibration: numbers that any vehicle file must have, unlike effects, which it may lack. Their
# standard deviations where nothing was measured (`model.calibration_parameters`).
CALIBRATION: Final[dict[str, float]] = {
    **{f'wrench_gain.{axis}': 2.0 for axis in AXES},
    **{f'wrench_gain.exponent_{axis}': 0.4 for axis in AXES},
    **{f'wrench_gain.reverse_{axis}': 0.4 for axis in AXES},
    'command_delay.delay': 0.2,
    'motor_lag': 0.02,
    NET_LIFT_FORCE: 0.03,
    **{f'marker_offset.{axis}': 0.1 for axis in 'xyz'},
    **{f'marker_offset.{angle}': 0.2 for angle in ('yaw', 'pitch', 'roll')},
    'tracker_misalignment.pitch': 0.03,
    'tracker_misalignment.roll': 0.03,
    'clock_offset.offset': 0.1,
    'vehicle.mass': 0.03,
    'vehicle.roll': 0.3,
    'vehicle.pitch': 0.3,
    'vehicle.yaw': 0.3,
    'cg_height.z': 0.02,
    'cg_offset.x': 0.01,
    'cg_offset.y': 0.01,
    'gyro_bias.x': 0.03,
    'gyro_bias.y': 0.03,
    'gyro_bias.z': 0.03,
    'gyro_scale.x': 0.03,
    'gyro_scale.y': 0.03,
    'gyro_scale.z': 0.03,
    'imu_scale.x': 0.03,
    'imu_scale.y': 0.03,
    'imu_scale.z': 0.03,
    'imu_bias.x': 0.3,
    'imu_bias.y': 0.3,
    'imu_bias.z': 0.3,
    'range_offset.offset': 0.05,
    'pressure_drift.rate': 0.0035,
}


def is_calibration(name: str) -> bool:
    """Return whether a parameter is a number that any vehicle file must have."""
    return name in CALIBRATION or '_from_' in name or name.endswith(('.thrust', '.reverse'))


# Standard deviations between flights: sensor biases and lift.
TRIMS: Final[dict[str, float]] = {
    'gyro_bias.x': 0.01,
    'gyro_bias.y': 0.01,
    'gyro_bias.z': 0.01,
    'gyro_scale.x': 0.006,
    'gyro_scale.y': 0.006,
    'gyro_scale.z': 0.006,
    'imu_scale.x': 0.006,
    'imu_scale.y': 0.006,
    'imu_scale.z': 0.006,
    'imu_bias.x': 0.115,
    'imu_bias.y': 0.115,
    'imu_bias.z': 0.115,
    'range_offset.offset': 0.012,
    'pressure_drift.rate': 0.0035,
    NET_LIFT_FORCE: 0.0006,
    'clock_offset.offset': 0.002,
}


def _list_effect_parameters(nominal: NominalVehicle, effect: str) -> Iterator[FreeParameter]:
    parameters = {first.name: first for first in EFFECTS[effect].parameters}
    together = JOINT_PARAMETERS.get(effect)
    begun = {} if effect in nominal.effect_parameters else companion_values(effect)
    for group in [together] if together else [(name,) for name in parameters]:
        first = parameters[group[0]]
        name = effect if together else f'{effect}.{first.name}'
        if name in NO_CANDIDATE or first.beside is not None:
            continue
        now = begun.get(first.name, nominal.parameter_value(effect, first.name))
        least, most = SIGNS.get(name, (-math.inf, math.inf))
        # A present effect stays at or above its lower bound; only absent ones may start at null.
        lowest = first.low if now >= first.low else min(first.low, first.null)
        # Bounds are of the change from the vehicle file
        low, high = max(lowest, least) - now, min(first.high, most) - now
        moves = {(effect, one): 1.0 for one in group}
        tolerance = RELATIVE_TOLERANCES.get(effect, 0.0) * abs(now)
        if effect in nominal.effect_parameters:
            tolerance = COMPUTED.get(name, tolerance)
        if effect == 'quadratic_drag' and 'cross_flow' in nominal.effect_parameters:
            moves['cross_flow', first.name] = 1.0  # one coefficient, which both work with
        yield FreeParameter(
            name,
            first.unit,
            moves,
            first_step(name, first),
            fine_step(name, first),
            TOLERANCES.get(name, TRIMS.get(name, tolerance)),
            first.spread,
            low,
            high,
            name in TRIMS,
            {(effect, other): value for other, value in begun.items()},
        )


def _list_vehicle_tolerances(nominal: NominalVehicle) -> Iterator[FreeParameter]:
    """Yield the tolerances that are not parameters of an effect."""
    for part in ('mass', 'roll', 'pitch', 'yaw'):
        name = f'vehicle.{part}'
        yield FreeParameter(
            name,
            '1',
            {('vehicle', part): 1.0},
            DIFF_STEP,
            DIFF_STEP,
            TOLERANCES[name],
            0.0,
            *WITHIN,
        )
    for i in range(1, min(len(nominal.rotors), ACTUATORS) + 1):
        # The thrust is linear in a and b: rates equal to their values scale it relatively
        curve = {
            ('thrust_curve', f'{c}_{i}'): nominal.parameter_value('thrust_curve', f'{c}_{i}')
            for c in 'ab'
        }
        yield FreeParameter(
            f'rotor_{i}.thrust', '1', curve, DIFF_STEP, DIFF_STEP, THRUST_SPREAD, 0.0, *WITHIN
        )
    for effect, share in WHOLE.items():
        kind, values = EFFECTS[effect], nominal.effect_parameters.get(effect, {})
        linear = kind.linear_in if isinstance(kind, WrenchEffect) else ()
        numbers = {(effect, one): values[one] for one in linear if values.get(one)}
        if numbers:
            bounds = ABSENT_EFFECT_BOUNDS.get(effect, WITHIN)
            yield FreeParameter(
                f'{effect}.all', '1', numbers, DIFF_STEP, DIFF_STEP, share, 0.0, *bounds
            )


def _list_wrench_gains() -> Iterator[FreeParameter]:
    """Yield the gain of a commanded wrench on each axis: a tolerance, not a candidate."""
    for axis in AXES:
        moves = {('wrench_gain', axis): 1.0}
        yield FreeParameter(
            f'wrench_gain.{axis}', '1', moves, DIFF_STEP, DIFF_STEP, GAIN_SPREAD, 0.0, -1.0, 2.0
        )


def list_free_parameters(nominal: NominalVehicle, wrench: bool = False) -> list[FreeParameter]:
    """
    Return the free parameters of a vehicle, nuisances and candidates.

    Left out are design effects (`DESIGN`), rotors that the vehicle does not have, and parameters
    that the model rejects.

    `wrench`: whether a flight was commanded by forces and moments instead of duties.
    """
    out = [*_list_vehicle_tolerances(nominal), *(_list_wrench_gains() if wrench else ())]
    rotors = len(nominal.rotors)
    for effect in EFFECTS:
        fitted = FITTED.get(effect, ()) if effect in nominal.effect_parameters else ()
        # Design effects are no candidates, unless some of their values were fitted
        if effect in DESIGN and not fitted:
            continue
        for knob in _list_effect_parameters(nominal, effect):
            if fitted and knob.name.partition('.')[2] not in fitted:
                continue
            last = knob.name.rpartition('_')[2]
            # Names such as 'first_3' end with the number of a rotor
            if last.isdigit() and int(last) > rotors and effect.startswith('rotor'):
                continue
            if effect == 'rotor_misalignment':
                knob = replace(knob, tolerance=TOE)
            if _is_buildable(nominal, knob):
                out.append(knob)
    return out


def _is_buildable(nominal: NominalVehicle, knob: FreeParameter) -> bool:
    """Return whether the model accepts a step of the parameter."""
    try:
        knob.apply_to(nominal, knob.step_at(0.0)).build_model()
    except BadInput:
        return False
    return True


def apply_parameters(
    nominal: NominalVehicle, parameters: Sequence[FreeParameter], values: NDArray[np.float64]
) -> tuple[NominalVehicle, NDArray[np.float64]]:
    """Return the vehicle with the parameters set, and the values clipped to their bounds."""
    out = values.copy()
    for k, one in enumerate(parameters):
        out[k] = min(max(values[k], one.low), one.high)
        # A value of 0 must leave the vehicle unchanged: applying it would enable the effect
        if out[k] != 0.0:
            nominal = one.apply_to(nominal, float(out[k]))
    return nominal, out
