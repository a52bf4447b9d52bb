"""Draw random poses of a drone in front of a lamp."""

import math
from typing import Final

from lta_config.errors import BadInput
from lta_model.scenario import Scenario
import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation

HEIGHTS: Final = 0.5, 1.5  # range of the hull centre's height, uniform [m]
TILT: Final = math.radians(2.0)  # standard deviation of pitch and roll [rad]
BESIDE: Final = math.radians(60.0)  # largest angle to the lamp's axis, seen from above [rad]
CLEAR: Final = 0.6  # minimum distance of the hull centre to a wall [m]
NEAREST: Final = 1.5  # minimum distance to the lamp; nearer, the diodes saturate [m]
FARTHEST: Final = 12.0  # maximum |x| and |y| of places in an open field [m]
TRIES: Final = 10_000

Pose = tuple[float, ...]  # position and quaternion x y z w


def draw_pose(
    scenario: Scenario, distance: float | None, chance: Generator, off_axis: float = BESIDE
) -> Pose:
    """
    Draw a random pose within the lamp's beam.

    `scenario`: the scene. `distance`: horizontal distance to the lamp; None for any place in the
    room [m]. `off_axis`: largest angle to the lamp's axis, seen from above [rad]. Raise `BadInput`
    if no place at that distance is in the room.
    """
    height = chance.uniform(*HEIGHTS)
    # Rejection sampling: draw places until one is usable.
    for _ in range(TRIES):
        x, y = draw_place(scenario, distance, chance, off_axis)
        if is_within_lamp_beam(scenario, x, y, off_axis):
            pitch, roll = TILT * chance.standard_normal(2)
            # Upper-case axes are intrinsic: yaw, then pitch, then roll.
            turn = Rotation.from_euler('ZYX', [chance.uniform(-math.pi, math.pi), pitch, roll])
            return (x, y, height, *turn.as_quat().tolist())
    raise BadInput(
        f'The scenario {scenario.name} has no usable place at {distance:g} m from its lamp, '
        "inside the room and within the lamp's beam; choose a shorter --range."
    )


def draw_place(
    scenario: Scenario, distance: float | None, chance: Generator, off_axis: float = BESIDE
) -> tuple[float, float]:
    """Draw a horizontal position at a distance from the lamp, or anywhere. [m]"""
    lamp_x, lamp_y, _ = scenario.goal_lamp.position.vector
    length, width, _ = scenario.room.size.vector
    if distance is None:
        # A field is far larger than the range of the lamp, so places are limited to its middle.
        reach = [min(0.5 * side - CLEAR, FARTHEST) for side in (length, width)]
        x, y = (chance.uniform(-each, each) for each in reach)
        return x, y
    ahead_x, ahead_y, _ = scenario.goal_lamp.facing.vector
    angle = math.atan2(ahead_y, ahead_x) + chance.uniform(-off_axis, off_axis)
    return lamp_x + distance * math.cos(angle), lamp_y + distance * math.sin(angle)


def is_within_lamp_beam(scenario: Scenario, x: float, y: float, off_axis: float = BESIDE) -> bool:
    """Return whether a place [m] is in the room, within the beam and far enough away."""
    lamp_x, lamp_y, _ = scenario.goal_lamp.position.vector
    ahead = np.array(scenario.goal_lamp.facing.vector[:2])
    length, width, _ = scenario.room.size.vector
    way = np.array([x - lamp_x, y - lamp_y])
    away = math.hypot(*way)
    inside = abs(x) <= 0.5 * length - CLEAR and abs(y) <= 0.5 * width - CLEAR
    # Angle by dot product; 1e-9 admits places exactly on the edge of the beam.
    within = way @ ahead >= (math.cos(off_axis) - 1e-9) * away * math.hypot(*ahead)
    return inside and bool(within) and away >= NEAREST
