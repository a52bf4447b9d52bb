"""
Define the reference pilot, which flies as straight to the lamp as a known wind allows.

It knows the positions of lamp and drone and the wind at the hull, and uses the same mission,
controller and rotors as every strategy. With the wind w, the unit vector t to the lamp and n to
the left of it, its air velocity is

    a = sqrt(V^2 - (w.n)^2) t - (w.n) n

so that the ground track is straight wherever the airspeed V exceeds the crosswind. V is the cruise
speed, or the controller's limit if the cruise speed leaves less than half of itself over ground.
The wind is low-pass filtered, because following every gust would only cost time. The path of the
pilot is the reference for the strategies.
"""

import math

from lta_control.attitude import yaw_from_quaternion
from lta_control.strategies.protocol import (
    CruiseSettings,
    LightMeasurement,
    Memory,
    NavigationStrategy,
    SteeringCommand,
)
from lta_model.state import QUATERNION
from lta_sim.world import World

NAME = 'pilot'
EDDIES = 5.0  # s, time constant of the low-pass filter of the wind
LEAST = 0.5  # share of the cruise speed over ground below which the pilot flies faster


def build_pilot_strategy(world: World, top: float) -> NavigationStrategy:
    """
    Return a strategy that uses the true state of the world instead of the light.

    `world`: simulated world. `top`: airspeed limit of the controller [m/s].
    """
    lamp_x, lamp_y, _ = world.scenario.goal_lamp.position.vector

    def start(heading: float) -> Memory:
        return (heading,)

    def steer(
        settings: CruiseSettings, memory: Memory, sight: LightMeasurement
    ) -> tuple[SteeringCommand, Memory]:
        towards = math.atan2(lamp_y - float(world.state[1]), lamp_x - float(world.state[0]))
        c, s = math.cos(towards), math.sin(towards)
        x, y, _ = world.wind
        # The first call has no filtered wind yet and takes the current one.
        if len(memory) > 1:
            # First-order low-pass filter, discretised; at most 1 for long intervals
            share = min(sight.interval / EDDIES, 1.0)
            x, y = memory[1] + share * (x - memory[1]), memory[2] + share * (y - memory[2])
        # Wind along the track and to the left of it
        along, left = solve_wind_triangle(x * c + y * s, y * c - x * s, settings.speed, top)
        qx, qy, qz, qw = world.state[QUATERNION].tolist()
        # The drone's heading is relative to its start; correct it by the true heading.
        turn = towards + math.atan2(left, along) - yaw_from_quaternion((qx, qy, qz, qw))
        heading = sight.heading + math.remainder(turn, math.tau)
        return SteeringCommand(heading, math.hypot(along, left)), (heading, x, y)

    return NavigationStrategy(NAME, start, steer)


def solve_wind_triangle(
    with_it: float, across: float, cruise: float, top: float
) -> tuple[float, float]:
    """
    Return the air velocity for a straight track: along the track, and left of it. [m/s]

    `with_it`, `across`: wind along the track to the lamp, and to the left of it [m/s]. `cruise`,
    `top`: cruise and maximum airspeed [m/s].
    """
    # Cruise if that makes enough way, else as fast as the controller allows
    for speed in (cruise, max(cruise, top)):
        # Cancel the crosswind as far as the airspeed allows.
        left = min(max(-across, -speed), speed)
        along = math.sqrt(speed * speed - left * left)
        if along + with_it >= LEAST * cruise and left == -across:
            break
    return along, left
