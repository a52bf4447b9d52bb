# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The drone's motion: its attitude, what control laws and guidance take of it, and dead reckoning.

The navigator steers by the way through the air: the strategies estimate the wind themselves, from
the difference between the way through the air and what they see of the lamp.
"""

from collections import deque
from collections.abc import Iterable
import math
from typing import final, NamedTuple

Quaternion = tuple[float, float, float, float]  # x, y, z, w; body to odom
Vector = tuple[float, float, float]


class ControlMotion(NamedTuple):
    """Motion of the vehicle as input of a law; the frame begins at the vehicle's start."""

    # Of the hull centre; z above the floor. Without a tracker, x and y are dead reckoning [m]
    position: Vector = (0.0, 0.0, 0.0)
    attitude: Quaternion = (0.0, 0.0, 0.0, 1.0)  # body to that frame, x y z w
    # Body frame: over ground from a tracker, through the air from the estimator [m/s]
    velocity: Vector = (0.0, 0.0, 0.0)
    rates: Vector = (0.0, 0.0, 0.0)  # body frame [rad/s]


class CascadeMeasurement(NamedTuple):
    """Input of the cascade from the estimator."""

    altitude: float  # of the hull centre above the floor [m]
    climb: float  # [m/s]
    heading: float  # [rad]
    yaw_rate: float  # [rad/s]
    speed: float  # forward airspeed [m/s]
    sway: float  # airspeed to the left [m/s]
    pitch_rate: float  # nose down [rad/s]


class Setpoint(NamedTuple):
    """Setpoint from the navigator."""

    altitude: float  # [m]
    heading: float  # [rad]
    speed: float  # forward airspeed [m/s]


FLOOR_SETPOINT = Setpoint(0.0, 0.0, 0.0)  # to rest on the ground


def up_in_body(q: Quaternion) -> Vector:
    """Return the world's up direction in the body frame."""
    x, y, z, w = q
    return 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z


def climb_rate(motion: ControlMotion) -> float:
    """Return the vertical velocity [m/s]."""
    (x, y, z), (u, v, w) = up_in_body(motion.attitude), motion.velocity
    return x * u + y * v + z * w


def has_overturned(attitude: Quaternion, uprightness: float) -> bool:
    """
    Return whether the drone tilts so far that its motors stop; False if its attitude is NaN.

    `uprightness` is the cosine of the largest tilt.
    """
    return up_in_body(attitude)[2] < uprightness


def measure_motion(motion: ControlMotion) -> CascadeMeasurement:
    """Return the input of the cascade."""
    velocity, rates = motion.velocity, motion.rates
    return CascadeMeasurement(
        altitude=motion.position[2],
        climb=climb_rate(motion),
        heading=yaw_from_quaternion(motion.attitude),
        yaw_rate=rates[2],
        speed=velocity[0],
        sway=velocity[1],
        pitch_rate=rates[1],
    )


def wrap_angle(angle: float) -> float:
    """Return an angle in [-pi, pi) [rad]."""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


def drag_force(linear: float, quadratic: float, speed: float) -> float:
    """Return the drag at a speed along one axis, F_D of the paper. [N]."""
    return (linear + quadratic * abs(speed)) * speed


def yaw_from_quaternion(q: Quaternion) -> float:
    """Return the yaw of a body-to-world quaternion, REP-103. [rad]."""
    x, y, z, w = q
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def level_quaternion(yaw: float) -> Quaternion:
    """Return the attitude of a level vehicle with a heading [rad]."""
    return 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)


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


class DeadReckonedMotion(NamedTuple):
    """Dead-reckoned motion of the drone at one instant."""

    heading: float  # [rad, odom]
    x: float  # dead reckoned through the air [m, odom]
    y: float
    forward: float  # airspeed [m/s, body]
    left: float


NOWHERE = DeadReckonedMotion(0.0, 0.0, 0.0, 0.0, 0.0)


def advance_position(
    position: tuple[float, float], forward: float, left: float, yaw: float, dt: float
) -> tuple[float, float]:
    """Return the position after a time [s] at a speed along the body's axes [m/s]."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return (
        position[0] + dt * (cos * forward - sin * left),
        position[1] + dt * (sin * forward + cos * left),
    )


@final
class AirReckoning:
    """
    The latest motions, each with the way through the air since the first one.

    `period_ns`: nominal time between two motions [ns]. `count`: number of motions kept.
    """

    def __init__(self, period_ns: int, count: int) -> None:
        self.history: deque[tuple[int, DeadReckonedMotion]] = deque(maxlen=count)
        self._period_ns = period_ns

    def add_motions(self, motions: Iterable[tuple[int, float, float, float]]) -> None:
        """Add stamps [ns], each with heading [rad] and airspeed along body x and y [m/s]."""
        for stamp_ns, yaw, forward, left in motions:
            last_ns, last = self.history[-1] if self.history else (None, NOWHERE)
            dt = step_duration(last_ns, stamp_ns, self._period_ns)
            x, y = advance_position((last.x, last.y), forward, left, yaw, dt)
            self.history.append((stamp_ns, DeadReckonedMotion(yaw, x, y, forward, left)))

    def find_nearest(self, stamp_ns: int) -> DeadReckonedMotion:
        """Return the motion nearest to a time; at rest in the origin if there is none."""
        nearest, least = NOWHERE, math.inf
        for at_ns, motion in self.history:
            if abs(at_ns - stamp_ns) < least:
                nearest, least = motion, abs(at_ns - stamp_ns)
        return nearest


def step_duration(last_ns: int | None, now_ns: int, period_ns: int) -> float:
    """
    Return the duration of one step from two stamps, at most ten periods [s].

    Best-effort messages may be lost, and the first one has no predecessor: it counts as one
    period. A stamp that is not newer than the last counts as a tenth of a period, so that time
    still advances.
    """
    if last_ns is None:
        return period_ns * 1e-9
    # The upper bound limits the jump of integrals and filters after a long gap
    return min(max(now_ns - last_ns, period_ns // 10), 10 * period_ns) * 1e-9
