"""Fly one platform through one manoeuvre, and judge it by the truth."""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import final

from lta_config.schema.manoeuvre_file import Manoeuvre
from lta_config.settings import Settings
from lta_config.topics import topic_table
from lta_control.attitude import heading, up_in_body
from lta_control.cascade import Setpoint, wrap
from lta_control.laws.frames import to_world
from lta_control.laws.protocol import Law
from lta_control.pilot import Pilot
from lta_control.strategies import strategy
from lta_flight.loop import Loop
from lta_flight.policy import Policy
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.world import World
from lta_studies.platforms.metrics import Array, judge, Metrics
import numpy as np

ALTITUDE, HEADING, SPEED = 1, 2, 3
COLUMN = {'altitude': ALTITUDE, 'heading': HEADING, 'speed': SPEED}
HEIGHT_BAND = 0.2  # m of height that a manoeuvre of heading or speed may cost (assumed)


@final
@dataclass(frozen=True, slots=True)
class Entrant:
    """A platform that is ready to fly: vehicle, law, its gains, and a release [m] or None."""

    vehicle: Vehicle
    law: Law
    gains: Settings
    release: float | None = None


@final
@dataclass(frozen=True, slots=True)
class Flight:
    """
    What one flight came to.

    Attributes
    ----------
    metrics, height : Metrics
        Of what the manoeuvre is judged by, and of the altitude meanwhile.
    tilt : float
        Greatest, of the judged stretch. [rad]
    lost : str
        Why it was given up; '' if it was not.
    asked, flown : ndarray, shape (n, 4)
        Time [s], altitude [m], heading [rad, unwrapped] and speed along the course [m/s].
    duties : ndarray, shape (n, rotors)
        What the rotors did.

    """

    metrics: Metrics
    height: Metrics
    tilt: float
    lost: str
    asked: Array
    flown: Array
    duties: Array

    @property
    def held(self) -> bool:
        """Whether it did what it was asked, and kept its height."""
        return not self.lost and self.metrics.held and self.height.held


def course_of(manoeuvre: Manoeuvre, base: float) -> Callable[[float], Setpoint]:
    """Return the setpoint by time, over a height. [m]"""

    def course(time: float) -> Setpoint:
        asked = manoeuvre.asked(time)
        return Setpoint(base + asked.rise, asked.heading, asked.speed)

    return course


def begun(entrant: Entrant, scenario: Scenario, manoeuvre: Manoeuvre, seed: int) -> Loop:
    """Return a flight that is about to begin; the course of its policy is the manoeuvre."""
    table, vehicle = topic_table(), entrant.vehicle
    world = World(vehicle, scenario, table, seed)
    base = vehicle.standing_height
    if entrant.release is not None:
        base = world.state[2] = entrant.release
    course = course_of(manoeuvre, base)
    policy = Policy(strategy('bag'), entrant.gains, law=entrant.law, course=course)
    return Loop(world, table, policy)


def fly(entrant: Entrant, scenario: Scenario, manoeuvre: Manoeuvre, seed: int) -> Flight:
    """Fly once and judge."""
    loop = begun(entrant, scenario, manoeuvre, seed)
    world, course = loop.world, loop.policy.course
    assert course is not None
    flown, duties, tilts = [], [], []
    while world.elapsed <= manoeuvre.until.si:
        loop.decide()
        state = world.state.tolist()
        flown.append((world.elapsed, *_seen(state, course(world.elapsed).heading)))
        tilts.append(math.acos(max(-1.0, min(1.0, up_in_body(_quaternion(state))[2]))))
        duties.append(loop.duties)
        loop.act()
    pilot = loop.autopilot
    stopped = pilot.stopped if isinstance(pilot, Pilot) else pilot.memory.stopped
    return _judged(manoeuvre, course, np.array(flown), np.array(duties), np.array(tilts), stopped)


def _quaternion(state: list[float]) -> tuple[float, float, float, float]:
    x, y, z, w = state[3:7]
    return x, y, z, w


def _seen(state: list[float], course: float) -> tuple[float, float, float]:
    """Return height, heading and ground speed along a course, the truth."""
    attitude, (u, v, w) = _quaternion(state), state[7:10]
    x, y, _ = to_world(attitude, (u, v, w))
    return state[2], heading(attitude), math.cos(course) * x + math.sin(course) * y


def _judged(
    manoeuvre: Manoeuvre,
    course: Callable[[float], Setpoint],
    flown: Array,
    duties: Array,
    tilts: Array,
    stopped: bool,
) -> Flight:
    """Return the figures of a flight."""
    asked = np.array([(time, *course(time)) for time in flown[:, 0].tolist()])
    asked[:, HEADING] = np.unwrap(asked[:, HEADING])
    flown[:, HEADING] = np.unwrap(flown[:, HEADING])
    begin = manoeuvre.judged_from.si
    part = flown[:, 0] >= begin - 1e-9
    column = COLUMN[manoeuvre.judge]
    before = course(begin - 1e-6)
    first = Setpoint(before.altitude, wrap(before.heading), before.speed)[column - 1]
    time = flown[part, 0]
    metrics = judge(time, asked[part, column], flown[part, column], manoeuvre.band.si, first)
    rising = manoeuvre.judge == 'altitude'
    height = metrics if rising else judge(
        time, asked[part, ALTITUDE], flown[part, ALTITUDE], HEIGHT_BAND, before.altitude
    )  # fmt: skip
    lost = 'turned over' if stopped else ''
    return Flight(metrics, height, float(tilts[part].max()), lost, asked, flown, duties)
