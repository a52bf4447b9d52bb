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

from lta_flight.ingredients import Ingredients, loop_of, parts_of
from lta_sim.readings import Outcome

LATE = 20.0  # s, the last of a flight, in which it must come nearer
DEFAULT = 'mission.speed'
SHARES = (0.4, 0.55, 0.65, 0.8)  # of the fastest that thrust allows


@final
@dataclass(frozen=True, slots=True)
class Ground:
    """How the wind comes: uniform, or as a reference wind over rough ground."""

    roughness: float | None  # m; None is uniform
    height: float = 10.0  # of the reference wind [m]


@final
@dataclass(frozen=True, slots=True)
class Flyable:
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


def blowing(made_of: Ingredients, wind: float, ground: Ground) -> Ingredients:
    """Return a flight in so much wind, from the lamp to the start; other air stays as it is."""
    scene: dict[str, Any] = made_of.contents['scenario']
    _, scenario, _ = parts_of(made_of)
    x, y = scenario.goal_places[0]
    u, v = scenario.start.position.vector
    towards = math.atan2(v - y, u - x)
    even = wind if ground.roughness is None else 0.0
    air = {
        **scene['air'],
        'wind': _quantity([even * math.cos(towards), even * math.sin(towards), 0.0], 'm/s'),
        'profile': None
        if ground.roughness is None
        else {
            'wind': _quantity(wind, 'm/s'),
            'towards': _quantity(towards, 'rad'),
            'height': _quantity(ground.height, 'm'),
            'roughness': _quantity(ground.roughness, 'm'),
        },
    }
    return replace(made_of, contents={**made_of.contents, 'scenario': {**scene, 'air': air}})


def _quantity(value: float | list[float], unit: str) -> dict[str, Any]:
    return {'value': value, 'unit': unit}


def makes_way(made_of: Ingredients, seed: int) -> bool:
    """Fly, and tell whether the drone makes way to the lamp."""
    loop = loop_of(made_of, seed)
    world = loop.world
    upright = math.cos(loop.policy.tilt_limit)
    distances = []
    for _ in loop.flight():
        x, y = world.state[3], world.state[4]
        if 1.0 - 2.0 * (x * x + y * y) < upright:
            return False
        distances.append((world.elapsed, world.distance))
    if world.outcome is not Outcome.TIMEOUT:
        return world.outcome is Outcome.REACHED
    end, last = distances[-1]
    return last < next(at for time, at in distances if time >= end - LATE)


def flyable(
    made_of: Ingredients,
    ground: Ground,
    most: float,
    airspeeds: Sequence[float],
    seeds: Sequence[int],
    steps: int,
    tick: Callable[[], None],
) -> Flyable:
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
    best = Flyable(0.0, airspeeds[0], most)
    fine = most * 0.5**steps

    def flies(wind: float, airspeed: float) -> bool:
        told = made_of.with_values({DEFAULT: airspeed})
        flight = blowing(told, wind, ground)
        return all(makes_way(flight, seed) for seed in seeds)

    for airspeed in airspeeds:
        low, high = best.wind, most
        worth = flies(low + fine if low else 0.0, airspeed)
        tick()
        for _ in range(steps):
            if worth and high - low > fine:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if flies(middle, airspeed) else (low, middle)
            tick()
        if worth and (low > best.wind or best.fine == most):
            best = Flyable(low, airspeed, high - low)
    return best
