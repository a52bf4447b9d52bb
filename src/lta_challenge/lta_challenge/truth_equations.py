"""
Equations of motion of the truth simulator, independent of the model under test.

It shares only the equations of the effects (`lta_model.effects`). Rigid body, rotors and command
path are implemented separately and in another form, so that both do not have the same errors. The
state has the rotation matrix instead of a quaternion, and momenta in map axes instead of body
velocities. With P and L the linear and angular momentum of body and added mass about the hull
centre, and W the wind there (Kirchhoff; Auton et al. 1988):

    P = R (m v + w x m r + A (v - R' W)),   L = R (I w + m r x v + A_2 w)
    d/dt P = R F + R (m_d + A) R' DU/Dt - R A R' dW/dt
    d/dt L = R (N - v x p_rb - v_r x A v_r)

DU/Dt and dW/dt are finite differences of the wind along the path of the air and of the hull.
Misaligned rotor axes are rotated exactly. The functions are compiled with what `truth_source`
generates for the effects (`TruthKernel`).
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from lta_config.compilation.extract import GeneratedFunction
from lta_model.effects.protocol import VehicleMotion
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
WIND_DISTANCE = 1e-3  # over which the wind is differentiated, in seconds of travel


class TruthConstants(NamedTuple):
    """Values that stay constant during a flight, except the voltage."""

    # Parameters and flags of the effects
    parameters: Array
    on: NDArray[np.bool_]
    # `lta_model.state.VOLTAGE` is the index of the battery voltage, shape (SURROUNDINGS,)
    surroundings: Array
    # Mass properties, and the inverse of the inertia matrix
    body: Array
    inverse: Array
    lift: Array  # gravity [m/s2]
    allocation: Array  # wrench of each rotor per newton, shape (rotors, 6)
    pushed: bool  # whether commands are wrenches instead of duties


class TruthWork(NamedTuple):
    """Working arrays."""

    stages: Array  # derivatives of the integrator's stages, and a state, shape (7, size)
    command: Array  # the command that acts, shape (8,)
    thrusts: Array  # thrust of each rotor, shape (8,) [N]
    speeds: Array  # velocity, rates and wind, body axes, shape (9,)
    strange: Array  # wrench of the effects outside the library, shape (6,)
    height_sum: Array  # integral of the pilot's height control, shape (1,)
    square: Array  # for a matrix product, shape (3, 3)


class TruthKernel(NamedTuple):
    """The parts of the equations that depend on the effects and the number of rotors."""

    # Number of rotors, and of elements in the state
    rotors: int
    size: int
    wind_at: Callable[..., Vector] = GeneratedFunction('wind_at')  # wind at a place
    # Whether the flags switch on any wind
    is_windy: Callable[..., bool] = GeneratedFunction('is_windy')
    # Writes the thrust of each rotor, and the derivative of the rotors' memory
    write_thrusts: Callable[..., None] = GeneratedFunction('write_thrusts')
    # Adds the wrenches of the effects to force and moment; writes those outside the library
    add_wrenches: Callable[..., Any] = GeneratedFunction('add_wrenches')


def to_body_axes(y: Array, vector: Vector) -> Vector:
    """Return a map vector in body axes."""
    a, b, c = vector
    return (
        y[3] * a + y[6] * b + y[9] * c,
        y[4] * a + y[7] * b + y[10] * c,
        y[5] * a + y[8] * b + y[11] * c,
    )


def write_speeds(kernel: TruthKernel, y: Array, hull: TruthConstants, out: Array) -> None:
    """Write velocity and rates, body axes, then the wind in body axes."""
    body = hull.body
    wind = kernel.wind_at(y[0], y[1], y[2], hull.parameters, hull.on, hull.surroundings)
    a, b, c = to_body_axes(y, wind)
    d, e, f = to_body_axes(y, (y[12], y[13], y[14]))
    g, h, i = to_body_axes(y, (y[15], y[16], y[17]))
    q = (d + body[10] * a, e + body[11] * b, f + body[12] * c, g, h, i)
    for k in range(6):
        out[k] = 0.0
        for j in range(6):
            out[k] += hull.inverse[k, j] * q[j]
    out[6], out[7], out[8] = a, b, c


def write_slope(
    kernel: TruthKernel, y: Array, dy: Array, hull: TruthConstants, work: TruthWork
) -> None:
    """Write d/dt of the state, and the thrusts, speeds and strange wrench in `work`."""
    body, u, s, extra = hull.body, work.thrusts, work.speeds, work.strange
    for k in range(kernel.size):
        dy[k] = 0.0
    write_speeds(kernel, y, hull, s)
    kernel.write_thrusts(y, dy, work.command, hull.parameters, hull.on, hull.surroundings, u)
    r = (y[3], y[4], y[5], y[6], y[7], y[8], y[9], y[10], y[11])
    v, w = (s[0], s[1], s[2]), (s[3], s[4], s[5])
    air = (v[0] - s[6], v[1] - s[7], v[2] - s[8])
    motion = VehicleMotion(
        (y[0], y[1], y[2]),
        r,
        v,
        w,
        air,
        # The effects only index these
        body,  # type: ignore[arg-type]
        work.command,  # type: ignore[arg-type]
        hull.surroundings,  # type: ignore[arg-type]
    )
    f0, f1, f2, n0, n1, n2 = command_wrench(kernel, r, hull, work)
    for k in range(6):
        extra[k] = 0.0
    f0, f1, f2, n0, n1, n2 = kernel.add_wrenches(
        f0, f1, f2, n0, n1, n2, y, dy, hull.parameters, hull.on, motion, u, extra
    )
    f0, f1, f2 = f0 + extra[0], f1 + extra[1], f2 + extra[2]
    n0, n1, n2 = n0 + extra[3], n1 + extra[4], n2 + extra[5]
    # Momentum of the body, and of the air that it moves
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
    if kernel.is_windy(hull.on):
        wind = kernel.wind_at(y[0], y[1], y[2], hull.parameters, hull.on, hull.surroundings)
        k0, k1, k2 = wind_change(kernel, y, hull, wind)
        l0, l1, l2 = wind_change(kernel, y, hull, (x0, x1, x2))
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


def command_wrench(
    kernel: TruthKernel, r: tuple[float, ...], hull: TruthConstants, work: TruthWork
) -> tuple[float, float, float, float, float, float]:
    """Return the wrench of weight, buoyancy and command in body axes. [N, N m]"""
    body, command, u = hull.body, work.command, work.thrusts
    # Weight and buoyancy along the vertical seen from the body; the moment is m r x (-g up)
    g, net = hull.lift[0], hull.lift[0] * (body[16] - body[0])
    f0, f1, f2 = net * r[6], net * r[7], net * r[8]
    n0 = -g * (body[2] * r[8] - body[3] * r[7])
    n1 = -g * (body[3] * r[6] - body[1] * r[8])
    n2 = -g * (body[1] * r[7] - body[2] * r[6])
    if hull.pushed:
        f0, f1, f2 = f0 + command[0], f1 + command[1], f2 + command[2]
        n0, n1, n2 = n0 + command[3], n1 + command[4], n2 + command[5]
    else:
        for j in range(kernel.rotors):
            f0 += hull.allocation[j, 0] * u[j]
            f1 += hull.allocation[j, 1] * u[j]
            f2 += hull.allocation[j, 2] * u[j]
            n0 += hull.allocation[j, 3] * u[j]
            n1 += hull.allocation[j, 4] * u[j]
            n2 += hull.allocation[j, 5] * u[j]
    return f0, f1, f2, n0, n1, n2


def wind_change(kernel: TruthKernel, y: Array, hull: TruthConstants, speed: Vector) -> Vector:
    """Return the rate of change of the wind along a path in the map, in body axes. [m/s2]"""
    p, on, around, h = hull.parameters, hull.on, hull.surroundings, WIND_DISTANCE
    x, y_, z = h * speed[0], h * speed[1], h * speed[2]
    c0, c1, c2 = kernel.wind_at(y[0] + x, y[1] + y_, y[2] + z, p, on, around)
    d0, d1, d2 = kernel.wind_at(y[0] - x, y[1] - y_, y[2] - z, p, on, around)
    change = ((c0 - d0) / (2 * h), (c1 - d1) / (2 * h), (c2 - d2) / (2 * h))
    return to_body_axes(y, change)
