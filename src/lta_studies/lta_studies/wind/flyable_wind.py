"""
The largest wind in which a drone makes way to the lamp, found by flying.

The wind blows from the lamp to the start. A wind is flyable if the drone makes way in it with
every seed: it reaches its goal, or it is nearer to the lamp at the end than 20 s before, and never
tilts so far that its motors stop. The drone is also told to fly faster than its mission does by
default, as its pilot would; the best of these airspeeds counts. Bisection, taking for granted that
what flies in a wind flies in less.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
import math
from typing import Any, final

from lta_flight.flight_spec import build_loop, build_parts, FlightSpec
from lta_sim.readings import FlightOutcome

LATE = 20.0  # s, the last of a flight, in which it must come nearer
DEFAULT = 'mission.speed'
SHARES = (0.4, 0.55, 0.65, 0.8)  # of the fastest that thrust allows


@final
@dataclass(frozen=True, slots=True)
class GroundWind:
    """How the wind comes: uniform, or as a reference wind over rough ground."""

    roughness: float | None  # m; None is uniform
    height: float = 10.0  # of the reference wind [m]


@final
@dataclass(frozen=True, slots=True)
class FlyableWind:
    """
    The largest wind that was flown.

    Attributes
    ----------
    wind : float
        Uniform, or at the reference height; 0 if the drone makes no way even in still air. [m/s]
    airspeed : float
        That it was told to fly. [m/s]
    fine : float
        How much more wind was too much. [m/s]

    """

    wind: float
    airspeed: float
    fine: float


def set_wind(spec: FlightSpec, wind: float, ground: GroundWind) -> FlightSpec:
    """Return a flight in so much wind, from the lamp to the start; other air stays as it is."""
    scene: dict[str, Any] = spec.contents['scenario']
    _, scenario, _ = build_parts(spec)
    x, y = scenario.goal_places[0]
    u, v = scenario.start.position.vector
    towards = math.atan2(v - y, u - x)
    even = wind if ground.roughness is None else 0.0
    air = {
        **scene['air'],
        'wind': _build_quantity([even * math.cos(towards), even * math.sin(towards), 0.0], 'm/s'),
        'profile': None
        if ground.roughness is None
        else {
            'wind': _build_quantity(wind, 'm/s'),
            'towards': _build_quantity(towards, 'rad'),
            'height': _build_quantity(ground.height, 'm'),
            'roughness': _build_quantity(ground.roughness, 'm'),
        },
    }
    return replace(spec, contents={**spec.contents, 'scenario': {**scene, 'air': air}})


def _build_quantity(value: float | list[float], unit: str) -> dict[str, Any]:
    return {'value': value, 'unit': unit}


def makes_headway(spec: FlightSpec, seed: int) -> bool:
    """Fly, and tell whether the drone makes way to the lamp."""
    loop = build_loop(spec, seed)
    world = loop.world
    upright = math.cos(loop.policy.tilt_limit)
    distances = []
    for _ in loop.iterate_steps():
        x, y = world.state[3], world.state[4]
        if 1.0 - 2.0 * (x * x + y * y) < upright:
            return False
        distances.append((world.elapsed, world.goal_distance))
    if world.outcome is not FlightOutcome.TIMEOUT:
        return world.outcome is FlightOutcome.REACHED
    end, last = distances[-1]
    return last < next(at for time, at in distances if time >= end - LATE)


def find_flyable_wind(
    spec: FlightSpec,
    ground: GroundWind,
    most: float,
    airspeeds: Sequence[float],
    seeds: Sequence[int],
    steps: int,
    tick: Callable[[], None],
) -> FlyableWind:
    """
    Return the largest flyable wind.

    Parameters
    ----------
    made_of : Ingredients
        The flight, with its altitude.
    ground : Ground
        How the wind comes.
    most : float
        A wind that is too much by the vehicle's numbers. [m/s]
    airspeeds : sequence of float
        What the drone is told to fly, one after the other. [m/s]
    seeds : sequence of int
        All of them must make way.
    steps : int
        Of each bisection.
    tick : callable
        Called `steps + 1` times for each airspeed.

    """
    best = FlyableWind(0.0, airspeeds[0], most)
    fine = most * 0.5**steps

    def is_flyable(wind: float, airspeed: float) -> bool:
        told = spec.with_values({DEFAULT: airspeed})
        flight = set_wind(told, wind, ground)
        return all(makes_headway(flight, seed) for seed in seeds)

    for airspeed in airspeeds:
        low, high = best.wind, most
        worth = is_flyable(low + fine if low else 0.0, airspeed)
        tick()
        for _ in range(steps):
            if worth and high - low > fine:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if is_flyable(middle, airspeed) else (low, middle)
            tick()
        if worth and (low > best.wind or best.fine == most):
            best = FlyableWind(low, airspeed, high - low)
    return best
