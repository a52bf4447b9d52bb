# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Rigid-body motion in moving air, as scalar functions that the kernel is composed of.

Momentum about the hull centre O with the CG at r, in the body frame; the added part belongs to the
air and so follows the air-relative velocity v_r = v - R' wind (Kirchhoff's equations; Lamb 1932,
articles 124 to 126; Fossen 2011, section 8.3, there for a current):

    p_rb = m (v + w x r),   h_rb = I_o w + m r x v,   p_a = A_1 v_r,   h_a = A_2 w
    d/dt (p_rb + p_a) = F - w x (p_rb + p_a)
    d/dt (h_rb + h_a) = N - w x (h_rb + h_a) - v x p_rb - v_r x p_a

In a steady uniform wind d/dt v_r = d/dt v + w x (R' wind), hence with M = M_rb + M_a

    M d/dt (v, w) = (F - w x p - A_1 (w x R' wind),  N - w x h - v x p_rb - v_r x p_a).

Air that accelerates by DU/Dt pushes the hull as it would push the air in its place, and its added
mass with it (Auton, Hunt and Prud'homme 1988, J. Fluid Mech. 197, 241): the force (m_d + A_1) R'
DU/Dt at the hull centre, m_d the displaced mass. The vorticity of the air, which would turn the
hull, is left out.

The term v_r x p_a is the Munk moment. `body` is laid out as `lta_model.state` says.
"""

from collections.abc import Callable, Sequence
from typing import Any

from lta_model.effects.protocol import (
    AirEffectInput,
    Matrix3,
    Quaternion,
    Values,
    Vector,
    VehicleMotion,
    Wrench,
)
from lta_model.state import ADDED, DISPLACED, INERTIA, MASS, MASS_MOMENT


def cross_product(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def rotation_matrix(q: Quaternion) -> Matrix3:
    """Return the rotation body -> map of a quaternion x y z w of any length, row by row."""
    x, y, z, w = q
    # Normalises the quaternion, which drifts during integration
    s = 2.0 / (x * x + y * y + z * z + w * w)
    return (
        1.0 - s * (y * y + z * z),
        s * (x * y - z * w),
        s * (x * z + y * w),
        s * (x * y + z * w),
        1.0 - s * (x * x + z * z),
        s * (y * z - x * w),
        s * (x * z - y * w),
        s * (y * z + x * w),
        1.0 - s * (x * x + y * y),
    )


def height_and_tilt(state: Sequence[float], position: Vector) -> tuple[float, float]:
    """Return the height [m] of a body position [m], and the cosine of the tilt."""
    x, y, z, w = state[3:7]
    # Third row of R: the vertical in the body frame; c is the cosine of the tilt
    a, b, c = rotation_matrix((x, y, z, w))[6:]
    return state[2] + (a * position[0] + b * position[1] + c * position[2]), c


def to_map(r: Matrix3, v: Vector) -> Vector:
    """Return a body vector in map axes."""
    return (
        r[0] * v[0] + r[1] * v[1] + r[2] * v[2],
        r[3] * v[0] + r[4] * v[1] + r[5] * v[2],
        r[6] * v[0] + r[7] * v[1] + r[8] * v[2],
    )


def to_body(r: Matrix3, v: Vector) -> Vector:
    """Return a map vector in body axes."""
    return (
        r[0] * v[0] + r[3] * v[1] + r[6] * v[2],
        r[1] * v[0] + r[4] * v[1] + r[7] * v[2],
        r[2] * v[0] + r[5] * v[1] + r[8] * v[2],
    )


def quaternion_rate(q: Quaternion, w: Vector) -> Quaternion:
    """Return d/dt of the quaternion at body rates w, half the product q (w, 0)."""
    return (
        0.5 * (q[3] * w[0] + q[1] * w[2] - q[2] * w[1]),
        0.5 * (q[3] * w[1] + q[2] * w[0] - q[0] * w[2]),
        0.5 * (q[3] * w[2] + q[0] * w[1] - q[1] * w[0]),
        -0.5 * (q[0] * w[0] + q[1] * w[1] + q[2] * w[2]),
    )


def airspeed(r: Matrix3, velocity: Vector, wind: Vector) -> Vector:
    """Return the velocity relative to the air, in body axes, for a wind in map axes."""
    air = to_body(r, wind)
    return (velocity[0] - air[0], velocity[1] - air[1], velocity[2] - air[2])


def build_motion(
    position: Vector,
    r: Matrix3,
    velocity: Vector,
    rates: Vector,
    airspeed: Vector,
    body: Values,
    command: Values,
    surroundings: Values,
) -> VehicleMotion:
    """Return the input of the wrench effects."""
    return VehicleMotion(position, r, velocity, rates, airspeed, body, command, surroundings)


def add_wrenches(total: Wrench, wrench: Wrench) -> Wrench:
    """Return the sum of two wrenches."""
    return (
        total[0] + wrench[0],
        total[1] + wrench[1],
        total[2] + wrench[2],
        total[3] + wrench[3],
        total[4] + wrench[4],
        total[5] + wrench[5],
    )


def build_air_input(
    position: Vector, velocity: Vector, wind: Vector, surroundings: Values
) -> AirEffectInput:
    """Return the input of the air effects."""
    return AirEffectInput(position, velocity, wind, surroundings)


def momentum_rate(wrench: Wrench, m: VehicleMotion, flow: Vector) -> Wrench:
    """Return M d/dt (v, w): the wrench less the terms of the rotating and moving frame."""
    v, w, v_r, body = m.velocity, m.rates, m.airspeed, m.body
    # Wind in the body frame, from velocity and airspeed
    air = (v[0] - v_r[0], v[1] - v_r[1], v[2] - v_r[2])
    mass, surge, sway, heave = body[MASS], body[ADDED], body[ADDED + 1], body[ADDED + 2]
    moment = (body[MASS_MOMENT], body[MASS_MOMENT + 1], body[MASS_MOMENT + 2])
    xx, yy, zz = body[INERTIA], body[INERTIA + 1], body[INERTIA + 2]
    xy, xz, yz = body[INERTIA + 3], body[INERTIA + 4], body[INERTIA + 5]
    # m w x r: momentum of the CG due to rotation
    lift = cross_product(w, moment)
    # m r x v
    swing = cross_product(moment, v)
    p_rb = (mass * v[0] + lift[0], mass * v[1] + lift[1], mass * v[2] + lift[2])
    p_a = (surge * v_r[0], sway * v_r[1], heave * v_r[2])
    # Angular momentum, rigid and added
    h = (
        (xx + body[ADDED + 3]) * w[0] + xy * w[1] + xz * w[2] + swing[0],
        xy * w[0] + (yy + body[ADDED + 4]) * w[1] + yz * w[2] + swing[1],
        xz * w[0] + yz * w[1] + (zz + body[ADDED + 5]) * w[2] + swing[2],
    )
    # Transport terms of the rotating frame
    turn = cross_product(w, (p_rb[0] + p_a[0], p_rb[1] + p_a[1], p_rb[2] + p_a[2]))
    wind = cross_product(w, air)
    spin, carry, munk = cross_product(w, h), cross_product(v, p_rb), cross_product(v_r, p_a)
    # Froude-Krylov force of accelerating air, with the added mass
    push = to_body(m.rotation, flow)
    displaced = body[DISPLACED]
    return (
        wrench[0] - turn[0] - surge * wind[0] + (displaced + surge) * push[0],
        wrench[1] - turn[1] - sway * wind[1] + (displaced + sway) * push[1],
        wrench[2] - turn[2] - heave * wind[2] + (displaced + heave) * push[2],
        wrench[3] - spin[0] - carry[0] - munk[0],
        wrench[4] - spin[1] - carry[1] - munk[1],
        wrench[5] - spin[2] - carry[2] - munk[2],
    )


def multiply_row(inverse: Sequence[float], i: int, rate: Wrench) -> float:
    """Return row i of the inverse mass matrix (36 numbers, row by row) times a 6-tuple."""
    k = 6 * i
    return (
        inverse[k] * rate[0]
        + inverse[k + 1] * rate[1]
        + inverse[k + 2] * rate[2]
        + inverse[k + 3] * rate[3]
        + inverse[k + 4] * rate[4]
        + inverse[k + 5] * rate[5]
    )


def body_acceleration(
    wrench: Wrench, m: VehicleMotion, flow: Vector, inverse: Sequence[float]
) -> Wrench:
    """
    Return d/dt of the body velocity [m/s^2] and of the body rates [rad/s^2].

    `wrench` is the sum of all effects about the hull centre, body frame [N, N m]; `flow` the
    material acceleration of the air in `map` [m/s^2]; `inverse` the inverse mass matrix, row by
    row.
    """
    rate = momentum_rate(wrench, m, flow)
    return (
        multiply_row(inverse, 0, rate),
        multiply_row(inverse, 1, rate),
        multiply_row(inverse, 2, rate),
        multiply_row(inverse, 3, rate),
        multiply_row(inverse, 4, rate),
        multiply_row(inverse, 5, rate),
    )


# Functions that the kernel consists of, besides the effects.
TAKEN: tuple[Callable[..., Any], ...] = (
    rotation_matrix,
    to_map,
    airspeed,
    build_motion,
    build_air_input,
    add_wrenches,
    quaternion_rate,
    body_acceleration,
)
