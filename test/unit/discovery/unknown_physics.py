"""
Physics that no effect of the library has, as wrenches on a flying GT-MAB.

Each kind is made anew for a flight, may remember, and is asked once a control period. Written
without anything of what is to find it.
"""

from collections.abc import Callable
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Seen(NamedTuple):
    """
    What a kind is asked with.

    Time [s], place [m], rotation body to map, body velocity [m/s], body rates [rad/s], their
    accelerations of the period before [m/s2, rad/s2], duties [1] and the control period [s].
    """

    time: float
    place: Array
    rotation: Array
    velocity: Array
    rates: Array
    acceleration: Array
    duties: Array
    period: float


Kind = Callable[[Seen], Array]  # force and moment about the hull centre, body frame


def _at_hull(seen: Seen, force: Array, moment: Array | None = None) -> Array:
    """Return a wrench from a force in the map and a moment in the body."""
    turn = np.zeros(3) if moment is None else moment
    return np.concatenate([seen.rotation.T @ force, turn])


def tether(size: float, rng: np.random.Generator) -> Kind:
    """An elastic line to a point of the floor, hung below the hull, taut beyond 1.5 m."""
    anchor = np.array([*rng.uniform(-0.5, 0.5, 2), 0.0])

    def wrench(seen: Seen) -> Array:
        hook = seen.rotation @ np.array([0.0, 0.0, -0.15])
        line = anchor - seen.place - hook
        length = float(np.linalg.norm(line))
        force = size * max(0.0, length - 1.5) * line / length
        arm = np.array([0.0, 0.0, -0.15])
        return _at_hull(seen, force, np.cross(arm, seen.rotation.T @ force))

    return wrench


def rope(size: float, rng: np.random.Generator) -> Kind:
    """A rope that lies on the floor: its hanging part is weight, its lying part rubs."""
    del rng

    def wrench(seen: Seen) -> Array:
        over = seen.rotation @ seen.velocity
        speed = math.hypot(over[0], over[1]) + 0.02
        lying = max(0.0, 2.5 - seen.place[2])
        rub = -0.4 * size * lying * over[:2] / speed
        return _at_hull(seen, np.array([*rub, -size * (seen.place[2] - 1.5)]))

    return wrench


def slosh(size: float, rng: np.random.Generator) -> Kind:
    """Ballast that swings fore and aft and sideways, lightly damped, at 0.35 Hz."""
    pull, damping = (2.0 * math.pi * 0.35) ** 2, 2.0 * 0.05 * 2.0 * math.pi * 0.35
    place, speed = np.zeros(2), np.zeros(2)
    del rng

    def wrench(seen: Seen) -> Array:
        nonlocal place, speed
        push = seen.acceleration[:2] + 9.81 * seen.rotation[2, :2]
        speed = speed + seen.period * (-pull * place - damping * speed - push)
        place = place + seen.period * speed
        force = size * (pull * place + damping * speed)
        # It swings 12 cm below the hull centre.
        return np.array([*force, 0.0, 0.12 * force[1], -0.12 * force[0], 0.0])

    return wrench


def flapping(size: float, rng: np.random.Generator) -> Kind:
    """A loose panel on one side: above 0.25 m/s it flaps, irregularly, and drags and yaws."""
    state = 0.0

    def wrench(seen: Seen) -> Array:
        nonlocal state
        over = max(0.0, float(np.linalg.norm(seen.velocity)) - 0.25)
        state += seen.period / 0.4 * -state + math.sqrt(2 * seen.period / 0.4) * rng.normal()
        push = size * over * (1.0 + 2.0 * state)
        return np.array([-push, 0.5 * push, 0.0, 0.0, 0.0, 0.1 * push])

    return wrench


def wobble(size: float, rng: np.random.Generator) -> Kind:
    """A bent shaft: a force across and a moment that go round at 2.4 Hz while the rotors turn."""
    phase = rng.uniform(0.0, 6.0)

    def wrench(seen: Seen) -> Array:
        turn = 2.0 * math.pi * 2.4 * seen.time + phase
        push = size * min(1.0, float(seen.duties.sum()))
        return push * np.array([0.0, math.sin(turn), math.cos(turn), 0.0, 0.1 * math.sin(turn), 0])

    return wrench


def draught(size: float, rng: np.random.Generator) -> Kind:
    """A jet of air from a vent: a push in a part of the hall."""
    centre, way = rng.uniform(-0.5, 0.5, 2), rng.uniform(0.0, 6.28)

    def wrench(seen: Seen) -> Array:
        away = float(np.sum((seen.place[:2] - centre) ** 2))
        push = size * math.exp(-0.5 * away / 0.8**2)
        return _at_hull(seen, push * np.array([math.cos(way), math.sin(way), 0.0]))

    return wrench


def one_sided(size: float, rng: np.random.Generator) -> Kind:
    """A flap that opens only in one direction: drag on the way down, and to the left."""
    del rng

    def wrench(seen: Seen) -> Array:
        _, v, w = seen.velocity
        left, down = max(0.0, v), max(0.0, -w)
        return np.array([0.0, -size * left, 2.0 * size * down, 0.0, 0.0, 0.0])

    return wrench


def layers(size: float, rng: np.random.Generator) -> Kind:
    """Air in layers: lift that has a hump at a height."""
    middle = rng.uniform(1.4, 1.6)

    def wrench(seen: Seen) -> Array:
        hump = math.exp(-0.5 * ((seen.place[2] - middle) / 0.15) ** 2)
        return _at_hull(seen, np.array([0.0, 0.0, size * hump]))

    return wrench


def swirl(size: float, rng: np.random.Generator) -> Kind:
    """Rotor wash on a fin: a yaw moment that follows duty x speed."""
    del rng

    def wrench(seen: Seen) -> Array:
        return np.array([0, 0, 0, 0, 0, size * float(seen.duties.sum()) * seen.velocity[0]])

    return wrench


def compass(size: float, rng: np.random.Generator) -> Kind:
    """A magnet on board: a yaw moment towards two headings."""
    north = rng.uniform(0.0, 3.0)

    def wrench(seen: Seen) -> Array:
        heading = math.atan2(seen.rotation[1, 0], seen.rotation[0, 0])
        return np.array([0, 0, 0, 0, 0, -size * math.sin(2.0 * (heading - north))])

    return wrench


# Weak and strong, in the unit of each: N/m, N/m, kg, N s/m, N, N, N s/m, N, N m s/m, N m.
KINDS: dict[str, tuple[Callable[[float, np.random.Generator], Kind], float, float]] = {
    'tether': (tether, 0.01, 0.03),
    'rope': (rope, 0.01, 0.03),
    'slosh': (slosh, 0.0007, 0.002),
    'flapping': (flapping, 0.02, 0.06),
    'wobble': (wobble, 0.004, 0.012),
    'draught': (draught, 0.006, 0.02),
    'one_sided': (one_sided, 0.03, 0.09),
    'layers': (layers, 0.006, 0.02),
    'swirl': (swirl, 0.0015, 0.005),
    'compass': (compass, 3e-4, 1e-3),
}
