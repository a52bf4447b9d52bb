# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Lift, drag and moments of a hull, winged or oblique to the flow."""

import math

from lta_model.effects.protocol import (
    declare_each,
    EffectParameter,
    Values,
    Vector,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)

# Keeps angles and slopes finite in still air; far below flight speeds of 0.3 m/s
SMALL_SPEED = 1e-3  # [m/s]


def hull_lift(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Lift, drag, side force and moments of a winged hull by angle of attack and sideslip.

    In axes forward, right, down (z down here only), with alpha = atan2(v_z, v_x),
    beta = asin(v_y / V) and q = density V^2 area / 2, the model is that of RGBlimp's authors
    (zhu-yj/ABNODE@138a1de):

        D = q (drag + drag_alpha2 alpha^2 + drag_beta2 beta^2)
        S = q (side + side_alpha2 alpha^2 + side_beta beta)
        L = q (lift + lift_alpha alpha + lift_beta2 beta^2)
        M1 = q (roll + roll_alpha alpha + roll_beta beta)       - roll_rate p
        M2 = q (pitch + pitch_alpha alpha + pitch_beta4 beta^4) - pitch_rate q
        M3 = q (yaw + yaw_alpha alpha + yaw_beta beta)          - yaw_rate r
        F = R (-D, S, -L),   N = R (M1, M2, M3),   R: wind to body

    Moments use a reference length of 1 m, damping the body rates p, q, r. The published model was
    fitted to forward flight at moderate angles (|alpha| below 24 degrees in 99.9 % of the data).
    Outside that range it is discontinuous, its damping adds energy, and its lift acts downwards on
    a hull that sinks backwards. So it is extended here, with s = SMALL_SPEED = 1 mm/s:

        alpha = atan2(v_z, |v_x, s|),     beta = atan2(v_y, |v_x, v_z, s|)
        cos a = v_x / |v_x, v_z, s|,      sin a = v_z / |v_x, v_z, s|
        cos b = |v_x, v_z, s| / |v, s|,    sin b = v_y / |v, s|

    in R; alpha is measured from the leading end of the hull. Flying backwards, the hull behaves as
    its mirror image: L, M1 and M2 are multiplied by e, and the damping blends into body axes
    between:

        e = t (3 - t^2) / 2,   t = 2 f |f| within -1 and 1,   f = cos a cos b
        k = |e| (v_x^2 + v_z^2) / |v_x, v_z, s|^2,  d = -(roll_rate p, pitch_rate q, yaw_rate r)
        N_damping = k R (o d_1, d_2, o d_3) + (1 - k) d,   o the sign of e

    e is 1 within 45 degrees of straight ahead. The wrench has a continuous slope, and in that
    range it differs from the published one by a few (s / V)^2.

    The flow is taken, and the force acts, at (x, 0, z) from the hull centre in body axes (forward
    and up); the published model has 0. A wing 10 cm behind the tracked point meets another
    sideslip in a turn: 4 degrees at 0.3 rad/s and 0.4 m/s.

    All translational drag of the hull is included, so the drags per axis stay at null. Measured
    moments include the Munk moment: for a vehicle with added mass, cancel that of the rigid body
    with `munk_moment`, `lost` = 1.
    """
    (
        density,
        area,
        drag,
        drag_alpha2,
        drag_beta2,
        side,
        side_alpha2,
        side_beta,
        lift,
        lift_alpha,
        lift_beta2,
        roll,
        roll_alpha,
        roll_beta,
        pitch,
        pitch_alpha,
        pitch_beta4,
        yaw,
        yaw_alpha,
        yaw_beta,
        roll_rate,
        pitch_rate,
        yaw_rate,
        x,
        z,
    ) = p
    turn_p, turn_q, turn_r = motion.rates
    # Velocity at (x, 0, z), v + w x r, turned from forward-left-up to forward-right-down
    u = motion.airspeed[0] + turn_q * z
    v = -(motion.airspeed[1] + turn_r * x - turn_p * z)
    w = -(motion.airspeed[2] - turn_q * x)
    level = u * u + w * w
    square = level + v * v
    # |v_x, v_z, s| and 1 / |v, s|
    flat, scale = (
        math.sqrt(level + SMALL_SPEED * SMALL_SPEED),
        1.0 / math.sqrt(square + SMALL_SPEED * SMALL_SPEED),
    )
    ca, sa, cb, sb = u / flat, w / flat, flat * scale, v * scale
    alpha, beta = math.atan2(w, math.sqrt(u * u + SMALL_SPEED * SMALL_SPEED)), math.atan2(v, flat)
    a2, b2 = alpha * alpha, beta * beta
    # Cosine between the flow and the hull axis, f in the equations
    along = ca * cb
    t = min(1.0, max(-1.0, 2.0 * along * abs(along)))
    # Cubic smoothstep from -1 (backwards) to 1 (forwards)
    e = 0.5 * t * (3.0 - t * t)
    q = 0.5 * density * area * square
    force = (
        -q * (drag + drag_alpha2 * a2 + drag_beta2 * b2),
        q * (side + side_alpha2 * a2 + side_beta * beta),
        # Lift, roll and pitch change sign for the mirror image that flies backwards
        -q * e * (lift + lift_alpha * alpha + lift_beta2 * b2),
    )
    moment = (
        q * e * (roll + roll_alpha * alpha + roll_beta * beta),
        q * e * (pitch + pitch_alpha * alpha + pitch_beta4 * b2 * b2),
        q * (yaw + yaw_alpha * alpha + yaw_beta * beta),
    )
    # Forward-right-down: roll keeps its sign, pitch and yaw change it
    damping = (
        -roll_rate * motion.rates[0],
        pitch_rate * motion.rates[1],
        yaw_rate * motion.rates[2],
    )
    # Near 1; 0 without flow in the plane of x and z, where wind axes are undefined
    share = level / (flat * flat)
    along, wind = share * e, share * abs(e)
    turning = (along * damping[0], wind * damping[1], along * damping[2])
    d = rotate_wind_to_body(ca, sa, cb, sb, turning)
    f, n = rotate_wind_to_body(ca, sa, cb, sb, force), rotate_wind_to_body(ca, sa, cb, sb, moment)
    # Share of the damping that acts in body axes
    body = 1.0 - wind
    return (
        f[0],
        # Back to forward-left-up: y and z change sign
        -f[1],
        -f[2],
        # Moments about the hull centre: r x F of the force at (x, 0, z) is included
        n[0] + d[0] + body * damping[0] + z * f[1],
        -(n[1] + d[1] + body * damping[1]) + z * f[0] + x * f[2],
        -(n[2] + d[2] + body * damping[2]) - x * f[1],
    )


def _slope_parameter(name: str) -> EffectParameter:
    """Return a coefficient per radian or a power of it."""
    return EffectParameter(name, '1', 0.0, -100.0, 100.0, 0.5, _SLOPE)


def _straight_flow_parameter(name: str) -> EffectParameter:
    """Return a coefficient in straight flow."""
    return EffectParameter(name, '1', 0.0, -10.0, 10.0, 0.03, _BASE)


def rotate_wind_to_body(ca: float, sa: float, cb: float, sb: float, f: Vector) -> Vector:
    """Return R f: a vector from wind axes to axes forward, right, down."""
    flat = cb * f[0] - sb * f[1]
    return (ca * flat - sa * f[2], sb * f[0] + cb * f[1], sa * flat + ca * f[2])


_AIR = 'ABNODE: 1.2187 kg/m3; spread: 2 %, from the weather'
_AREA = 'ABNODE: reference area of 0.25 m2, by definition; spread: 10 %'
_BASE = 'ABNODE@138a1de; spread: 10 % of its drag'
_SLOPE = 'ABNODE@138a1de; spread: 20 % of its slopes'
_CENTRE_PLACE = 'spread: 5 cm for the centre of a hull with wings (assumed)'
_RATE = 'ABNODE@138a1de: 0.014 to 0.050; spread: a third of that'
_HULL_LIFT_PARAMETERS = (
    EffectParameter('density', 'kg/m3', 0.0, 0.0, 2.0, 0.02, _AIR),
    EffectParameter('area', 'm2', 0.0, 0.0, 100.0, 0.02, _AREA),
    EffectParameter('drag', '1', 0.0, 0.0, 10.0, 0.03, _BASE),
    *declare_each(('drag_alpha2', 'drag_beta2'), '1', 0.0, 0.0, 100.0, 0.5, _SLOPE),
    _straight_flow_parameter('side'),
    _slope_parameter('side_alpha2'),
    _slope_parameter('side_beta'),
    _straight_flow_parameter('lift'),
    _slope_parameter('lift_alpha'),
    _slope_parameter('lift_beta2'),
    _straight_flow_parameter('roll'),
    _slope_parameter('roll_alpha'),
    _slope_parameter('roll_beta'),
    _straight_flow_parameter('pitch'),
    _slope_parameter('pitch_alpha'),
    _slope_parameter('pitch_beta4'),
    _straight_flow_parameter('yaw'),
    _slope_parameter('yaw_alpha'),
    _slope_parameter('yaw_beta'),
    *declare_each(('roll_rate', 'pitch_rate', 'yaw_rate'), 'N m s', 0.0, 0.0, 10.0, 0.01, _RATE),
    *declare_each(('x', 'z'), 'm', 0.0, -5.0, 5.0, 0.05, _CENTRE_PLACE),
)

HULL_LIFT = WrenchEffect(
    'hull_lift',
    _HULL_LIFT_PARAMETERS,
    hull_lift,
    # All but density and area (they multiply the others), and x, z (the place)
    linear_in=tuple(parameter.name for parameter in _HULL_LIFT_PARAMETERS[2:-2]),
)


def oblique_lift(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Lift of a round hull that flies nose up or nose down.

        F_z = -lift |v_h| v_z / (1 + stall sin(a)^2),   sin(a) = v_z / |v|

    about the hull centre, along body z. v is the air-relative velocity, v_h its part along surge
    and sway, a the incidence. At small incidence the force grows with a, by lift / (density S / 2)
    per radian as a coefficient on an area S; beyond, the hull stalls. Across and along its axis a
    round hull has none. It comes on top of the drag by axis, includes the drag due to lift, and
    dissipates. Not modelled: the suction along the hull, which is a tenth of the drag of GT-MAB
    (docs/cfd.md).
    """
    lift, stall = p
    x, y, z = motion.airspeed
    square = x * x + y * y + z * z
    # At rest there is no force, and no incidence
    share = z * z / square if square > 0.0 else 0.0
    force = -lift * math.sqrt(x * x + y * y) * z / (1.0 + stall * share)
    return (0.0, 0.0, force, 0.0, 0.0, 0.0)


_LIFT = (
    'OpenFOAM: 0.63 N s2/m2 of a 1 m oblate hull at 10 to 40 degrees (docs/cfd.md); spread: half'
)
_STALL = 'OpenFOAM: 4.5 for the same hull; spread: a third'

OBLIQUE_LIFT = WrenchEffect(
    'oblique_lift',
    (
        EffectParameter('lift', 'N s2/m2', 0.0, 0.0, 100.0, 0.3, _LIFT),
        EffectParameter('stall', '1', 0.0, 0.0, 100.0, 1.5, _STALL),
    ),
    oblique_lift,
    linear_in=('lift',),
)
