"""
What each task takes, from flights in the closed loop.

One flight in still air stands, takes off, hovers and flies straight on, and its rotors' power is
told apart by what it was doing; others find a lamp by each strategy. Electronics come on top as
the vehicle's file has them: the radio always, the light board where light is looked at.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_config.topics import topic_table
from lta_control.cascade import Setpoint
from lta_flight.ingredients import gather, Ingredients, parts_of
from lta_flight.loop import Loop
from lta_model.electrical.loads import Loads
from lta_model.electrical.loads import navigating as looking
from lta_sim.readings import Outcome
from lta_studies.energy.flown import Course, Flown, fly, for_seconds, loop_on

SCENE, LAMP_SCENE = 'hall', 'lamp_room'
STRATEGIES = ('bag', 'des', 'dga')
RISE = 0.5  # m, seed paper
SPEED = 0.5  # m/s, seed paper
GO, SETTLED, AWAY, CRUISING, END = 5.0, 30.0, 60.0, 70.0, 100.0  # s
NEAR = 0.05  # m below the altitude asked for: there take-off is over
MOVED = 0.01  # m above where it stood: there it has taken off


@final
@dataclass(frozen=True, slots=True)
class Task:
    """
    What a task takes.

    Attributes
    ----------
    name : str
        Of the task.
    electronics : float
        Controller, radio, light board and computing, as far as they are on. [W]
    rotors : float
        Mean over the flights. [W]
    off : float
        Greatest deviation of one flight from that mean. [W]
    seconds : float
        How long the task took in a flight, mean. [s]

    """

    name: str
    electronics: float
    rotors: float
    off: float = 0.0
    seconds: float = math.nan

    @property
    def power(self) -> float:
        """All of it. [W]"""
        return self.electronics + self.rotors


def standing(loads: Loads) -> list[Task]:
    """Return what it takes to stand: motors off, without and with the radio."""
    return [
        Task('idle', loads.idle, 0.0),
        Task('transmitting', loads.idle + loads.transmitting, 0.0),
    ]


def course(base: float) -> Course:
    """Return take-off, hover and straight flight over a height where it stands. [m]"""

    def asked(time: float) -> Setpoint:
        rise = RISE if time >= GO else 0.0
        return Setpoint(base + rise, 0.0, SPEED if time >= AWAY else 0.0)

    return asked


def flights(vehicle: str, seeds: int, tick: Callable[[], None]) -> list[Flown]:
    """Return flights of a vehicle along the course, one a seed."""
    flown = []
    for seed in range(1, seeds + 1):
        flown.append(fly(begun(vehicle, seed), for_seconds(END)))
        tick()
    return flown


def begun(vehicle: str, seed: int) -> Loop:
    """Return a flight of a vehicle along the course that is about to begin."""
    made_of = gather(vehicle, SCENE, 'bag', '')
    base = parts_of(made_of)[0].standing_height
    return loop_on(made_of, course(base), seed)


def flying(loads: Loads, flown: Sequence[Flown]) -> list[Task]:
    """Return take-off, stabilising and flying, told apart."""
    steady = loads.idle + loads.transmitting
    parts = {
        'take-off': [taking_off(each) for each in flown],
        'hovering': [each.between(SETTLED, AWAY) for each in flown],
        f'flying at {SPEED:g} m/s': [each.between(CRUISING, END) for each in flown],
    }
    return [task(name, steady, part) for name, part in parts.items()]


def taking_off(flown: Flown) -> Flown:
    """Return the stretch from when the rotors are told to lift until it is nearly there."""
    there = flown.height[0] + RISE - NEAR
    arrived = flown.time[(flown.time > GO) & (flown.height >= there)]
    return flown.between(GO, float(arrived[0]) if len(arrived) else SETTLED)


def task(name: str, electronics: float, flown: Sequence[Flown]) -> Task:
    """Return what stretches of flights took, one a seed."""
    means = [float(each.rotors.mean()) for each in flown]
    mean = math.fsum(means) / len(means)
    seconds = math.fsum(float(each.time[-1] - each.time[0]) for each in flown) / len(flown)
    return Task(name, electronics, mean, max(abs(one - mean) for one in means), seconds)


def navigating(vehicle: str, strategy: str, seeds: int, tick: Callable[[], None]) -> Task:
    """Return what it takes to find a lamp by a strategy, from lift-off to the end."""
    made_of: Ingredients = gather(vehicle, LAMP_SCENE, strategy, '')
    flown, electronics = [], 0.0
    for seed in range(1, seeds + 1):
        loop = loop_on(made_of, None, seed)
        loads, energy = loop.world.vehicle.loads, loop.world.vehicle.file.energy
        electronics = loads.idle + loads.transmitting + looking(energy, strategy)
        whole = fly(loop, over)
        up = whole.time[whole.height > whole.height[0] + MOVED]
        flown.append(whole.between(float(up[0]) if len(up) else 0.0, math.inf))
        tick()
    return task(f'navigating, {strategy.upper()}', electronics, flown)


def over(loop: Loop) -> bool:
    """Tell whether a flight to a lamp is over."""
    ended = loop.world.outcome is not Outcome.FLYING
    return ended and topic_table().settled(loop.world.stamp_ns)
