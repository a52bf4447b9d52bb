"""
Registry of the effects that the model sums.

The order of FILES is the layout of the parameter vector and of the memory; effects installed by
others under the entry point group `lta.effects` follow in alphabetical order of their names.
"""

from importlib import import_module
from importlib.metadata import entry_points

from lta_config.errors import BadInput, unknown_name_error
from lta_config.quantity import UNITS
from lta_model.effects.law import EFFECT as LAW
from lta_model.effects.protocol import ActuatorEffect, Effect, KernelEffect
from lta_model.state import ACTUATORS

GROUP = 'lta.effects'
FILES = (  # folder and file of each; its name is that of the file
    'air.steady_wind',
    'air.wind_profile',
    'air.wind_gradient',
    'air.turbulence',
    'air.gusts',
    'weight.gas_purity',
    'weight.gas_state',
    'weight.air_state',
    'weight.ballast',
    'weight.payload',
    'weight.cg_height',
    'weight.cg_offset',
    'weight.weight_and_buoyancy',
    'weight.net_lift',
    'weight.helium_leak',
    'weight.superheat',
    'weight.moving_mass',
    'aerodynamics.added_mass',
    'aerodynamics.added_inertia',
    'aerodynamics.linear_drag',
    'aerodynamics.quadratic_drag',
    'aerodynamics.rotational_drag',
    'aerodynamics.cross_flow',
    'aerodynamics.munk_moment',
    'aerodynamics.hull_lift',
    'aerodynamics.oblique_lift',
    'aerodynamics.strip_damping',
    'rotors.battery_compensation',
    'rotors.battery_sag',
    'rotors.motor_deadband',
    'rotors.motor_lag',
    'rotors.thrust_polynomial',
    'rotors.thrust_curve',
    'rotors.thrust_scale',
    'rotors.rotor_fault',
    'rotors.rotor_thrust',
    'rotors.rotor_misalignment',
    'rotors.rotor_envelope_interaction',
    'rotors.ground_effect',
    'rotors.ceiling_effect',
    'contact.walls',
    'contact.floor_contact',
    'rotors.command_delay',
    'rotors.wrench_gain',
    'sensors.imu_scale',
    'sensors.imu_bias',
    'sensors.gyro_scale',
    'sensors.gyro_bias',
    'sensors.pressure_drift',
    'sensors.range_offset',
    'sensors.marker_offset',
    'sensors.tracker_misalignment',
    'sensors.tracker_delay',
    'sensors.clock_offset',
    'sensors.clock_skew',
)
BUILT_IN = tuple(path.rpartition('.')[2] for path in FILES)


def merge_installed_effects(library: dict[str, Effect]) -> dict[str, Effect]:
    """
    Return the built-in effects and then the installed ones.

    Raise `BadInput` if an installed effect has an existing or invalid name, is not an effect, or
    has a parameter that is not in an SI unit known to files.
    """
    effects = dict(library)
    # Sorted, so that the memory layout is independent of the installation order
    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        effect = point.load()
        if not isinstance(effect, Effect):
            raise BadInput(
                f'The entry point {point.name} of {GROUP} refers to {point.value}, which '
                'is not an effect; let it refer to a WrenchEffect or another effect class '
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
            if UNITS.get(parameter.unit) != (parameter.unit, 1.0):
                raise BadInput(
                    f'The parameter {effect.name}.{parameter.name} of {point.value} has '
                    f'the unit {parameter.unit!r}, which vehicle files do not accept; use '
                    'one of the SI units '
                    f'{", ".join(sorted({unit for unit, _ in UNITS.values()}))}.'
                )
        effects[effect.name] = effect
    return effects


EFFECTS: dict[str, Effect] = merge_installed_effects(
    {
        name: import_module(f'{__name__}.{path}').EFFECT
        for name, path in zip(BUILT_IN, FILES, strict=True)
    }
)


# What the kernel sums: also the law of a vehicle file, which is data instead of an equation with
# parameters of its own. So nothing that lists, draws, hides or fits effects sees it.
MODEL_EFFECTS: dict[str, Effect] = {**EFFECTS, LAW.name: LAW}


def select_built_in_effects() -> dict[str, Effect]:
    """Return the built-in effects, without those installed by others."""
    return {name: EFFECTS[name] for name in BUILT_IN}


def get_effect(name: str) -> Effect:
    """Return an effect by name; raise `BadInput` with the known names if there is none."""
    effect = EFFECTS.get(name) or MODEL_EFFECTS.get(name)
    if effect is None:
        raise unknown_name_error('effect', name, list(EFFECTS))
    return effect


def initial_memory() -> tuple[float, ...]:
    """Return the initial memory of all effects, in the layout of the state."""
    return tuple(
        value
        for effect in MODEL_EFFECTS.values()
        if isinstance(effect, KernelEffect)
        # An actuator effect has a memory for each rotor
        for _ in range(ACTUATORS if isinstance(effect, ActuatorEffect) else 1)
        for _, value in effect.memory
    )
