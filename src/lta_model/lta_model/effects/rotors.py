# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""From the thrusts of the rotors to force and moment, with the jets that meet the hull."""

from collections.abc import Mapping
import math

from lta_model.effects.protocol import (
    AXES,
    declare_each,
    EffectParameter,
    Values,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_model.state import ACTUATORS, ROTOR, ROTOR_PLACE


def rotor_thrust(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Wrench of the rotors on the vehicle.

        (F, N) = B T

    Column i of B is the wrench about the hull centre per newton of rotor i, including the effect
    of its jet on the hull (the paper's thrust allocation). `rotor_envelope_interaction` has the
    different effect of a reversed jet and the interaction of jets.
    """
    surge, sway, heave = p[0:8], p[8:16], p[16:24]
    roll, pitch, yaw = p[24:32], p[32:40], p[40:48]
    return (
        sum_thrusts(surge, thrust),
        sum_thrusts(sway, thrust),
        sum_thrusts(heave, thrust),
        sum_thrusts(roll, thrust),
        sum_thrusts(pitch, thrust),
        sum_thrusts(yaw, thrust),
    )


def sum_thrusts(gains: Values, thrust: Values) -> float:
    """Return the sum of the thrusts of eight rotors, each times its gain."""
    front = gains[0] * thrust[0] + gains[1] * thrust[1] + gains[2] * thrust[2]
    middle = front + gains[3] * thrust[3] + gains[4] * thrust[4] + gains[5] * thrust[5]
    return middle + gains[6] * thrust[6] + gains[7] * thrust[7]


_ROTOR_THRUST_FORCE = 'spread: 3 % of the thrust, the suction of the jet on a hull in CFD'
_ROTOR_THRUST_LEVER = 'spread: 1 cm for the position of a rotor; limits: 5 m'
_ROTOR_THRUST_PARAMETERS = tuple(
    EffectParameter(f'{axis}_{i}', '1', 0.0, -1.5, 1.5, 0.03, _ROTOR_THRUST_FORCE)
    # Force per newton is a pure number, moment per newton a lever arm
    if axis in AXES[:3]
    else EffectParameter(f'{axis}_{i}', 'm', 0.0, -5.0, 5.0, 0.01, _ROTOR_THRUST_LEVER)
    for axis in AXES
    for i in range(1, ACTUATORS + 1)
)

ROTOR_THRUST = WrenchEffect(
    'rotor_thrust',
    _ROTOR_THRUST_PARAMETERS,
    rotor_thrust,
    tuple(parameter.name for parameter in _ROTOR_THRUST_PARAMETERS),
)


def rotor_misalignment(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Rotor axes that deviate from the vehicle file.

    The thrust axis a of a rotor turns by two small angles about two axes perpendicular to it,

        theta = first e_1 + second e_2,   dF = T (theta x a),   dM = r x dF

    with r the place of the rotor in the body. e_1 is along h x a and e_2 = a x e_1, where h is the
    body's z, or its y for a rotor within 45 degrees of the vertical. An upward rotor has e_1 = x,
    e_2 = y; a forward one e_1 = y, e_2 = z (first > 0 tilts it down, second > 0 turns it left). dF
    adds to B T; the effect of the turned jet on the hull is not modelled.

    Linear in the angles, as identification needs it, and without sines. Compared with the exact
    rotation the force errs by T theta^2 / 2 along the axis and T |theta|^3 / 6 across it. The
    bounds of 0.2 rad (11 degrees) keep that within 2 % and 0.14 % of the thrust for one angle, 4 %
    and 0.4 % for both; correct larger deviations in the vehicle file.
    """
    first, second = p[0:8], p[8:16]
    body = motion.body
    front = add_wrenches(
        add_wrenches(
            tilt_wrench(first[0], second[0], thrust[0], body, ROTOR_PLACE),
            tilt_wrench(first[1], second[1], thrust[1], body, ROTOR_PLACE + ROTOR),
        ),
        add_wrenches(
            tilt_wrench(first[2], second[2], thrust[2], body, ROTOR_PLACE + 2 * ROTOR),
            tilt_wrench(first[3], second[3], thrust[3], body, ROTOR_PLACE + 3 * ROTOR),
        ),
    )
    back = add_wrenches(
        add_wrenches(
            tilt_wrench(first[4], second[4], thrust[4], body, ROTOR_PLACE + 4 * ROTOR),
            tilt_wrench(first[5], second[5], thrust[5], body, ROTOR_PLACE + 5 * ROTOR),
        ),
        add_wrenches(
            tilt_wrench(first[6], second[6], thrust[6], body, ROTOR_PLACE + 6 * ROTOR),
            tilt_wrench(first[7], second[7], thrust[7], body, ROTOR_PLACE + 7 * ROTOR),
        ),
    )
    return add_wrenches(front, back)


def tilt_wrench(first: float, second: float, thrust: float, body: Values, o: int) -> Wrench:
    """Return the wrench that a tilt adds to a rotor; `o` is its first index in `body`."""
    # Single numbers, because a slice of the body would be copied, at the cost of everything else.
    x, y, z = body[o], body[o + 1], body[o + 2]
    a, b, c = body[o + 3], body[o + 4], body[o + 5]
    # h x a, not yet of length one: z x a, or y x a near the vertical.
    # Within 45 degrees of the vertical, z x a would be short and ill-defined
    upright = c * c > 0.5
    e = c if upright else -b
    f = 0.0 if upright else a
    g = -a if upright else 0.0
    length = math.sqrt(e * e + f * f + g * g)
    # Length 0: a rotor that does not exist
    scale = thrust / length if length > 0.0 else 0.0
    # e_1 x a = -e_2 and e_2 x a = e_1, so theta x a = second e_1 - first e_2.
    f_x = scale * (second * e - first * (b * g - c * f))
    f_y = scale * (second * f - first * (c * e - a * g))
    f_z = scale * (second * g - first * (a * f - b * e))
    return (f_x, f_y, f_z, y * f_z - z * f_y, z * f_x - x * f_z, x * f_y - y * f_x)


def add_wrenches(a: Wrench, b: Wrench) -> Wrench:
    """Return the sum of two wrenches."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


_ROTOR_MISALIGNMENT_SOURCE = 'spread (assumed): half a degree of error on a printed or glued frame'
_NAMES = tuple(f'{turn}_{i}' for turn in ('first', 'second') for i in range(1, ACTUATORS + 1))

ROTOR_MISALIGNMENT = WrenchEffect(
    'rotor_misalignment',
    declare_each(_NAMES, 'rad', 0.0, -0.2, 0.2, 0.009, _ROTOR_MISALIGNMENT_SOURCE),
    rotor_misalignment,
    _NAMES,
)


def rotor_envelope_interaction(
    p: Values, memory: Values, motion: VehicleMotion, thrust: Values
) -> Wrench:
    """
    Interaction of rotor jets with the hull beyond a linear matrix B: reversed and colliding jets.

        (F, N) = sum_i reverse_i min(T_i, 0) + together max(0, min over the rotors taking part of
                 share_i T_i)

    The columns of B (`rotor_thrust`) hold for forward thrust, including the suction of each jet on
    the hull. `reverse_i` (`surge_1` to `yaw_8`) is B of reversed thrust less B of forward thrust;
    its sum over T < 0 adds to B T. A rotor that blows up into a balloon loses three quarters of
    its thrust.

    `together` is the wrench per newton of the weakest participating rotor, which acts only while
    several jets run at once: colliding jets build a pressure that no single jet has. Rotors with a
    `share_i` participate: 1 with forward and -1 with reversed thrust; a smaller share counts a
    newton of that rotor for less. A linear B cannot represent this. The minimum is the simplest
    function that is 1 with all on and 0 with one off; two of four jets were not computed. It
    scales with thrust at a fixed pattern, as momentum-driven jets do; only full thrust was
    computed.

    Source of both: simulated actuator disks below a mylar balloon of 1 m (OpenFOAM 1912, steady
    k-omega SST, 62 to 72 thousand cells; thrust within 1 %, suction within 13 % of a finer mesh).
    Not modelled: flight speed. `reverse_i` also has the lower thrust of a reversed propeller
    itself, from `thrust_curve.reverse` of the vehicle file or from a calibration.
    """
    surge, sway, heave = p[0:8], p[8:16], p[16:24]
    roll, pitch, yaw = p[24:32], p[32:40], p[40:48]
    together, share = p[48:54], p[54:62]
    # Thrust of the weakest participating rotor; _NONE where none takes part
    weakest = min(
        min(participating_thrust(share[0], thrust[0]), participating_thrust(share[1], thrust[1])),
        min(participating_thrust(share[2], thrust[2]), participating_thrust(share[3], thrust[3])),
        min(participating_thrust(share[4], thrust[4]), participating_thrust(share[5], thrust[5])),
        min(participating_thrust(share[6], thrust[6]), participating_thrust(share[7], thrust[7])),
    )
    # No rotor takes part, or one pushes the other way: no collision
    m = max(0.0, weakest) if weakest < _NONE else 0.0
    # Reversed part of each thrust
    back = (
        min(thrust[0], 0.0),
        min(thrust[1], 0.0),
        min(thrust[2], 0.0),
        min(thrust[3], 0.0),
        min(thrust[4], 0.0),
        min(thrust[5], 0.0),
        min(thrust[6], 0.0),
        min(thrust[7], 0.0),
    )
    return (
        sum_thrusts(surge, back) + together[0] * m,
        sum_thrusts(sway, back) + together[1] * m,
        sum_thrusts(heave, back) + together[2] * m,
        sum_thrusts(roll, back) + together[3] * m,
        sum_thrusts(pitch, back) + together[4] * m,
        sum_thrusts(yaw, back) + together[5] * m,
    )


def _gain_parameter(name: str) -> EffectParameter:
    """Return a wrench per newton of thrust as a parameter."""
    # Force per newton is a pure number, moment per newton a length
    if name.removeprefix('together_').split('_')[0] in AXES[:3]:
        return EffectParameter(name, '1', 0.0, -5.0, 5.0, 0.03, _ROTOR_ENVELOPE_INTERACTION_FORCE)
    return EffectParameter(name, 'm', 0.0, -10.0, 10.0, 0.01, _ROTOR_ENVELOPE_INTERACTION_LEVER)


def participating_thrust(share: float, thrust: float) -> float:
    """Return the thrust of a participating rotor, else a number above any thrust [N]."""
    return share * thrust if share != 0.0 else _NONE


def check_rotor_envelope_interaction(values: Mapping[str, float]) -> str:
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


_ROTOR_ENVELOPE_INTERACTION_FORCE = (
    'spread: 3 % of the thrust, the suction of a jet in CFD; limit: the sum of a few rotors'
)
_ROTOR_ENVELOPE_INTERACTION_LEVER = (
    'spread: 1 cm for the point where the jet meets the hull; limit: two levers of 5 m'
)
_TAKING_PART = 'chosen, not measured: 1 takes part, 0 does not, -1 takes part with reversed thrust'
_NONE = 1e9  # more than any rotor pushes [N]
_ROTORS = range(1, ACTUATORS + 1)
_REVERSE = tuple(f'{axis}_{i}' for axis in AXES for i in _ROTORS)
_TOGETHER = tuple(f'together_{axis}' for axis in AXES)

ROTOR_ENVELOPE_INTERACTION = WrenchEffect(
    'rotor_envelope_interaction',
    (
        *(_gain_parameter(name) for name in (*_REVERSE, *_TOGETHER)),
        *(EffectParameter(f'share_{i}', '1', 0.0, -1.0, 1.0, 0.5, _TAKING_PART) for i in _ROTORS),
    ),
    rotor_envelope_interaction,
    (*_REVERSE, *_TOGETHER),
    check=check_rotor_envelope_interaction,
)
