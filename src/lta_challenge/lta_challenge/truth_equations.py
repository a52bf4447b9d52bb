"""
Source of the truth simulator's equations of motion, independent of the model under test.

It shares only the equations of the effects (`lta_model.effects`). Rigid body, rotors and command
path are implemented separately and in another form, so that both do not have the same errors. The
state has the rotation matrix instead of a quaternion, and momenta in map axes instead of body
velocities. With P and L the linear and angular momentum of body and added mass about the hull
centre, and W the wind there (Kirchhoff; Auton et al. 1988):

    P = R (m v + w x m r + A (v - R' W)),   L = R (I w + m r x v + A_2 w)
    d/dt P = R F + R (m_d + A) R' DU/Dt - R A R' dW/dt
    d/dt L = R (N - v x p_rb - v_r x A v_r)

DU/Dt and dW/dt are finite differences of the wind along the path of the air and of the hull.
Misaligned rotor axes are rotated exactly.
"""

from typing import Final

TEMPLATE: Final = '''"""The truth of a challenge, composed; edits here are lost."""

from collections import namedtuple
import math

from numba import njit
import numpy as np

Motion = namedtuple('Motion', $motion)
Place = namedtuple('Place', $place)
ROTORS = $rotors
SIZE = $size


$functions


$own
def wind_at(x, y, z, p, on, around):
    """Return the wind at a place."""
    u, v, w = 0.0, 0.0, 0.0
    at, still = (x, y, z), (0.0, 0.0, 0.0)
$air
    return u, v, w


$own
def turned(y, a, b, c):
    """Return a map vector in body axes."""
    return (y[3] * a + y[6] * b + y[9] * c, y[4] * a + y[7] * b + y[10] * c,
            y[5] * a + y[8] * b + y[11] * c)


$own
def speeds(y, p, on, around, body, inverse, out):
    """Write velocity and rates, body axes, then the wind in body axes."""
    u, v, w = wind_at(y[0], y[1], y[2], p, on, around)
    a, b, c = turned(y, u, v, w)
    d, e, f = turned(y, y[12], y[13], y[14])
    g, h, i = turned(y, y[15], y[16], y[17])
    q = (d + body[10] * a, e + body[11] * b, f + body[12] * c, g, h, i)
    for k in range(6):
        out[k] = 0.0
        for j in range(6):
            out[k] += inverse[k, j] * q[j]
    out[6], out[7], out[8] = a, b, c


$own
def rotors(y, dy, told, p, on, around, u):
    """Write the thrust of each rotor."""
    for j in range(ROTORS):
        value = told[j]
$actuators
        u[j] = value


$own
def slope(y, dy, told, p, on, around, body, inverse, lift, allocation, pushed, u, s, extra):
    """Write d/dt of the state; `extra` takes what no vehicle file has."""
    for k in range(SIZE):
        dy[k] = 0.0
    speeds(y, p, on, around, body, inverse, s)
    rotors(y, dy, told, p, on, around, u)
    r = (y[3], y[4], y[5], y[6], y[7], y[8], y[9], y[10], y[11])
    v, w = (s[0], s[1], s[2]), (s[3], s[4], s[5])
    air = (v[0] - s[6], v[1] - s[7], v[2] - s[8])
    motion = Motion((y[0], y[1], y[2]), r, v, w, air, body, told, around)
    # Weight and buoyancy along the vertical seen from the body; the moment is m r x (-g up).
    g, net = lift[0], lift[0] * (body[16] - body[0])
    f0, f1, f2 = net * r[6], net * r[7], net * r[8]
    n0 = -g * (body[2] * r[8] - body[3] * r[7])
    n1 = -g * (body[3] * r[6] - body[1] * r[8])
    n2 = -g * (body[1] * r[7] - body[2] * r[6])
    if pushed:
        f0, f1, f2 = f0 + told[0], f1 + told[1], f2 + told[2]
        n0, n1, n2 = n0 + told[3], n1 + told[4], n2 + told[5]
    else:
        for j in range(ROTORS):
            f0 += allocation[j, 0] * u[j]
            f1 += allocation[j, 1] * u[j]
            f2 += allocation[j, 2] * u[j]
            n0 += allocation[j, 3] * u[j]
            n1 += allocation[j, 4] * u[j]
            n2 += allocation[j, 5] * u[j]
    for k in range(6):
        extra[k] = 0.0
$wrenches
    f0, f1, f2 = f0 + extra[0], f1 + extra[1], f2 + extra[2]
    n0, n1, n2 = n0 + extra[3], n1 + extra[4], n2 + extra[5]
    # What the body has of the momentum, and the air.
    b0 = body[0] * v[0] + w[1] * body[3] - w[2] * body[2]
    b1 = body[0] * v[1] + w[2] * body[1] - w[0] * body[3]
    b2 = body[0] * v[2] + w[0] * body[2] - w[1] * body[1]
    a0, a1, a2 = body[10] * air[0], body[11] * air[1], body[12] * air[2]
    n0 -= v[1] * b2 - v[2] * b1 + air[1] * a2 - air[2] * a1
    n1 -= v[2] * b0 - v[0] * b2 + air[2] * a0 - air[0] * a2
    n2 -= v[0] * b1 - v[1] * b0 + air[0] * a1 - air[1] * a0
    x0 = r[0] * v[0] + r[1] * v[1] + r[2] * v[2]
    x1 = r[3] * v[0] + r[4] * v[1] + r[5] * v[2]
    x2 = r[6] * v[0] + r[7] * v[1] + r[8] * v[2]
    if $windy:
        h = 1e-3
        e0, e1, e2 = wind_at(y[0], y[1], y[2], p, on, around)
        c0, c1, c2 = wind_at(y[0] + h * e0, y[1] + h * e1, y[2] + h * e2, p, on, around)
        d0, d1, d2 = wind_at(y[0] - h * e0, y[1] - h * e1, y[2] - h * e2, p, on, around)
        k0, k1, k2 = turned(y, (c0 - d0) / (2 * h), (c1 - d1) / (2 * h), (c2 - d2) / (2 * h))
        c0, c1, c2 = wind_at(y[0] + h * x0, y[1] + h * x1, y[2] + h * x2, p, on, around)
        d0, d1, d2 = wind_at(y[0] - h * x0, y[1] - h * x1, y[2] - h * x2, p, on, around)
        l0, l1, l2 = turned(y, (c0 - d0) / (2 * h), (c1 - d1) / (2 * h), (c2 - d2) / (2 * h))
        f0 += (body[16] + body[10]) * k0 - body[10] * l0
        f1 += (body[16] + body[11]) * k1 - body[11] * l1
        f2 += (body[16] + body[12]) * k2 - body[12] * l2
    dy[0], dy[1], dy[2] = x0, x1, x2
    for k in range(3):
        a, b, c = y[3 + 3 * k], y[4 + 3 * k], y[5 + 3 * k]
        dy[3 + 3 * k] = b * w[2] - c * w[1]
        dy[4 + 3 * k] = c * w[0] - a * w[2]
        dy[5 + 3 * k] = a * w[1] - b * w[0]
        dy[12 + k] = a * f0 + b * f1 + c * f2
        dy[15 + k] = a * n0 + b * n1 + c * n2
'''
