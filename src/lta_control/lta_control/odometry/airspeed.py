# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate the planar airspeed from acceleration and the drag model, and the way through the air.

Integrated acceleration alone drifts. If it is damped towards zero, the estimate decays in steady
flight and a speed loop closed on it runs away. The filter therefore damps towards the speed that
the drag model predicts for the commanded thrust. In wind this is the speed through the air:
ground speed is not observable with these sensors.

The navigator steers by the way that follows: the strategies estimate the wind themselves, from the
difference between the way through the air and what they see of the lamp.
"""

from collections import deque
from collections.abc import Iterable
import math
from typing import final, NamedTuple

from lta_control.sighting import DeadReckonedMotion


class HullDragModel(NamedTuple):
    """Drag and inertia of the vehicle along body x and y, about the hull centre."""

    mass: tuple[float, float]  # mass including the added mass [kg]
    # Drag coefficients [N s/m], [N s2/m2]
    linear: tuple[float, float]
    quadratic: tuple[float, float]


class AirspeedEstimate(NamedTuple):
    """Estimated and modelled velocity along body x and y. [m/s]."""

    surge: float = 0.0
    sway: float = 0.0
    model_surge: float = 0.0
    model_sway: float = 0.0


def _axis_drag(hull: HullDragModel, axis: int, speed: float) -> float:
    return (hull.linear[axis] + hull.quadratic[axis] * abs(speed)) * speed


def airspeed_step(
    hull: HullDragModel,
    state: AirspeedEstimate,
    force: tuple[float, float],
    acceleration: tuple[float, float],
    yaw_rate: float,
    trust: float,
    dt: float,
) -> AirspeedEstimate:
    """
    Return the airspeed one step later.

    `force` is the rotor force from the commanded duties [N] and `acceleration` the measured
    acceleration without gravity [m/s2], both along body x and y. `trust` is the time constant
    with which the estimate returns to the model [s].
    """
    surge, sway, model_surge, model_sway = state
    mx, my = hull.mass
    # Coriolis terms: the body frame turns under the velocity.
    model_x = (force[0] - _axis_drag(hull, 0, model_surge) + my * yaw_rate * model_sway) / mx
    model_y = (force[1] - _axis_drag(hull, 1, model_sway) - mx * yaw_rate * model_surge) / my
    # Measured acceleration plus a pull towards the model
    rate_x = acceleration[0] + yaw_rate * sway + (model_surge - surge) / trust
    rate_y = acceleration[1] - yaw_rate * surge + (model_sway - sway) / trust
    return AirspeedEstimate(
        surge + dt * rate_x,
        sway + dt * rate_y,
        model_surge + dt * model_x,
        model_sway + dt * model_y,
    )


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
