"""A flight along a course, step by step: where it was, how it leaned, and what it took."""

from collections.abc import Callable
from dataclasses import dataclass, replace
import math
from typing import final

from lta_config.topics import topic_table
from lta_control.attitude import up_in_body
from lta_control.cascade import Setpoint
from lta_control.laws.frames import to_world
from lta_flight.ingredients import Ingredients, parts_of
from lta_flight.loop import Loop
from lta_model.electrical.loads import rotor_power
from lta_sim.world import World
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Course = Callable[[float], Setpoint]


@final
@dataclass(frozen=True, slots=True)
class Flown:
    """
    A flight by control steps; every array has one number a step.

    Attributes
    ----------
    time : ndarray
        Since the start. [s]
    height : ndarray
        Of the hull centre. [m]
    speed : ndarray
        Over ground, level. [m/s]
    pitch : ndarray
        Nose up is positive. [rad]
    rotors : ndarray
        Electrical power of all rotors. [W]
    voltage, charge : ndarray
        At the terminals of the cell [V], and its state of charge [1].

    """

    time: Array
    height: Array
    speed: Array
    pitch: Array
    rotors: Array
    voltage: Array
    charge: Array

    def between(self, begin: float, end: float) -> 'Flown':
        """Return a stretch of the flight. [s]"""
        keep = (self.time >= begin - 1e-9) & (self.time < end - 1e-9)
        return Flown(*(getattr(self, name)[keep] for name in self.__slots__))


def loop_on(made_of: Ingredients, course: Course | None, seed: int) -> Loop:
    """Return a flight along a course, or by its own strategy, that is about to begin."""
    vehicle, scenario, policy = parts_of(made_of)
    table = topic_table()
    looking = made_of.strategy if course is None else ''
    world = World(vehicle, scenario, table, seed, looking)
    return Loop(world, table, replace(policy, course=course))


def fly(loop: Loop, until: Callable[[Loop], bool]) -> Flown:
    """Fly until something is so, and return what was flown."""
    world, rows = loop.world, []
    loads = world.vehicle.loads
    while not until(loop):
        loop.decide()
        state = world.state.tolist()
        quaternion = (state[3], state[4], state[5], state[6])
        u, v, _ = to_world(quaternion, (state[7], state[8], state[9]))
        power = sum(
            rotor_power(thrust, loads.rotor_offset, loads.rotor_slope) for thrust in world.thrusts
        )
        rows.append(
            (world.elapsed, state[2], math.hypot(u, v), pitch(quaternion), power,
             world.supply.electrics[0], world.charge)
        )  # fmt: skip
        loop.act()
    return Flown(*np.array(rows).T.copy())


def pitch(quaternion: tuple[float, float, float, float]) -> float:
    """Return how far the nose is above the horizon. [rad]"""
    return math.asin(max(-1.0, min(1.0, up_in_body(quaternion)[0])))


def for_seconds(seconds: float) -> Callable[[Loop], bool]:
    """Return when a flight of a length is over. [s]"""
    return lambda loop: loop.world.elapsed >= seconds - 1e-9
