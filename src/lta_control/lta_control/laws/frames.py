"""Rotate vectors between body, world, and the level frame of a heading."""

import math

from lta_control.attitude import Quaternion, Vector


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
    )  # fmt: skip


def to_body(q: Quaternion, v: Vector) -> Vector:
    """Return a world vector in the body frame."""
    return to_world((-q[0], -q[1], -q[2], q[3]), v)


def rotate_level_to_world(yaw: float, forward: float, left: float) -> tuple[float, float]:
    """Return world x and y of a level vector given along a heading and to its left."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return cos * forward - sin * left, sin * forward + cos * left


def quaternion_from_angles(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the quaternion of yaw, then pitch (positive nose down), then roll; REP-103. [rad]"""
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
