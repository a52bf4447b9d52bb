"""
Fly a reference pilot, who knows the positions of lamp and drone and the wind at the hull.

The pilot uses the same mission, controller and rotors as every strategy. With the wind w, the unit
vector t to the lamp and n to the left of it, the air velocity is

    a = sqrt(V^2 - (w.n)^2) t - (w.n) n

so that the ground track is straight wherever the airspeed V exceeds the crosswind. V is the cruise
speed, or the controller's limit if the cruise speed leaves less than half of itself over ground.
The wind is low-pass filtered, because following every gust would only cost time.
"""

from dataclasses import replace
import math

from lta_control.attitude import yaw_from_quaternion
from lta_control.cascade import CascadeGains
from lta_control.strategies.protocol import (
    CruiseSettings,
    LightMeasurement,
    Memory,
    NavigationStrategy,
    SteeringCommand,
)
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_loop
from lta_flight.sweep.plan import SweepJob, SweepPlan
from lta_model.state import QUATERNION
from lta_sim.world import World
from lta_studies.reproduce.strategy_flights import STRATEGY_PATH

PILOT = 'pilot'
WIND_FILTER_TIME = 5.0  # s, time constant of the low-pass filter of the wind
LEAST_GROUND_SHARE = (
    0.5  # share of the cruise speed over ground below which the pilot flies faster
)


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
            share = min(sight.interval / WIND_FILTER_TIME, 1.0)
            x, y = memory[1] + share * (x - memory[1]), memory[2] + share * (y - memory[2])
        # Wind along the track and to the left of it
        along, left = solve_wind_triangle(x * c + y * s, y * c - x * s, settings.speed, top)
        qx, qy, qz, qw = world.state[QUATERNION].tolist()
        # The drone's heading is relative to its start; correct it by the true heading.
        turn = towards + math.atan2(left, along) - yaw_from_quaternion((qx, qy, qz, qw))
        heading = sight.heading + math.remainder(turn, math.tau)
        return SteeringCommand(heading, math.hypot(along, left)), (heading, x, y)

    return NavigationStrategy(PILOT, start, steer)


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
        if along + with_it >= LEAST_GROUND_SHARE * cruise and left == -across:
            break
    return along, left


def prepare_flight(plan: SweepPlan, job: SweepJob) -> ClosedLoop:
    """Return the closed loop of a job before its first step; the strategy may be `PILOT`."""
    changes = dict(job.changes)
    piloted = changes[STRATEGY_PATH] == PILOT
    if piloted:
        # The spec needs a real strategy; the pilot replaces it below.
        del changes[STRATEGY_PATH]
    loop = build_loop(plan.base.with_values(changes), job.seed)
    if piloted:
        pilot = build_pilot_strategy(loop.world, top_airspeed(loop))
        loop.policy = replace(loop.policy, strategy=pilot)
    return loop


def top_airspeed(loop: ClosedLoop) -> float:
    """Return the airspeed limit of the controller. [m/s]"""
    gains = loop.policy.gains
    # Only the cascade has an airspeed limit.
    return gains.speed_limit if isinstance(gains, CascadeGains) else math.inf
