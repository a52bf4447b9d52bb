# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Drag of the hull and damping of its rotation."""

import math

from lta_model.effects.protocol import (
    AXES,
    declare_each,
    EffectParameter,
    Values,
    Vector,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)


def linear_drag(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Drag proportional to the airspeed, per axis.

        F_i = -D_i v_r,i

    about the hull centre; v_r is the air-relative velocity. Skin friction at low Reynolds number:
    the linear part of the diagonal drag of small blimps (Fossen 2011, section 6.4, eq. 6.57).
    """
    surge, sway, heave = p
    v = motion.airspeed
    return (-surge * v[0], -sway * v[1], -heave * v[2], 0.0, 0.0, 0.0)


_LINEAR_DRAG_SOURCE = 'Fossen 2011 sec. 6.4; spread: scatter of published indoor blimps'

LINEAR_DRAG = WrenchEffect(
    'linear_drag',
    declare_each(AXES[:3], 'N s/m', 0.0, 0.0, 100.0, 0.01, _LINEAR_DRAG_SOURCE),
    linear_drag,
    AXES[:3],
)


def quadratic_drag(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Drag proportional to the square of the airspeed, per axis.

        F_i = -D_i |v_r,i| v_r,i,   D = rho C_D A / 2

    about the hull centre; v_r is the air-relative velocity (Fossen 2011, section 6.4, eq. 6.58).
    For a round hull at 45 degrees this gives 0.71 of the drag; `cross_flow` corrects it.
    """
    surge, sway, heave = p
    v = motion.airspeed
    return (
        # |v| v instead of v^2 keeps the sign, so that the force always opposes the motion
        -surge * abs(v[0]) * v[0],
        -sway * abs(v[1]) * v[1],
        -heave * abs(v[2]) * v[2],
        0.0,
        0.0,
        0.0,
    )


_QUADRATIC_DRAG_SOURCE = 'Fossen 2011 sec. 6.4; spread: 20 % of that of a 1 m oblate hull'

QUADRATIC_DRAG = WrenchEffect(
    'quadratic_drag',
    declare_each(AXES[:3], 'N s2/m2', 0.0, 0.0, 100.0, 0.03, _QUADRATIC_DRAG_SOURCE),
    quadratic_drag,
    AXES[:3],
)


def rotational_drag(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Linear and quadratic damping of the body rates.

        N_i = -(D_i + D_2i |w_i|) w_i

    about the hull centre: skin friction about an axis of revolution, form drag of gondola and hull
    about the others; the linear part is for small rates (Fossen 2011, section 6.4, eqs. 6.57 and
    6.58). Coefficients from steady rotation in a wind tunnel underestimate the damping of fast
    oscillations, because the air turns along; `strip_damping` adds that of frames and panels.
    """
    roll, pitch, yaw, roll_2, pitch_2, yaw_2 = p
    w = motion.rates
    return (
        0.0,
        0.0,
        0.0,
        # |w| w keeps the sign: both parts oppose the rotation
        -(roll + roll_2 * abs(w[0])) * w[0],
        -(pitch + pitch_2 * abs(w[1])) * w[1],
        -(yaw + yaw_2 * abs(w[2])) * w[2],
    )


_ROTATIONAL_DRAG_SOURCE = 'Fossen 2011 sec. 6.4; spread: 20 % of that of a 1 m oblate hull'
_ROTATIONAL_DRAG_PARAMETERS = (
    *declare_each(AXES[3:], 'N m s', 0.0, 0.0, 100.0, 5e-4, _ROTATIONAL_DRAG_SOURCE),
    *(
        EffectParameter(f'{axis}_2', 'N m s2', 0.0, 0.0, 100.0, 5e-4, _ROTATIONAL_DRAG_SOURCE)
        for axis in AXES[3:]
    ),
)

ROTATIONAL_DRAG = WrenchEffect(
    'rotational_drag',
    _ROTATIONAL_DRAG_PARAMETERS,
    rotational_drag,
    tuple(parameter.name for parameter in _ROTATIONAL_DRAG_PARAMETERS),
)


def cross_flow(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Additional drag of a round hull in oblique flow, which drag per axis underestimates.

        F_i = -D_i (s_i - |v_i|) v_i
        s_x = |v_x| + horizontal (|v_h| - |v_x|) + total (|v| - |v_h|),   s_y alike
        s_z = |v_z| + total (|v| - |v_z|)

    about the hull centre. v is the air-relative velocity, v_h its part along surge and sway, D the
    coefficients of `quadratic_drag`. At 45 degrees to its axes a round hull has the drag D |v| v,
    but -D |v_i| v_i gives only 0.71 of it. `horizontal` = 1 corrects this for a hull that is round
    seen from above; `total` = 1 also corrects oblique climbs: with both, F = -D |v| v. A slender
    hull needs neither, because its cross flow is independent of the axial flow (Allen and Perkins
    1951, NACA Report 1048). F dissipates for any share that is not negative, since s_i >= |v_i|.
    """
    horizontal, total, surge, sway, heave = p
    x, y, z = motion.airspeed
    square = x * x + y * y
    # |v_h| and |v|
    flat, speed = math.sqrt(square), math.sqrt(square + z * z)
    # The part that surge and sway share
    rest = total * (speed - flat)
    return (
        -surge * (horizontal * (flat - abs(x)) + rest) * x,
        -sway * (horizontal * (flat - abs(y)) + rest) * y,
        -heave * total * (speed - abs(z)) * z,
        0.0,
        0.0,
        0.0,
    )


_ROUND_SHARE = 'by definition: 0 for a slender hull, 1 for a round one; spread: 0.2 (assumed)'
_CROSS_FLOW_DRAG = (
    'as quadratic_drag; Fossen 2011 sec. 6.4; spread: 20 % of that of a 1 m oblate hull'
)

CROSS_FLOW = WrenchEffect(
    'cross_flow',
    (
        *declare_each(('horizontal', 'total'), '1', 0.0, 0.0, 1.0, 0.2, _ROUND_SHARE),
        *declare_each(
            ('surge', 'sway', 'heave'), 'N s2/m2', 0.0, 0.0, 100.0, 0.03, _CROSS_FLOW_DRAG
        ),
    ),
    cross_flow,
    linear_in=('horizontal', 'total'),
)


# Two wide panels, or four slim frame parts
MOST_STRIPS = 4
GAUSS_POINT = 0.7745966692414834  # sqrt(3 / 5), of the outer two points; weights 5/18, 8/18, 5/18


def strip_damping(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Rotational damping by frame and panels, by strip theory.

    A strip is straight, from c - h to c + h in the body. At s from -1 to 1 along it

        u(s) = k v_r + w x (c + s h),    f_i = -D_i |u_i| u_i   per unit of s / 2,
        N = int (c + s h) x f ds / 2,    F = k int f ds / 2

    with D = rho C_D A / 2 of the whole strip along each body axis, as in `quadratic_drag`; v_r is
    the airspeed of the hull. The integral uses three Gauss points: exact where u keeps its sign
    along the strip, 3.3 % high where the strip turns about its middle. `effect_parameters`
    computes the numbers from the boxes of a vehicle.

    The drag of the whole vehicle already covers translation, so a strip sees only the rotation:
    `translation` k = 0. Use k = 1 for parts that the vehicle's drag excludes. Force and moment
    share the factor, so the power sum f.u is <= 0 for every k. At k = 0 the force due to rotation
    is neglected: 0.1 mN at 0.5 rad/s for a box of 10 x 6 cm 33 cm below the centre.

    Where `rotational_drag` was measured on the whole vehicle, it already covers rotation. CFD in a
    rotating frame does not: there the air turns with the hull, and the damping of fast
    oscillations by protruding parts is missing. A frame of 10 x 32 x 6 cm 34.5 cm below the hull
    centre adds 5.5e-4 N m s2 in pitch, a quarter of the 2.1e-3 of such CFD, and 2 % in yaw.

    Not modelled: shielding by other parts and the hull's wake; air still moving from the previous
    oscillation (C_D at small amplitudes is larger); flow along a strip. Source: strip theory with
    the cross-flow principle (Fossen 2011, section 6.4, there for hulls; from memory); C_D as in
    `effect_parameters`.
    """
    translation, first, second, third, fourth = p[0], p[1:10], p[10:19], p[19:28], p[28:37]
    w, v = motion.rates, motion.airspeed
    # The whole vehicle's drag already covers the rest of the airspeed
    u = (translation * v[0], translation * v[1], translation * v[2])
    # Of each strip: middle, half its length, drag
    a = strip_wrench(u, w, first[0:3], first[3:6], first[6:9])
    b = strip_wrench(u, w, second[0:3], second[3:6], second[6:9])
    c = strip_wrench(u, w, third[0:3], third[3:6], third[6:9])
    d = strip_wrench(u, w, fourth[0:3], fourth[3:6], fourth[6:9])
    return (
        # The same factor as on the airspeed, so that the power stays negative
        translation * (a[0] + b[0] + c[0] + d[0]),
        translation * (a[1] + b[1] + c[1] + d[1]),
        translation * (a[2] + b[2] + c[2] + d[2]),
        a[3] + b[3] + c[3] + d[3],
        a[4] + b[4] + c[4] + d[4],
        a[5] + b[5] + c[5] + d[5],
    )


def _strip_parameters(i: int) -> tuple[EffectParameter, ...]:
    return (
        *(EffectParameter(f'{a}_{i}', 'm', 0.0, -5.0, 5.0, 0.01, _CENTRE) for a in 'xyz'),
        *(EffectParameter(f'half_{a}_{i}', 'm', 0.0, -5.0, 5.0, 0.01, _REACH) for a in 'xyz'),
        *(
            EffectParameter(f'{a}_{i}', 'N s2/m2', 0.0, 0.0, 100.0, 0.006, _STRIP_DAMPING_DRAG)
            for a in ('surge', 'sway', 'heave')
        ),
    )


def _cross_product(a: Values, b: Values) -> Vector:
    """Return a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _strip_drag(drag: Values, u: Vector, share: float) -> Vector:
    """Return the drag of a share of a strip at the velocity u."""
    return (
        -share * drag[0] * abs(u[0]) * u[0],
        -share * drag[1] * abs(u[1]) * u[1],
        -share * drag[2] * abs(u[2]) * u[2],
    )


def strip_wrench(u: Vector, w: Vector, centre: Values, half: Values, drag: Values) -> Wrench:
    """
    Return the drag of one strip and its moment about the hull centre, body frame [N, N m].

    Parameters
    ----------
    u : 3-tuple
        Velocity of the hull through the air, as the strip sees it. [m/s]
    w : 3-tuple
        Body rates. [rad/s]
    centre, half : 3-tuple
        Middle of the strip, and vector from there to its end. [m]
    drag : 3-tuple
        Force per squared speed along each axis. [N s2/m2]

    """
    # A strip that the vehicle does not have; most have one of four
    if drag[0] == 0.0 and drag[1] == 0.0 and drag[2] == 0.0:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    # Outer Gauss points at +-sqrt(3/5) of the half length
    g = (GAUSS_POINT * half[0], GAUSS_POINT * half[1], GAUSS_POINT * half[2])
    # Velocity by rotation: at the middle, and its change out to a Gauss point
    c, d = _cross_product(w, centre), _cross_product(w, g)
    m = (u[0] + c[0], u[1] + c[1], u[2] + c[2])
    # Weights 8/18 in the middle, 5/18 outside: they sum to 1
    f = _strip_drag(drag, m, 8.0 / 18.0)
    a = _strip_drag(drag, (m[0] + d[0], m[1] + d[1], m[2] + d[2]), 5.0 / 18.0)
    b = _strip_drag(drag, (m[0] - d[0], m[1] - d[1], m[2] - d[2]), 5.0 / 18.0)
    total = (f[0] + a[0] + b[0], f[1] + a[1] + b[1], f[2] + a[2] + b[2])
    # Moment of the sum about the hull centre, and of the difference about the middle
    n, t = (
        _cross_product(centre, total),
        _cross_product(g, (a[0] - b[0], a[1] - b[1], a[2] - b[2])),
    )
    return (*total, n[0] + t[0], n[1] + t[1], n[2] + t[2])


_CENTRE = 'spread: 1 cm for the position of a part (assumed); limits: a hull of 10 m'
_REACH = 'spread: 1 cm for the length of a part (assumed)'
_STRIP_DAMPING_DRAG = 'spread: error of 30 % of the C_D of a square plate of 0.03 m2 (assumed)'
_STRIPS = range(1, MOST_STRIPS + 1)
_DRAGS = tuple(f'{axis}_{i}' for i in _STRIPS for axis in ('surge', 'sway', 'heave'))
_STRIP_DAMPING_TRANSLATION = (
    'by definition from none (0) to all (1) of the airspeed; spread: assumed'
)

STRIP_DAMPING = WrenchEffect(
    'strip_damping',
    (
        EffectParameter('translation', '1', 0.0, 0.0, 1.0, 0.3, _STRIP_DAMPING_TRANSLATION),
        *(parameter for i in _STRIPS for parameter in _strip_parameters(i)),
    ),
    strip_damping,
    _DRAGS,
)
