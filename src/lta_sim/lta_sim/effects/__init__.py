"""
The effects of which the model is the sum, by name.

The order of EFFECTS is the layout of the parameter vector and of the memory; effects installed by
others under the entry point group `lta.effects` follow in alphabetical order of their names.
"""

from importlib.metadata import entry_points

from lta_config.errors import BadInput, unknown
from lta_sim.effects import (
    added_inertia,
    added_mass,
    air_state,
    ballast,
    battery_sag,
    ceiling_effect,
    cg_height,
    cg_offset,
    clock_offset,
    clock_skew,
    command_delay,
    cross_flow,
    floor_contact,
    gas_purity,
    gas_state,
    ground_effect,
    gusts,
    gyro_bias,
    gyro_scale,
    helium_leak,
    hull_lift,
    imu_bias,
    linear_drag,
    motor_deadband,
    motor_lag,
    moving_mass,
    munk_moment,
    net_lift,
    payload,
    pressure_drift,
    quadratic_drag,
    range_offset,
    rotational_drag,
    rotor_envelope_interaction,
    rotor_fault,
    rotor_misalignment,
    rotor_thrust,
    steady_wind,
    strip_damping,
    superheat,
    thrust_curve,
    thrust_polynomial,
    thrust_scale,
    tracker_delay,
    tracker_misalignment,
    turbulence,
    walls,
    weight_and_buoyancy,
    wind_gradient,
    wind_profile,
)
from lta_sim.effects.protocol import ActuatorEffect, Effect, KernelEffect
from lta_sim.state import ACTUATORS

GROUP = 'lta.effects'


def merged(known: dict[str, Effect]) -> dict[str, Effect]:
    """
    Return the built-in effects and then the installed ones.

    Raises
    ------
    BadInput
        If an installed effect takes a name that exists, or is no effect.

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
        effects[effect.name] = effect
    return effects


EFFECTS: dict[str, Effect] = merged(
    {
        'steady_wind': steady_wind.EFFECT,
        'wind_profile': wind_profile.EFFECT,
        'wind_gradient': wind_gradient.EFFECT,
        'turbulence': turbulence.EFFECT,
        'gusts': gusts.EFFECT,
        'gas_purity': gas_purity.EFFECT,
        'gas_state': gas_state.EFFECT,
        'air_state': air_state.EFFECT,
        'ballast': ballast.EFFECT,
        'payload': payload.EFFECT,
        'cg_height': cg_height.EFFECT,
        'cg_offset': cg_offset.EFFECT,
        'weight_and_buoyancy': weight_and_buoyancy.EFFECT,
        'net_lift': net_lift.EFFECT,
        'helium_leak': helium_leak.EFFECT,
        'superheat': superheat.EFFECT,
        'moving_mass': moving_mass.EFFECT,
        'added_mass': added_mass.EFFECT,
        'added_inertia': added_inertia.EFFECT,
        'linear_drag': linear_drag.EFFECT,
        'quadratic_drag': quadratic_drag.EFFECT,
        'rotational_drag': rotational_drag.EFFECT,
        'cross_flow': cross_flow.EFFECT,
        'munk_moment': munk_moment.EFFECT,
        'hull_lift': hull_lift.EFFECT,
        'strip_damping': strip_damping.EFFECT,
        'battery_sag': battery_sag.EFFECT,
        'motor_deadband': motor_deadband.EFFECT,
        'motor_lag': motor_lag.EFFECT,
        'thrust_polynomial': thrust_polynomial.EFFECT,
        'thrust_curve': thrust_curve.EFFECT,
        'thrust_scale': thrust_scale.EFFECT,
        'rotor_fault': rotor_fault.EFFECT,
        'rotor_thrust': rotor_thrust.EFFECT,
        'rotor_misalignment': rotor_misalignment.EFFECT,
        'rotor_envelope_interaction': rotor_envelope_interaction.EFFECT,
        'ground_effect': ground_effect.EFFECT,
        'ceiling_effect': ceiling_effect.EFFECT,
        'walls': walls.EFFECT,
        'floor_contact': floor_contact.EFFECT,
        'command_delay': command_delay.EFFECT,
        'imu_bias': imu_bias.EFFECT,
        'gyro_scale': gyro_scale.EFFECT,
        'gyro_bias': gyro_bias.EFFECT,
        'pressure_drift': pressure_drift.EFFECT,
        'range_offset': range_offset.EFFECT,
        'tracker_misalignment': tracker_misalignment.EFFECT,
        'tracker_delay': tracker_delay.EFFECT,
        'clock_offset': clock_offset.EFFECT,
        'clock_skew': clock_skew.EFFECT,
    }
)


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
