# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Estimate the attitude from gyroscope and accelerometer, and rotate vectors by it."""

import math

Quaternion = tuple[float, float, float, float]  # x, y, z, w; body to odom
Vector = tuple[float, float, float]


def up_in_body(q: Quaternion) -> Vector:
    """Return the world's up direction in the body frame."""
    x, y, z, w = q
    return 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z


def yaw_from_quaternion(q: Quaternion) -> float:
    """Return the yaw of a body-to-world quaternion, REP-103. [rad]."""
    x, y, z, w = q
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def level_quaternion(yaw: float) -> Quaternion:
    """Return the attitude of a level vehicle with a heading [rad]."""
    return 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)


def attitude_step(
    q: Quaternion, rates: Vector, force: Vector, gain: float, dt: float
) -> Quaternion:
    """
    Return the attitude one step later, as a body-to-odom quaternion x, y, z, w.

    `rates` [rad/s] and the specific force `force` [m/s2, +g up at rest] are in the body frame
    with the bias removed. `gain` is the rate at which gravity corrects roll and pitch. [1/s]
    """
    fx, fy, fz = force
    size = math.sqrt(fx * fx + fy * fy + fz * fz)
    ux, uy, uz = up_in_body(q)
    wx, wy, wz = rates
    if size > 0.0:
        # Correction: cross product of measured and estimated up direction.
        # Normalised: only the direction of the specific force counts
        k = gain / size
        wx += k * (fy * uz - fz * uy)
        wy += k * (fz * ux - fx * uz)
        wz += k * (fx * uy - fy * ux)
    x, y, z, w = q
    # Quaternion kinematics q' = q * (w, 0) / 2, one Euler step
    h = 0.5 * dt
    nx = x + h * (w * wx + y * wz - z * wy)
    ny = y + h * (w * wy + z * wx - x * wz)
    nz = z + h * (w * wz + x * wy - y * wx)
    nw = w - h * (x * wx + y * wy + z * wz)
    # Renormalise, since the Euler step leaves the unit sphere.
    norm = math.sqrt(nx * nx + ny * ny + nz * nz + nw * nw)
    return nx / norm, ny / norm, nz / norm, nw / norm


def to_world(q: Quaternion, v: Vector) -> Vector:
    """Return a body vector in the world frame; `q` is body to world."""
    x, y, z, w = q
    # v + w t + q x t with t = 2 q x v: cheaper than a rotation matrix
    tx, ty, tz = (
        2.0 * (y * v[2] - z * v[1]),
        2.0 * (z * v[0] - x * v[2]),
        2.0 * (x * v[1] - y * v[0]),
    )
    return (
        v[0] + w * tx + y * tz - z * ty,
        v[1] + w * ty + z * tx - x * tz,
        v[2] + w * tz + x * ty - y * tx,
    )


def to_body(q: Quaternion, v: Vector) -> Vector:
    """Return a world vector in the body frame."""
    return to_world((-q[0], -q[1], -q[2], q[3]), v)


def rotate_level_to_world(yaw: float, forward: float, left: float) -> tuple[float, float]:
    """Return world x and y of a level vector given along a heading and to its left."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return cos * forward - sin * left, sin * forward + cos * left


def quaternion_from_angles(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the quaternion of yaw, then pitch (positive nose down), then roll; REP-103 [rad]."""
    cr, sr = math.cos(0.5 * roll), math.sin(0.5 * roll)
    cp, sp = math.cos(0.5 * pitch), math.sin(0.5 * pitch)
    cy, sy = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def rotation_between(here: Quaternion, there: Quaternion) -> Vector:
    """
    Return the rotation from one attitude to another, in the body frame of the first.

    Twice the vector part of the shorter rotation's quaternion: the rotation vector for small
    angles. [rad]
    """
    x, y, z, w = -here[0], -here[1], -here[2], here[3]
    p, q, r, s = there
    # Quaternion product conj(here) * there
    scalar = w * s - x * p - y * q - z * r
    # q and -q are the same attitude: take the shorter rotation.
    short = 2.0 if scalar >= 0.0 else -2.0
    return (
        short * (w * p + x * s + y * r - z * q),
        short * (w * q - x * r + y * s + z * p),
        short * (w * r + x * q - y * p + z * s),
    )


def clamp_symmetric(value: float, limit: float) -> float:
    """Return a value clamped to plus and minus a limit."""
    return min(max(value, -limit), limit)
