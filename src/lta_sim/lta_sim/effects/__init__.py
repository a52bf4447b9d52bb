"""
The effects of which the model is the sum, by name.

The order of BUILT_IN is the layout of the parameter vector and of the memory; effects installed by
others under the entry point group `lta.effects` follow in alphabetical order of their names.
"""

from importlib import import_module
from importlib.metadata import entry_points

from lta_config.errors import BadInput, unknown
from lta_config.quantity import UNITS
from lta_sim.effects.protocol import ActuatorEffect, Effect, KernelEffect
from lta_sim.state import ACTUATORS

GROUP = 'lta.effects'
BUILT_IN = (  # each is the file of this name
    'steady_wind',
    'wind_profile',
    'wind_gradient',
    'turbulence',
    'gusts',
    'gas_purity',
    'gas_state',
    'air_state',
    'ballast',
    'payload',
    'cg_height',
    'cg_offset',
    'weight_and_buoyancy',
    'net_lift',
    'helium_leak',
    'superheat',
    'moving_mass',
    'added_mass',
    'added_inertia',
    'linear_drag',
    'quadratic_drag',
    'rotational_drag',
    'cross_flow',
    'munk_moment',
    'hull_lift',
    'strip_damping',
    'battery_compensation',
    'battery_sag',
    'motor_deadband',
    'motor_lag',
    'thrust_polynomial',
    'thrust_curve',
    'thrust_scale',
    'rotor_fault',
    'rotor_thrust',
    'rotor_misalignment',
    'rotor_envelope_interaction',
    'ground_effect',
    'ceiling_effect',
    'walls',
    'floor_contact',
    'command_delay',
    'imu_bias',
    'gyro_scale',
    'gyro_bias',
    'pressure_drift',
    'range_offset',
    'tracker_misalignment',
    'tracker_delay',
    'clock_offset',
    'clock_skew',
)


def merged(known: dict[str, Effect]) -> dict[str, Effect]:
    """
    Return the built-in effects and then the installed ones.

    Raises
    ------
    BadInput
        If an installed effect takes a name that exists, is no effect, or has a parameter in a
        unit that no file could give it in.

    """
    effects = dict(known)
    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        effect = point.load()
        if not isinstance(effect, Effect):
            raise BadInput(
                f'The entry point {point.name} of {GROUP} is {point.value}, which is no effect; '
                'let it name a WrenchEffect or another kind of lta_sim.effects.protocol.'
            )
        if not effect.name.isidentifier():
            raise BadInput(
                f'The effect {effect.name!r} of {point.value} has no name that code can use; '
                'take letters, digits and underscores.'
            )
        if effect.name in effects:
            raise BadInput(
                f'The effect {effect.name} of {point.value} exists already; '
                'rename or uninstall it.'
            )
        for parameter in effect.parameters:
            if UNITS.get(parameter.unit) != (parameter.unit, 1.0):
                raise BadInput(
                    f'The parameter {effect.name}.{parameter.name} of {point.value} is in '
                    f'{parameter.unit!r}, which is no SI unit that files know; take one of '
                    f'{", ".join(sorted({unit for unit, _ in UNITS.values()}))}.'
                )
        effects[effect.name] = effect
    return effects


EFFECTS: dict[str, Effect] = merged(
    {name: import_module(f'{__name__}.{name}').EFFECT for name in BUILT_IN}
)


def built_in() -> dict[str, Effect]:
    """Return the effects of the library, without those that others installed."""
    return {name: EFFECTS[name] for name in BUILT_IN}


def get(name: str) -> Effect:
    """
    Return an effect by name.

    Raises
    ------
    BadInput
        If there is none; the sentence names the known ones.

    """
    if name not in EFFECTS:
        raise unknown('effect', name, list(EFFECTS))
    return EFFECTS[name]


def initial_memory() -> tuple[float, ...]:
    """Return the initial memory of all effects, in the layout of the state."""
    return tuple(
        value
        for effect in EFFECTS.values()
        if isinstance(effect, KernelEffect)
        for _ in range(ACTUATORS if isinstance(effect, ActuatorEffect) else 1)
        for _, value in effect.memory
    )
