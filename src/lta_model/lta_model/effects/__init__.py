# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Registry of the effects that the model sums.

The order of BUILT_IN_EFFECTS is the layout of the parameter vector and of the memory; effects
installed by others under the entry point group `lta.effects` follow in alphabetical order of their
names.
"""

from importlib.metadata import entry_points

from lta_config.errors import BadInput, unknown_name_error
from lta_config.quantity import SI_UNITS
from lta_model.effects import (
    added_mass,
    air,
    commands,
    drag,
    gas,
    hull_lift,
    motors,
    rotors,
    sensors,
    surfaces,
    weight,
)
from lta_model.effects.protocol import ActuatorEffect, Effect, KernelEffect
from lta_model.state import ACTUATORS

ENTRY_POINT_GROUP = 'lta.effects'
BUILT_IN_EFFECTS: tuple[Effect, ...] = (
    air.STEADY_WIND,
    air.WIND_PROFILE,
    air.WIND_GRADIENT,
    air.TURBULENCE,
    air.GUSTS,
    gas.GAS_PURITY,
    gas.GAS_STATE,
    gas.GAS_ROTATION,
    gas.AIR_STATE,
    weight.BALLAST,
    weight.PAYLOAD,
    weight.CG_HEIGHT,
    weight.CG_OFFSET,
    weight.WEIGHT_AND_BUOYANCY,
    weight.NET_LIFT,
    gas.HELIUM_LEAK,
    gas.SUPERHEAT,
    weight.MOVING_MASS,
    added_mass.ADDED_MASS,
    added_mass.ADDED_INERTIA,
    drag.LINEAR_DRAG,
    drag.QUADRATIC_DRAG,
    drag.ROTATIONAL_DRAG,
    drag.CROSS_FLOW,
    added_mass.MUNK_MOMENT,
    hull_lift.HULL_LIFT,
    hull_lift.OBLIQUE_LIFT,
    drag.STRIP_DAMPING,
    motors.BATTERY_COMPENSATION,
    motors.BATTERY_SAG,
    motors.MOTOR_DEADBAND,
    motors.MOTOR_LAG,
    motors.THRUST_POLYNOMIAL,
    motors.THRUST_CURVE,
    motors.THRUST_SCALE,
    motors.ROTOR_FAULT,
    rotors.ROTOR_THRUST,
    rotors.ROTOR_MISALIGNMENT,
    rotors.ROTOR_ENVELOPE_INTERACTION,
    surfaces.GROUND_EFFECT,
    surfaces.CEILING_EFFECT,
    surfaces.WALLS,
    surfaces.FLOOR_CONTACT,
    commands.COMMAND_DELAY,
    commands.WRENCH_GAIN,
    sensors.IMU_SCALE,
    sensors.IMU_BIAS,
    sensors.GYRO_SCALE,
    sensors.GYRO_BIAS,
    sensors.PRESSURE_DRIFT,
    sensors.RANGE_OFFSET,
    sensors.MARKER_OFFSET,
    sensors.TRACKER_MISALIGNMENT,
    sensors.TRACKER_DELAY,
    sensors.CLOCK_OFFSET,
    sensors.CLOCK_SKEW,
)
BUILT_IN = tuple(effect.name for effect in BUILT_IN_EFFECTS)


def merge_installed_effects(library: dict[str, Effect]) -> dict[str, Effect]:
    """
    Return the built-in effects and then the installed ones.

    Raise `BadInput` if an installed effect has an existing or invalid name, is not an effect, or
    has a parameter that is not in an SI unit known to files.
    """
    effects = dict(library)
    # Sorted, so that the memory layout is independent of the installation order
    for point in sorted(entry_points(group=ENTRY_POINT_GROUP), key=lambda point: point.name):
        effect = point.load()
        if not isinstance(effect, Effect):
            raise BadInput(
                f'The entry point {point.name} of {ENTRY_POINT_GROUP} refers to {point.value}, '
                'which is not an effect; let it refer to a WrenchEffect or another effect class '
                'of lta_model.effects.protocol.'
            )
        if not effect.name.isidentifier():
            raise BadInput(
                f'The effect name {effect.name!r} of {point.value} is not valid; '
                'use letters, digits and underscores.'
            )
        if effect.name in effects:
            raise BadInput(
                f'The name of the effect {effect.name} of {point.value} is already used by '
                'another effect; rename or uninstall it.'
            )
        for parameter in effect.parameters:
            # Factor 1: the kernel computes in SI units, so 'g' or 'deg' are refused
            if SI_UNITS.get(parameter.unit) != (parameter.unit, 1.0):
                raise BadInput(
                    f'The parameter {effect.name}.{parameter.name} of {point.value} has '
                    f'the unit {parameter.unit!r}, which vehicle files do not accept; use '
                    'one of the SI units '
                    f'{", ".join(sorted({unit for unit, _ in SI_UNITS.values()}))}.'
                )
        effects[effect.name] = effect
    return effects


EFFECTS: dict[str, Effect] = merge_installed_effects(
    {effect.name: effect for effect in BUILT_IN_EFFECTS}
)


def select_built_in_effects() -> dict[str, Effect]:
    """Return the built-in effects, without those installed by others."""
    return {name: EFFECTS[name] for name in BUILT_IN}


def get_effect(name: str) -> Effect:
    """Return an effect by name; raise `BadInput` with the known names if there is none."""
    effect = EFFECTS.get(name)
    if effect is None:
        raise unknown_name_error('effect', name, list(EFFECTS))
    return effect


def initial_memory() -> tuple[float, ...]:
    """Return the initial memory of all effects, in the layout of the state."""
    return tuple(
        value
        for effect in EFFECTS.values()
        if isinstance(effect, KernelEffect)
        # An actuator effect has a memory for each rotor
        for _ in range(ACTUATORS if isinstance(effect, ActuatorEffect) else 1)
        for _, value in effect.memory
    )
