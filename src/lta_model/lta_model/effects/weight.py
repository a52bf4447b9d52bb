# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Weight, buoyancy, balance, and what is carried."""

from collections.abc import Mapping
import math

from lta_config.constants import STANDARD_GRAVITY
from lta_model.effects.protocol import (
    BodyEffect,
    declare_each,
    EffectParameter,
    RigidBody,
    Values,
    Vector,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_model.state import DISPLACED, MASS, MASS_MOMENT, MASS_PLACE


def weight_and_buoyancy(
    p: Values, memory: Values, motion: VehicleMotion, thrust: Values
) -> Wrench:
    """
    Weight at the centre of gravity, buoyancy at the hull centre.

    With e_z the map's vertical in the body frame, m the mass of the solid parts and of the gas, r
    its centre, m_d the mass of the displaced air and g the acceleration of gravity:

        F = (m_d - m) g e_z,    N = m r x (-g e_z)

    A CG below the hull centre rights the vehicle. Buoyancy balances the air's weight only, so a
    steady wind does not enter; `rigid_body` adds that of accelerating air. Mass, balance and
    displaced air come from the body (`lta_model.state`), so every change of them acts here.
    """
    (gravity,) = p
    up, body = motion.rotation, motion.body
    # Positive for a vehicle lighter than air
    net = (body[DISPLACED] - body[MASS]) * gravity
    x, y, z = (
        body[MASS_MOMENT] * gravity,
        body[MASS_MOMENT + 1] * gravity,
        body[MASS_MOMENT + 2] * gravity,
    )
    return (
        net * up[6],
        net * up[7],
        net * up[8],
        # m r x (-g e_z)
        z * up[7] - y * up[8],
        x * up[8] - z * up[6],
        y * up[6] - x * up[7],
    )


_WEIGHT_AND_BUOYANCY_GRAVITY = 'standard gravity; spread: 0.5 %, the difference between latitudes'

WEIGHT_AND_BUOYANCY = WrenchEffect(
    'weight_and_buoyancy',
    (EffectParameter('gravity', 'm/s2', 0.0, 0.0, 30.0, 0.005, _WEIGHT_AND_BUOYANCY_GRAVITY),),
    weight_and_buoyancy,
    ('gravity',),
)


def net_lift(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Constant vertical force at the hull centre.

        F = force e_z

    e_z is the map's vertical. The error of weighing and filling, without place, mass or cause,
    unlike `payload`, `gas_purity` and `helium_leak`. A flight cannot distinguish it from a payload
    near the hull centre; weigh the vehicle.
    """
    (force,) = p
    r = motion.rotation
    # Third row of R is the map's vertical in the body frame
    return (force * r[6], force * r[7], force * r[8], 0.0, 0.0, 0.0)


_NET_LIFT_FORCE = 'spread: 2 g for a weighed and trimmed balloon (assumed)'

NET_LIFT = WrenchEffect(
    'net_lift',
    (EffectParameter('force', 'N', 0.0, -50.0, 50.0, 0.02, _NET_LIFT_FORCE),),
    net_lift,
    ('force',),
)


def with_point_mass(rigid: RigidBody, mass: float, place: Vector) -> RigidBody:
    """
    Add a point mass to a rigid body.

        m' = m + m_p,   (m r)' = m r + m_p r_p,   I' = I + m_p (|r_p|^2 1 - r_p r_p^T)

    about the hull centre, with the place from there in the body frame [m]: the theorem of Steiner
    for a body without inertia of its own. A negative mass is removed.
    """
    x, y, z = place
    m, i = rigid.moment, rigid.inertia
    inertia = (
        i[0] + mass * (y * y + z * z),
        i[1] + mass * (x * x + z * z),
        i[2] + mass * (x * x + y * y),
        # Products of inertia are tensor elements, so they take a minus
        i[3] - mass * x * y,
        i[4] - mass * x * z,
        i[5] - mass * y * z,
    )
    moment = (m[0] + mass * x, m[1] + mass * y, m[2] + mass * z)
    return RigidBody(rigid.mass + mass, moment, inertia, rigid.displaced)


def ballast(p: Values, rigid: RigidBody) -> RigidBody:
    """
    Ballast added to, or removed from, a place of the vehicle.

        m' = m + mass,   with its moment and inertia about the hull centre (`with_point_mass`)

    It adds to the ballast that trims the vehicle to the heaviness in its file; negative is
    removed. Not modelled: its size, and the air that it displaces (1 g of water 1.2 mg, of steel
    0.15 mg).
    """
    mass, x, y, z = p
    return with_point_mass(rigid, mass, (x, y, z))


_BALLAST_MASS = (
    'spread: 2 g, the accuracy of trimming a balloon (assumed); limits: trim of a small vehicle'
)
_BALLAST_PLACE = (
    'spread: 5 cm for a position read off the vehicle (assumed); limits: a hull of 10 m'
)

BALLAST = BodyEffect(
    'ballast',
    (
        EffectParameter('mass', 'kg', 0.0, -1.0, 1.0, 0.002, _BALLAST_MASS),
        *declare_each(('x', 'y', 'z'), 'm', 0.0, -5.0, 5.0, 0.05, _BALLAST_PLACE),
    ),
    ballast,
)


def payload(p: Values, rigid: RigidBody) -> RigidBody:
    """
    Load carried at a place of the vehicle.

        m' = m + mass,   with its moment and inertia about the hull centre (`with_point_mass`)

    It is not one of the vehicle's parts, so it is lifted and not trimmed away. Not modelled: its
    size, its drag, and the air that it displaces.
    """
    mass, x, y, z = p
    return with_point_mass(rigid, mass, (x, y, z))


_PAYLOAD_MASS = (
    'spread: 2 g, as in the comparison of the seed paper; limit: an airship with 50 kg of lift'
)
_PAYLOAD_PLACE = (
    'spread: 5 cm for a position read off the vehicle (assumed); limits: a hull of 10 m'
)

PAYLOAD = BodyEffect(
    'payload',
    (
        EffectParameter('mass', 'kg', 0.0, 0.0, 50.0, 0.002, _PAYLOAD_MASS),
        *declare_each(('x', 'y', 'z'), 'm', 0.0, -5.0, 5.0, 0.05, _PAYLOAD_PLACE),
    ),
    payload,
)


def with_cg_shifted(rigid: RigidBody, shift: Vector) -> RigidBody:
    """
    Shift the centre of gravity of a rigid body by a vector in the body frame [m].

        r' = r + d,   I' = I + m ((2 r.d + d.d) 1 - r d^T - d r^T - d d^T)

    Mass and inertia about the CG stay. The inertia about the hull centre follows by the theorem of
    Steiner, I = I_cg + m (|r|^2 1 - r r^T), at r + d and at r. As a difference it needs no
    division by the mass and is exactly zero for d = 0.
    """
    x, y, z = shift
    m, mass, i = rigid.moment, rigid.mass, rigid.inertia
    # m ((x + dx)^2 - x^2) = (2 m x + m dx) dx, with m x the stored moment
    s_x = (2.0 * m[0] + mass * x) * x
    s_y = (2.0 * m[1] + mass * y) * y
    s_z = (2.0 * m[2] + mass * z) * z
    inertia = (
        i[0] + s_y + s_z,
        i[1] + s_x + s_z,
        i[2] + s_x + s_y,
        # Products of inertia are tensor elements, so they take a minus
        i[3] - (m[0] * y + m[1] * x + mass * x * y),
        i[4] - (m[0] * z + m[2] * x + mass * x * z),
        i[5] - (m[1] * z + m[2] * y + mass * y * z),
    )
    moment = (m[0] + mass * x, m[1] + mass * y, m[2] + mass * z)
    return RigidBody(mass, moment, inertia, rigid.displaced)


def cg_height(p: Values, rigid: RigidBody) -> RigidBody:
    """
    Vertical shift of the centre of gravity.

        r' = r + (0, 0, z),   inertia about the hull centre by Steiner (`with_cg_shifted`)

    Mass and inertia about the CG stay. The shift changes the righting moment, and so the period of
    the pendulum motion; a CG above the hull centre is unstable.
    """
    (z,) = p
    return with_cg_shifted(rigid, (0.0, 0.0, z))


_CG_HEIGHT_SOURCE = (
    'spread: published depths of the CG of one GT-MAB are 5 cm and 8.7 to 9.7 cm, with '
    'parts known to 1 cm (assumed); limits: a hull of 6 m'
)

CG_HEIGHT = BodyEffect(
    'cg_height', (EffectParameter('z', 'm', 0.0, -3.0, 3.0, 0.01, _CG_HEIGHT_SOURCE),), cg_height
)


def cg_offset(p: Values, rigid: RigidBody) -> RigidBody:
    """
    Horizontal shift of the centre of gravity.

        r' = r + (x, y, 0),   inertia about the hull centre by Steiner (`with_cg_shifted`)

    Mass and inertia about the CG stay. The tilt at rest shows it: tan(tilt) is the offset over the
    depth of the CG below the hull centre.
    """
    x, y = p
    return with_cg_shifted(rigid, (x, y, 0.0))


_CG_OFFSET_SOURCE = (
    'spread: 5 mm for a balanced CG, 3.6 deg of tilt at a depth of 8 cm (assumed); limits: a '
    'hull of 6 m'
)

CG_OFFSET = BodyEffect(
    'cg_offset',
    declare_each(('x', 'y'), 'm', 0.0, -3.0, 3.0, 0.005, _CG_OFFSET_SOURCE),
    cg_offset,
)


def moving_mass(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Weight of a mass that is moved within the vehicle, as in RGBlimp.

        N = d x (-mass g e_z),    d/dt d = (c - r_0 - d) / lag,   no faster than `speed`

    d (memory) is the displacement of the mass from r_0 = (x, y, z), its place when the vehicle was
    weighed and at the start of a flight; c is the commanded place (`state.MASS_PLACE`, body
    frame), e_z the map's vertical. The vehicle's weight includes the mass, so only the moment
    changes: the tilt at rest is atan(mass d / (m depth)) for a vehicle of mass m with its CG at
    that depth. `lag` 0: the mass is at the commanded place. `speed` 0: no limit; it limits the
    length of the velocity, so the path stays straight.

    Not modelled, with figures for RGBlimp (54 g of 159 g, +-4 cm, 7.5 cm ahead of and 24 cm below
    the hull centre): the inertia, 4.1e-4 of 1.9e-2 kg m2 in pitch (2.2 %) and 5.1e-4 kg m2 of its
    xz product; the shift of the CG in accelerations, a / g of this moment (3 % at 0.3 m/s2); and
    the recoil, 54/159 of the stroke of the mass, 1.4 cm, which sums to zero over a move.
    """
    mass, x, y, z, lag, speed = p  # noqa: RUF059 (the kernel knows parameters by their order)
    c = motion.command
    # Without a lag the mass follows the command at once
    d_x = memory[0] if lag > 0.0 else c[MASS_PLACE] - x
    d_y = memory[1] if lag > 0.0 else c[MASS_PLACE + 1] - y
    d_z = memory[2] if lag > 0.0 else c[MASS_PLACE + 2] - z
    weight, up = mass * STANDARD_GRAVITY, motion.rotation
    return (
        0.0,
        0.0,
        0.0,
        # d x (-mass g e_z), with e_z in the third row of R
        -weight * (d_y * up[8] - d_z * up[7]),
        -weight * (d_z * up[6] - d_x * up[8]),
        -weight * (d_x * up[7] - d_y * up[6]),
    )


def moving_mass_rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the velocity of the mass in the vehicle."""
    mass, x, y, z, lag, speed = p  # noqa: RUF059 (the kernel knows parameters by their order)
    c = motion.command
    if lag <= 0.0:
        return (0.0, 0.0, 0.0)
    # First-order approach to the commanded displacement
    v_x = (c[MASS_PLACE] - x - memory[0]) / lag
    v_y = (c[MASS_PLACE + 1] - y - memory[1]) / lag
    v_z = (c[MASS_PLACE + 2] - z - memory[2]) / lag
    fast = math.sqrt(v_x * v_x + v_y * v_y + v_z * v_z)
    # Scale the whole vector, so that the path stays straight
    share = speed / fast if 0.0 < speed < fast else 1.0
    return (share * v_x, share * v_y, share * v_z)


def check_moving_mass(values: Mapping[str, float]) -> str:
    """Return an objection to a speed limit without lag: the mass would chatter about its goal."""
    if values['speed'] > 0.0 and values['lag'] == 0.0:
        return 'a speed limit needs a time constant; set lag, or leave speed at zero'
    return ''


_MOVING_MASS_PLACE = 'spread: 5 mm for a measured position (assumed); limits: a hull of 10 m'
_MOVING_MASS_MASS = 'spread: 1 % of the 54.07 g of RGBlimp (zhu-yj/ABNODE@138a1de), weighed'
_MOVING_MASS_LAG = 'spread: small servos settle within tenths of a second (assumed)'
_MOVING_MASS_SPEED = 'spread: small servos move by centimetres in tenths of a second (assumed)'

MOVING_MASS = WrenchEffect(
    'moving_mass',
    (
        EffectParameter('mass', 'kg', 0.0, 0.0, 50.0, 5e-4, _MOVING_MASS_MASS),
        *declare_each(('x', 'y', 'z'), 'm', 0.0, -5.0, 5.0, 0.005, _MOVING_MASS_PLACE),
        EffectParameter('lag', 's', 0.0, 0.01, 100.0, 0.1, _MOVING_MASS_LAG),
        EffectParameter('speed', 'm/s', 0.0, 1e-4, 10.0, 0.05, _MOVING_MASS_SPEED),
    ),
    moving_mass,
    ('mass',),
    memory=(('x', 0.0), ('y', 0.0), ('z', 0.0)),
    rate=moving_mass_rate,
    check=check_moving_mass,
)
