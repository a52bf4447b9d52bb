"""
Interaction of rotor jets with the hull beyond a linear matrix B: reversed and colliding jets.

    (F, N) = sum_i reverse_i min(T_i, 0) + together max(0, min over the rotors taking part of
             share_i T_i)

The columns of B (`rotor_thrust`) hold for forward thrust, including the suction of each jet on the
hull. `reverse_i` (`surge_1` to `yaw_8`) is B of reversed thrust less B of forward thrust; its sum
over T < 0 adds to B T. A rotor that blows up into a balloon loses three quarters of its thrust.

`together` is the wrench per newton of the weakest participating rotor, which acts only while
several jets run at once: colliding jets build a pressure that no single jet has. Rotors with a
`share_i` participate: 1 with forward and -1 with reversed thrust; a smaller share counts a newton
of that rotor for less. A linear B cannot represent this. The minimum is the simplest function that
is 1 with all on and 0 with one off; two of four jets were not computed. It scales with thrust at a
fixed pattern, as momentum-driven jets do; only full thrust was computed.

Source of both: simulated actuator disks below a mylar balloon of 1 m (OpenFOAM 1912, steady
k-omega SST, 62 to 72 thousand cells; thrust within 1 %, suction within 13 % of a finer mesh). Not
modelled: flight speed. `reverse_i` also has the lower thrust of a reversed propeller itself, from
`thrust_curve.reverse` of the vehicle file or from a calibration.
"""

from collections.abc import Mapping

from lta_model.effects.protocol import (
    AXES,
    EffectParameter,
    Values,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_model.state import ACTUATORS

_FORCE = 'spread: 3 % of the thrust, the suction of a jet in CFD; limit: the sum of a few rotors'
_LEVER = 'spread: 1 cm for the point where the jet meets the hull; limit: two levers of 5 m'
_SHARE = 'chosen, not measured: 1 takes part, 0 does not, -1 takes part with reversed thrust'
_NONE = 1e9  # more than any rotor pushes [N]

_ROTORS = range(1, ACTUATORS + 1)
_REVERSE = tuple(f'{axis}_{i}' for axis in AXES for i in _ROTORS)
_TOGETHER = tuple(f'together_{axis}' for axis in AXES)


def _gain_parameter(name: str) -> EffectParameter:
    """Return a wrench per newton of thrust as a parameter."""
    # Force per newton is a pure number, moment per newton a length
    if name.removeprefix('together_').split('_')[0] in AXES[:3]:
        return EffectParameter(name, '1', 0.0, -5.0, 5.0, 0.03, _FORCE)
    return EffectParameter(name, 'm', 0.0, -10.0, 10.0, 0.01, _LEVER)


PARAMETERS = (
    *(_gain_parameter(name) for name in (*_REVERSE, *_TOGETHER)),
    *(EffectParameter(f'share_{i}', '1', 0.0, -1.0, 1.0, 0.5, _SHARE) for i in _ROTORS),
)


def participating_thrust(share: float, thrust: float) -> float:
    """Return the thrust of a participating rotor, else a number above any thrust. [N]"""
    return share * thrust if share != 0.0 else _NONE


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the wrench of reversed and colliding jets beyond B T."""
    (
        surge_1, surge_2, surge_3, surge_4, surge_5, surge_6, surge_7, surge_8,
        sway_1, sway_2, sway_3, sway_4, sway_5, sway_6, sway_7, sway_8,
        heave_1, heave_2, heave_3, heave_4, heave_5, heave_6, heave_7, heave_8,
        roll_1, roll_2, roll_3, roll_4, roll_5, roll_6, roll_7, roll_8,
        pitch_1, pitch_2, pitch_3, pitch_4, pitch_5, pitch_6, pitch_7, pitch_8,
        yaw_1, yaw_2, yaw_3, yaw_4, yaw_5, yaw_6, yaw_7, yaw_8,
        together_surge, together_sway, together_heave,
        together_roll, together_pitch, together_yaw,
        share_1, share_2, share_3, share_4, share_5, share_6, share_7, share_8,
    ) = p  # fmt: skip
    # Thrust of the weakest participating rotor; _NONE where none takes part
    weakest = min(
        min(participating_thrust(share_1, thrust[0]), participating_thrust(share_2, thrust[1])),
        min(participating_thrust(share_3, thrust[2]), participating_thrust(share_4, thrust[3])),
        min(participating_thrust(share_5, thrust[4]), participating_thrust(share_6, thrust[5])),
        min(participating_thrust(share_7, thrust[6]), participating_thrust(share_8, thrust[7])),
    )
    # No rotor takes part, or one pushes the other way: no collision
    m = max(0.0, weakest) if weakest < _NONE else 0.0
    # Reversed part of each thrust
    a, b, c, d = min(thrust[0], 0.0), min(thrust[1], 0.0), min(thrust[2], 0.0), min(thrust[3], 0.0)
    e, f, g, h = min(thrust[4], 0.0), min(thrust[5], 0.0), min(thrust[6], 0.0), min(thrust[7], 0.0)
    return (
        surge_1 * a + surge_2 * b + surge_3 * c + surge_4 * d
        + surge_5 * e + surge_6 * f + surge_7 * g + surge_8 * h + together_surge * m,
        sway_1 * a + sway_2 * b + sway_3 * c + sway_4 * d
        + sway_5 * e + sway_6 * f + sway_7 * g + sway_8 * h + together_sway * m,
        heave_1 * a + heave_2 * b + heave_3 * c + heave_4 * d
        + heave_5 * e + heave_6 * f + heave_7 * g + heave_8 * h + together_heave * m,
        roll_1 * a + roll_2 * b + roll_3 * c + roll_4 * d
        + roll_5 * e + roll_6 * f + roll_7 * g + roll_8 * h + together_roll * m,
        pitch_1 * a + pitch_2 * b + pitch_3 * c + pitch_4 * d
        + pitch_5 * e + pitch_6 * f + pitch_7 * g + pitch_8 * h + together_pitch * m,
        yaw_1 * a + yaw_2 * b + yaw_3 * c + yaw_4 * d
        + yaw_5 * e + yaw_6 * f + yaw_7 * g + yaw_8 * h + together_yaw * m,
    )  # fmt: skip


def find_conflict(values: Mapping[str, float]) -> str:
    """Return an objection to the participating rotors, or ''."""
    taking = sum(values[f'share_{i}'] != 0.0 for i in _ROTORS)
    gains = any(values[name] != 0.0 for name in _TOGETHER)
    if gains and taking < 2:
        return (
            'a parameter together_... is set, but fewer than two rotors take part in the jet '
            'interaction; set share_... of at least two rotors'
        )
    # Shares without a gain change nothing and are likely a mistake
    if taking > 0 and not gains:
        return (
            'a parameter share_... is set, but the force and moment of the jet interaction '
            'are zero; set a parameter together_...'
        )
    return ''


EFFECT = WrenchEffect(
    'rotor_envelope_interaction',
    PARAMETERS,
    compute_wrench,
    (*_REVERSE, *_TOGETHER),
    check=find_conflict,
)
