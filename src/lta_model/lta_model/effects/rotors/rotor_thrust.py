"""
Wrench of the rotors on the vehicle.

    (F, N) = B T

Column i of B is the wrench about the hull centre per newton of rotor i, including the effect of
its jet on the hull (the paper's thrust allocation). `rotor_envelope_interaction` has the different
effect of a reversed jet and the interaction of jets.
"""

from lta_model.effects.protocol import (
    AXES,
    EffectParameter,
    Values,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_model.state import ACTUATORS

_FORCE = 'spread: 3 % of the thrust, the suction of the jet on a hull in CFD'
_LEVER = 'spread: 1 cm for the position of a rotor; limits: 5 m'

PARAMETERS = tuple(
    EffectParameter(f'{axis}_{i}', '1', 0.0, -1.5, 1.5, 0.03, _FORCE)
    # Force per newton is a pure number, moment per newton a lever arm
    if axis in AXES[:3]
    else EffectParameter(f'{axis}_{i}', 'm', 0.0, -5.0, 5.0, 0.01, _LEVER)
    for axis in AXES
    for i in range(1, ACTUATORS + 1)
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return B times the rotor thrusts."""
    (
        surge_1, surge_2, surge_3, surge_4,
        surge_5, surge_6, surge_7, surge_8,
        sway_1, sway_2, sway_3, sway_4,
        sway_5, sway_6, sway_7, sway_8,
        heave_1, heave_2, heave_3, heave_4,
        heave_5, heave_6, heave_7, heave_8,
        roll_1, roll_2, roll_3, roll_4,
        roll_5, roll_6, roll_7, roll_8,
        pitch_1, pitch_2, pitch_3, pitch_4,
        pitch_5, pitch_6, pitch_7, pitch_8,
        yaw_1, yaw_2, yaw_3, yaw_4,
        yaw_5, yaw_6, yaw_7, yaw_8,
    ) = p  # fmt: skip
    t_1, t_2, t_3, t_4, t_5, t_6, t_7, t_8 = thrust
    return (
        surge_1 * t_1 + surge_2 * t_2 + surge_3 * t_3 + surge_4 * t_4
        + surge_5 * t_5 + surge_6 * t_6 + surge_7 * t_7 + surge_8 * t_8,
        sway_1 * t_1 + sway_2 * t_2 + sway_3 * t_3 + sway_4 * t_4
        + sway_5 * t_5 + sway_6 * t_6 + sway_7 * t_7 + sway_8 * t_8,
        heave_1 * t_1 + heave_2 * t_2 + heave_3 * t_3 + heave_4 * t_4
        + heave_5 * t_5 + heave_6 * t_6 + heave_7 * t_7 + heave_8 * t_8,
        roll_1 * t_1 + roll_2 * t_2 + roll_3 * t_3 + roll_4 * t_4
        + roll_5 * t_5 + roll_6 * t_6 + roll_7 * t_7 + roll_8 * t_8,
        pitch_1 * t_1 + pitch_2 * t_2 + pitch_3 * t_3 + pitch_4 * t_4
        + pitch_5 * t_5 + pitch_6 * t_6 + pitch_7 * t_7 + pitch_8 * t_8,
        yaw_1 * t_1 + yaw_2 * t_2 + yaw_3 * t_3 + yaw_4 * t_4
        + yaw_5 * t_5 + yaw_6 * t_6 + yaw_7 * t_7 + yaw_8 * t_8,
    )  # fmt: skip


EFFECT = WrenchEffect(
    'rotor_thrust', PARAMETERS, compute_wrench, tuple(known.name for known in PARAMETERS)
)
