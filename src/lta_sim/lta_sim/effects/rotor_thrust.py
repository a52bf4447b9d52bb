"""
Thrust of four rotors and the wrench that each gives the vehicle.

    T_i = a_i u_i |u_i| + b_i u_i,    (F, N) = B T

u_i is the duty, -1 to 1; column i of B is the wrench about the hull centre per newton of rotor i,
with what the jet does to the hull included. The parabola is the thrust curve of 7 mm brushed
motors in the firmware of the Crazyflie (a = 0.0915 N, b = 0.0677 N), continued as an odd function
for rotors that can reverse. Left out: inflow from flight speed, and that a reversed jet meets the
hull differently.
"""

from lta_sim.effects.protocol import AXES, Duty, Motion, Parameter, Values, Wrench, WrenchEffect
from lta_sim.state import ACTUATORS

_CURVE = 'bench tables of 7 mm motors deviate 3 mN rms from the firmware curve; bound 50 N'
_FORCE = 'prior: 3 % of the thrust, the suction of the jet on a hull in CFD'
_LEVER = 'prior: 1 cm on the place of a rotor, within 5 m'

_ROTORS = range(1, ACTUATORS + 1)
_COEFFICIENTS = tuple(f'{letter}_{i}' for letter in 'ab' for i in _ROTORS)

PARAMETERS = (
    *(Parameter(name, 'N', 0.0, -50.0, 50.0, 0.003, _CURVE) for name in _COEFFICIENTS),
    *(
        Parameter(f'{axis}_{i}', '1', 0.0, -1.5, 1.5, 0.03, _FORCE)
        if axis in AXES[:3]
        else Parameter(f'{axis}_{i}', 'm', 0.0, -5.0, 5.0, 0.01, _LEVER)
        for axis in AXES
        for i in _ROTORS
    ),
)


def wrench(p: Values, motion: Motion, duty: Duty) -> Wrench:
    """Return B times the rotor thrusts."""
    (
        a_1, a_2, a_3, a_4, b_1, b_2, b_3, b_4,
        surge_1, surge_2, surge_3, surge_4, sway_1, sway_2, sway_3, sway_4,
        heave_1, heave_2, heave_3, heave_4, roll_1, roll_2, roll_3, roll_4,
        pitch_1, pitch_2, pitch_3, pitch_4, yaw_1, yaw_2, yaw_3, yaw_4,
    ) = p  # fmt: skip
    t_1 = (a_1 * abs(duty[0]) + b_1) * duty[0]
    t_2 = (a_2 * abs(duty[1]) + b_2) * duty[1]
    t_3 = (a_3 * abs(duty[2]) + b_3) * duty[2]
    t_4 = (a_4 * abs(duty[3]) + b_4) * duty[3]
    return (
        surge_1 * t_1 + surge_2 * t_2 + surge_3 * t_3 + surge_4 * t_4,
        sway_1 * t_1 + sway_2 * t_2 + sway_3 * t_3 + sway_4 * t_4,
        heave_1 * t_1 + heave_2 * t_2 + heave_3 * t_3 + heave_4 * t_4,
        roll_1 * t_1 + roll_2 * t_2 + roll_3 * t_3 + roll_4 * t_4,
        pitch_1 * t_1 + pitch_2 * t_2 + pitch_3 * t_3 + pitch_4 * t_4,
        yaw_1 * t_1 + yaw_2 * t_2 + yaw_3 * t_3 + yaw_4 * t_4,
    )


EFFECT = WrenchEffect('rotor_thrust', PARAMETERS, wrench, _COEFFICIENTS)
