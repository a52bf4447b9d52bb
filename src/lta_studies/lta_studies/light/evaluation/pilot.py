"""
The reference pilot: flies as straight to the lamp as the vehicle lets anybody who knows the wind.

It knows the lamp, where the drone is, and the wind at the hull, and flies through the same
mission, controller and rotors as every strategy. With the wind w, the unit vector t to the lamp
and n to the left of it, it flies through the air at

    a = sqrt(V^2 - (w.n)^2) t - (w.n) n

so that the track over ground is straight wherever the airspeed V holds against the wind across.
V is the cruise speed, and all that the controller allows where that leaves less than half of it
over ground. It knows the wind without its eddies: who turns after each of them turns instead of
flying. Its path is what others are measured by.
"""

import math

from lta_control.attitude import yaw_from_quaternion
from lta_control.strategies.protocol import (
    CruiseSettings,
    LightSight,
    Memory,
    NavigationStrategy,
    SteeringCommand,
)
from lta_model.state import QUATERNION
from lta_sim.world import World

NAME = 'pilot'
EDDIES = 5.0  # s; over so much, the wind at the hull is averaged
LEAST = 0.5  # of the cruise speed, over ground, before the pilot flies faster


def build_pilot_strategy(world: World, top: float) -> NavigationStrategy:
    """
    Return a strategy that looks at the world instead of the light.

    Parameters
    ----------
    world : World
        In which it flies.
    top : float
        Most airspeed that the controller allows. [m/s]

    """
    lamp_x, lamp_y, _ = world.scenario.goal_lamp.position.vector

    def start(heading: float) -> Memory:
        return (heading,)

    def steer(
        settings: CruiseSettings, memory: Memory, sight: LightSight
    ) -> tuple[SteeringCommand, Memory]:
        towards = math.atan2(lamp_y - float(world.state[1]), lamp_x - float(world.state[0]))
        c, s = math.cos(towards), math.sin(towards)
        x, y, _ = world.wind
        if len(memory) > 1:
            share = min(sight.interval / EDDIES, 1.0)
            x, y = memory[1] + share * (x - memory[1]), memory[2] + share * (y - memory[2])
        along, left = solve_wind_triangle(x * c + y * s, y * c - x * s, settings.speed, top)
        qx, qy, qz, qw = world.state[QUATERNION].tolist()
        # The drone counts its heading from where it began; the pilot sees both.
        turn = towards + math.atan2(left, along) - yaw_from_quaternion((qx, qy, qz, qw))
        heading = sight.heading + math.remainder(turn, math.tau)
        return SteeringCommand(heading, math.hypot(along, left)), (heading, x, y)

    return NavigationStrategy(NAME, start, steer)


def solve_wind_triangle(
    with_it: float, across: float, cruise: float, top: float
) -> tuple[float, float]:
    """
    Return the air velocity that keeps a straight track: along the way, and left of it. [m/s]

    Parameters
    ----------
    with_it, across : float
        Wind along the way to the lamp, and to the left of it. [m/s]
    cruise, top : float
        Usual and most airspeed. [m/s]

    """
    for speed in (cruise, max(cruise, top)):
        left = min(max(-across, -speed), speed)
        along = math.sqrt(speed * speed - left * left)
        if along + with_it >= LEAST * cruise and left == -across:
            break
    return along, left
