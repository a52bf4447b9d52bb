"""
Reckon the way through the air from attitude and airspeed.

The navigator steers by it: the strategies estimate the wind themselves, from the difference
between the way through the air and what they see of the lamp.
"""

from collections import deque
import math
from typing import final

from lta_control.attitude import Quaternion, Vector, yaw_from_quaternion
from lta_control.control import step_duration
from lta_control.sighting import DeadReckonedMotion

NOWHERE = DeadReckonedMotion(0.0, 0.0, 0.0, 0.0, 0.0)


def advance_position(
    position: tuple[float, float], forward: float, left: float, yaw: float, dt: float
) -> tuple[float, float]:
    """Return the position after a time [s] at a speed along the body's axes. [m/s]"""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return (
        position[0] + dt * (cos * forward - sin * left),
        position[1] + dt * (sin * forward + cos * left),
    )


@final
class AirReckoning:
    """
    The latest motions, each with the way through the air since the first one.

    Parameters
    ----------
    period_ns : int
        Nominal time between two motions. [ns]
    count : int
        Number of motions kept.

    """

    def __init__(self, period_ns: int, count: int) -> None:
        self.history: deque[tuple[int, DeadReckonedMotion]] = deque(maxlen=count)
        self._period_ns = period_ns

    def add_motion(self, stamp_ns: int, attitude: Quaternion, velocity: Vector) -> None:
        """Add attitude and velocity through the air [m/s, body] at a time."""
        last_ns, last = self.history[-1] if self.history else (None, NOWHERE)
        dt = step_duration(last_ns, stamp_ns, self._period_ns)
        yaw = yaw_from_quaternion(attitude)
        x, y = advance_position((last.x, last.y), velocity[0], velocity[1], yaw, dt)
        self.history.append((stamp_ns, DeadReckonedMotion(yaw, x, y, velocity[0], velocity[1])))

    def find_nearest(self, stamp_ns: int) -> DeadReckonedMotion:
        """Return the motion nearest to a time; at rest in the origin if there is none."""
        if not self.history:
            return NOWHERE
        return min(self.history, key=lambda item: abs(item[0] - stamp_ns))[1]
