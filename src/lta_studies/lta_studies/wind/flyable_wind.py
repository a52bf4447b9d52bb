# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find the largest wind in which a drone makes headway to the lamp, by simulated flights.

The wind blows from the lamp to the start. A wind is flyable if the drone makes headway with every
seed: it reaches its goal, or ends nearer to the lamp than 20 s before, and never tilts beyond the
limit at which its motors stop. Several airspeed commands are tried and the best one counts. The
limit is found by bisection, which assumes that a drone that flies in a wind also flies in less.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
import math
from typing import Any, final

from lta_flight.flight_spec import build_loop, build_vehicle_scenario_stack, FlightSpec
from lta_sim.readings import FlightOutcome

APPROACH_TIME = 20.0  # s at the end of a flight in which the distance must shrink
DEFAULT = 'mission.speed'  # path of the commanded airspeed
SHARES = (0.4, 0.55, 0.65, 0.8)  # airspeeds to try, as shares of the top speed


@final
@dataclass(frozen=True, slots=True)
class GroundWind:
    """The wind profile: uniform, or logarithmic over rough ground."""

    roughness: float | None  # m; None is uniform
    height: float = 10.0  # of the reference wind [m]


@final
@dataclass(frozen=True, slots=True)
class FlyableWind:
    """The largest wind that was flown."""

    # Uniform, or at the reference height; 0 if the drone fails even in still air [m/s]
    wind: float
    airspeed: float  # commanded airspeed [m/s]
    fine: float  # width of the final bracket: `wind + fine` was too much [m/s]


def set_wind(spec: FlightSpec, wind: float, ground: GroundWind) -> FlightSpec:
    """Return the flight with wind from the lamp to the start; keep gusts and other air."""
    scene: dict[str, Any] = spec.contents['scenario']
    _, scenario, _ = build_vehicle_scenario_stack(spec)
    x, y = scenario.goal_places[0]
    u, v = scenario.start.position.vector
    # Direction from the lamp (x, y) to the start (u, v), into which the wind blows.
    towards = math.atan2(v - y, u - x)
    # The scene gets either the uniform wind or the profile, never both.
    even = wind if ground.roughness is None else 0.0
    air = {
        **scene['air'],
        'wind': _quantity_to_dict(
            [even * math.cos(towards), even * math.sin(towards), 0.0], 'm/s'
        ),
        'profile': None
        if ground.roughness is None
        else {
            'wind': _quantity_to_dict(wind, 'm/s'),
            'towards': _quantity_to_dict(towards, 'rad'),
            'height': _quantity_to_dict(ground.height, 'm'),
            'roughness': _quantity_to_dict(ground.roughness, 'm'),
        },
    }
    return replace(spec, contents={**spec.contents, 'scenario': {**scene, 'air': air}})


def _quantity_to_dict(value: float | list[float], unit: str) -> dict[str, Any]:
    return {'value': value, 'unit': unit}


def makes_headway(spec: FlightSpec, seed: int) -> bool:
    """Fly once and return whether the drone makes headway to the lamp."""
    loop = build_loop(spec, seed)
    world = loop.world
    upright = math.cos(loop.policy.tilt_limit)
    distances = []
    for _ in loop.iterate_steps():
        # z of the body's up axis in the world, from the quaternion's x and y.
        x, y = world.state[3], world.state[4]
        # Beyond this tilt the drone stops its motors.
        if 1.0 - 2.0 * (x * x + y * y) < upright:
            return False
        distances.append((world.elapsed, world.goal_distance))
    if world.outcome is not FlightOutcome.TIMEOUT:
        return world.outcome is FlightOutcome.REACHED
    # After a timeout, compare the last distance with that of LATE seconds before.
    end, last = distances[-1]
    return last < next(at for time, at in distances if time >= end - APPROACH_TIME)


def find_flyable_wind(
    spec: FlightSpec,
    ground: GroundWind,
    most: float,
    airspeeds: Sequence[float],
    seeds: Sequence[int],
    steps: int,
    report: Callable[[float], object] = lambda share: None,
) -> FlyableWind:
    """
    Find the largest flyable wind.

    Parameters
    ----------
    spec : FlightSpec
        The flight, with its altitude.
    most : float
        Upper end of the bisection, above the static limit. [m/s]
    airspeeds : sequence of float
        Airspeed commands to try. [m/s]
    seeds : sequence of int
        Random seeds; the drone must make headway with all of them.
    steps : int
        Steps of each bisection.
    report : callable
        Called with the finished share, before each airspeed.

    """
    best = FlyableWind(0.0, airspeeds[0], most)
    fine = most * 0.5**steps

    def is_flyable(wind: float, airspeed: float) -> bool:
        commanded = spec.with_values({DEFAULT: airspeed})
        flight = set_wind(commanded, wind, ground)
        return all(makes_headway(flight, seed) for seed in seeds)

    for place, airspeed in enumerate(airspeeds):
        report(place / len(airspeeds))
        # Only winds above the best so far can improve the result.
        low, high = best.wind, most
        # Skip the bisection if this airspeed cannot beat the best one by one step.
        worth = is_flyable(low + fine if low else 0.0, airspeed)
        for _ in range(steps):
            # A bracket with a raised lower end is narrow earlier
            if worth and high - low > fine:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if is_flyable(middle, airspeed) else (low, middle)
        # `best.fine == most` marks that no airspeed has flown yet, so 0 m/s counts as well.
        if worth and (low > best.wind or best.fine == most):
            best = FlyableWind(low, airspeed, high - low)
    return best
