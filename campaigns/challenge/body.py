# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the motion of a vehicle: Kirchhoff's equations of a rigid body in an ideal fluid, and drag.

Lamb, Hydrodynamics, chapter VI: with the impulse P and its moment H about the hull centre,

    dP/dt = P x w + F,    dH/dt = H x w + P x v + M

in body axes, where v is the velocity through the air. They hold in every uniformly moving frame,
hence in that of the air. Accelerating air exerts a force of its acceleration times the displaced
and the added mass.
"""

import math
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from campaigns.challenge.truth import Six, Triple, VehicleTruth

GRAVITY: Final = 9.80665  # m/s2
MATCHED: Final = 0.4  # m/s; speed at which hidden drag equals quadratic drag
EXPONENT: Final = 1.9  # exponent of hidden drag, unlike the model's 2
GROWTH: Final = 0.1  # s; growth of the hidden added inertia with the yaw rate
# Gauss-Legendre rule with three points: positions in -1 to 1, and weights with sum 1
GAUSS: Final = ((-math.sqrt(0.6), 5.0 / 18.0), (0.0, 8.0 / 18.0), (math.sqrt(0.6), 5.0 / 18.0))
STILL: Final[Six] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

State = list[float]  # place, velocity over the map, quaternion w x y z, body rates
Nine = tuple[float, float, float, float, float, float, float, float, float]


def rotation_matrix(w: float, x: float, y: float, z: float) -> Nine:
    """Return the rotation from body to map, row by row; the quaternion is normalised."""
    two = 2.0 / (w * w + x * x + y * y + z * z)
    xx, yy, zz = two * x * x, two * y * y, two * z * z
    xy, xz, yz = two * x * y, two * x * z, two * y * z
    wx, wy, wz = two * w * x, two * w * y, two * w * z
    return (
        1.0 - yy - zz, xy - wz, xz + wy,
        xy + wz, 1.0 - xx - zz, yz - wx,
        xz - wy, yz + wx, 1.0 - xx - yy,
    )  # fmt: skip


def cross_product(a: Triple, b: Triple) -> Triple:
    """Return a x b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def to_body(r: Nine, x: float, y: float, z: float) -> Triple:
    """Rotate a vector from map to body axes."""
    return (
        r[0] * x + r[3] * y + r[6] * z,
        r[1] * x + r[4] * y + r[7] * z,
        r[2] * x + r[5] * y + r[8] * z,
    )


def to_map(r: Nine, x: float, y: float, z: float) -> Triple:
    """Rotate a vector from body to map axes."""
    return (
        r[0] * x + r[1] * y + r[2] * z,
        r[3] * x + r[4] * y + r[5] * z,
        r[6] * x + r[7] * y + r[8] * z,
    )


def mass_matrix(truth: VehicleTruth) -> NDArray[np.float64]:
    """Return the mass matrix about the hull centre, added mass included, shape (6, 6)."""
    x, y, z = truth.cg
    # Cross-product matrix of the centre of gravity
    arm = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # Steiner: -m [c]x^2 moves the inertia to the hull centre
    turning = np.diag(truth.inertia) - truth.mass * arm @ arm + np.diag(truth.added_inertia)
    turning[2, 2] += truth.yaw_air
    moving = truth.mass * np.eye(3) + np.diag(truth.added_mass)
    return np.block([[moving, -truth.mass * arm], [truth.mass * arm, turning]])


@final
class KirchhoffBody:
    """The equations of motion with the parameters of one flight."""

    def __init__(self, truth: VehicleTruth) -> None:
        self.truth = truth
        self.masses = mass_matrix(truth)
        self._inverse: list[list[float]] = np.linalg.inv(self.masses).tolist()

    def drag_wrench(self, v: Triple, w: Triple) -> Six:
        """
        Return force and moment of drag.

        The hull is round, so horizontal drag depends on the total horizontal speed, and so does
        the lift of its incidence.
        """
        t = self.truth
        level = math.hypot(v[0], v[1])
        force = [
            -(square * speed + linear) * u
            for square, linear, speed, u in zip(
                t.drag, t.linear_drag, (level, level, abs(v[2])), v, strict=True
            )
        ]
        if t.normal and level:
            # With the tangent of the incidence: sin^2 = tan^2 / (1 + tan^2)
            tangent = v[2] / level
            loss = 1.0 + t.stall * tangent**2 / (1.0 + tangent**2)
            force[2] -= t.normal * level**2 * tangent / loss
        if any(t.extra_drag):
            for k, speed in enumerate((level, level, abs(v[2]))):
                # The prefactor makes it equal to quadratic drag at the speed MATCHED
                power = MATCHED ** (2.0 - EXPONENT) * speed ** (EXPONENT - 1.0)
                force[k] -= t.extra_drag[k] * power * v[k]
        moment = [
            -(square * abs(u) + linear) * u
            for square, linear, u in zip(t.turn_square, t.turn_linear, w, strict=True)
        ]
        a, b, c = self._plate_moment(w)
        return force[0], force[1], force[2], moment[0] + a, moment[1] + b, moment[2] + c

    def _plate_moment(self, w: Triple) -> Triple:
        """
        Return the damping moment of the plates, integrated with Gauss's rule.

        Only the velocity due to rotation counts, since the aero block of the vehicle file already
        includes their drag in straight flight.
        """
        sums = [0.0, 0.0, 0.0]
        for plate in self.truth.plates:
            for share, weight in GAUSS:
                x, y, z = (c + share * h for c, h in zip(plate.place, plate.reach, strict=True))
                u = cross_product(w, (x, y, z))
                a, b, c = (-weight * d * abs(s) * s for d, s in zip(plate.drag, u, strict=True))
                for k, each in enumerate(cross_product((x, y, z), (a, b, c))):
                    sums[k] += each
        return sums[0], sums[1], sums[2]

    def _restoring_wrench(self, up: Triple, time: float) -> Six:
        """Return the wrench of weight (at the CG), buoyancy and lift (at the hull centre)."""
        t = self.truth
        weight = t.mass * GRAVITY
        # Net force along the vertical [N]; the leak reduces it with time
        free = t.displaced * GRAVITY - weight + t.lift - t.leak * time
        moment = cross_product(t.cg, (-weight * up[0], -weight * up[1], -weight * up[2]))
        return (free * up[0], free * up[1], free * up[2], *moment)

    def _rotating_frame_wrench(self, v: Triple, w: Triple) -> Six:
        """Return P x w, and H x w + P x v: the terms of the rotating frame."""
        t = self.truth
        m, (a, b, c) = t.mass, t.added_mass
        swing = cross_product(w, t.cg)
        air = (a * v[0], b * v[1], c * v[2])
        body = (m * (v[0] + swing[0]), m * (v[1] + swing[1]), m * (v[2] + swing[2]))
        own, (i, j, k), (d, e, f) = cross_product(t.cg, body), t.inertia, t.added_inertia
        spin = (
            own[0] + (i + d) * w[0],
            own[1] + (j + e) * w[1],
            own[2] + (k + f + t.yaw_air * (1.0 + GROWTH * abs(w[2]))) * w[2],
        )
        force = cross_product((body[0] + air[0], body[1] + air[1], body[2] + air[2]), w)
        turned, pulled, munk = (
            cross_product(spin, w),
            cross_product(body, v),
            cross_product(air, v),
        )
        # The Munk moment is the cross product of the added-mass impulse and the velocity
        part = t.munk
        return (
            *force,
            turned[0] + pulled[0] + part * munk[0],
            turned[1] + pulled[1] + part * munk[1],
            turned[2] + pulled[2] + part * munk[2],
        )

    def _gust_wrench(self, r: Nine, air: Six) -> Six:
        """Return the force of accelerating air."""
        if not (air[3] or air[4] or air[5]):
            return STILL
        t, gain = self.truth, to_body(r, air[3], air[4], air[5])
        x, y, z = ((t.displaced + t.added_mass[k]) * gain[k] for k in range(3))
        return x, y, z, 0.0, 0.0, 0.0

    def rigid_body_accelerations(self, state: State, air: Six, push: Six, time: float) -> Six:
        """
        Return the acceleration of the hull centre in the map, and that of the body rates.

        Parameters
        ----------
        state : list of 13 floats
            Position, velocity, quaternion, rates.
        air : six floats
            Velocity and acceleration of the air in the map. [m/s], [m/s2]
        push : six floats
            Other wrench about the hull centre in body axes. [N], [N m]
        time : float
            Time since the start. [s]

        """
        r = rotation_matrix(state[6], state[7], state[8], state[9])
        w = (state[10], state[11], state[12])
        v = to_body(r, state[3] - air[0], state[4] - air[1], state[5] - air[2])
        parts = (
            push, self.drag_wrench(v, w), self._restoring_wrench((r[6], r[7], r[8]), time),
            self._rotating_frame_wrench(v, w), self._gust_wrench(r, air),
        )  # fmt: skip
        a, b, c, d, e, f = map(sum, zip(*parts, strict=True))
        gains = [
            n[0] * a + n[1] * b + n[2] * c + n[3] * d + n[4] * e + n[5] * f for n in self._inverse
        ]
        if self.truth.yaw_air:
            # The impulse J (1 + g |r|) r grows by J (1 + 2 g |r|) a rate; the matrix has J.
            more = 2.0 * GROWTH * self.truth.yaw_air * abs(w[2])
            share = more * gains[5] / (1.0 + more * self._inverse[5][5])
            gains = [g - share * n[5] for g, n in zip(gains, self._inverse, strict=True)]
        # The equations give the derivative in the rotating frame; add w x v for the inertial one
        turned = cross_product(w, v)
        over = to_map(r, gains[0] + turned[0], gains[1] + turned[1], gains[2] + turned[2])
        return (*over, gains[3], gains[4], gains[5])
