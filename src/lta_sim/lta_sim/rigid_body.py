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

The term v_r x p_a is the Munk moment. `body` holds m, m r (3), I_o (xx yy zz xy xz yz), A (6).
"""

from collections.abc import Sequence

from lta_sim.effects.protocol import Matrix3, Motion, Quaternion, Vector, Wrench


def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def rotation(q: Quaternion) -> Matrix3:
    """Return the rotation body -> map of a quaternion x y z w of any length, row by row."""
    x, y, z, w = q
    s = 2.0 / (x * x + y * y + z * z + w * w)
    return (
        1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w),
        s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w),
        s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y),
    )  # fmt: skip


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


def motion(
    position: Vector, q: Quaternion, velocity: Vector, rates: Vector, wind: Vector
) -> Motion:
    """Return what the effects see: attitude as a matrix and the air-relative velocity."""
    r = rotation(q)
    air = to_body(r, wind)
    airspeed = (velocity[0] - air[0], velocity[1] - air[1], velocity[2] - air[2])
    return Motion(position, r, velocity, rates, airspeed)


def momentum_rate(wrench: Wrench, m: Motion, air: Vector, body: Sequence[float]) -> Wrench:
    """Return M d/dt (v, w): the wrench less what the turning and moving frame takes."""
    v, w, v_r = m.velocity, m.rates, m.airspeed
    moment = (body[1], body[2], body[3])
    lift = cross(w, moment)
    swing = cross(moment, v)
    p_rb = (body[0] * v[0] + lift[0], body[0] * v[1] + lift[1], body[0] * v[2] + lift[2])
    p_a = (body[10] * v_r[0], body[11] * v_r[1], body[12] * v_r[2])
    h = (
        (body[4] + body[13]) * w[0] + body[7] * w[1] + body[8] * w[2] + swing[0],
        body[7] * w[0] + (body[5] + body[14]) * w[1] + body[9] * w[2] + swing[1],
        body[8] * w[0] + body[9] * w[1] + (body[6] + body[15]) * w[2] + swing[2],
    )
    turn = cross(w, (p_rb[0] + p_a[0], p_rb[1] + p_a[1], p_rb[2] + p_a[2]))
    wind = cross(w, air)
    spin, carry, munk = cross(w, h), cross(v, p_rb), cross(v_r, p_a)
    return (
        wrench[0] - turn[0] - body[10] * wind[0],
        wrench[1] - turn[1] - body[11] * wind[1],
        wrench[2] - turn[2] - body[12] * wind[2],
        wrench[3] - spin[0] - carry[0] - munk[0],
        wrench[4] - spin[1] - carry[1] - munk[1],
        wrench[5] - spin[2] - carry[2] - munk[2],
    )


def row(inverse: Sequence[float], i: int, rate: Wrench) -> float:
    """Return row i of the inverse mass matrix (36 numbers, row by row) times a 6-tuple."""
    k = 6 * i
    return (
        inverse[k] * rate[0] + inverse[k + 1] * rate[1] + inverse[k + 2] * rate[2]
        + inverse[k + 3] * rate[3] + inverse[k + 4] * rate[4] + inverse[k + 5] * rate[5]
    )  # fmt: skip


def acceleration(
    wrench: Wrench, m: Motion, air: Vector, body: Sequence[float], inverse: Sequence[float]
) -> Wrench:
    """
    Return d/dt of the body velocity and of the body rates.

    Parameters
    ----------
    wrench : 6-tuple
        Sum of all effects about the hull centre, body frame. [N, N m]
    m : Motion
        What the effects saw.
    air : 3-tuple
        Velocity of the air in the body frame. [m/s]
    body : 16 floats
        m, m r, I_o, A as in the module's docstring.
    inverse : 36 floats
        Inverse of the mass matrix, row by row.

    Returns
    -------
    6-tuple
        Acceleration of the body components. [m/s^2, rad/s^2]

    """
    rate = momentum_rate(wrench, m, air, body)
    return (
        row(inverse, 0, rate), row(inverse, 1, rate), row(inverse, 2, rate),
        row(inverse, 3, rate), row(inverse, 4, rate), row(inverse, 5, rate),
    )  # fmt: skip
