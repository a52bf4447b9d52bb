"""
What the drone is about: rest, climb, seek the lamp, stay there, and land when the energy says so.

A mission is a phase and its strategy's memory. Phases only go forward, except that on a route of
several lamps the drone seeks the next one when it has arrived at one. It listens for the next lamp
while it still holds its place, and goes only when that lamp is heard for a while; otherwise it
listens to the lamp where it is again, stays, and asks once more later.

What is heard belongs to the beacon that was asked for a turn ago (`topics.yaml`, light/beacon).
"""

from enum import StrEnum
from typing import final, NamedTuple

from lta_config.course import Course
from lta_config.settings import setting
from lta_control.cascade import Setpoint
from lta_control.strategies.protocol import Memory, Sight, Strategy
from lta_control.strategies.settings import StrategySettings

SWITCHING = 2  # turns from asking for another beacon until what is heard is surely its light


class Phase(StrEnum):
    """What the drone is doing."""

    REST = 'rest'
    CLIMB = 'climb'
    SEEK = 'seek'
    ARRIVED = 'arrived'
    LAND = 'land'


@final
class MissionSettings(StrategySettings):
    """The mission's figures; altitudes are of the hull centre above the floor."""

    altitude: float = setting(0.5, 'Altitude to fly at.', unit='m', low=0.1, high=100.0)
    reached: float = setting(
        0.04, 'The climb ends this near the altitude.', unit='m', low=0.001, high=1.0
    )
    landing: float = setting(
        0.3,
        'Altitude asked for when landing; below where the gear stands.',
        unit='m',
        low=0.0,
        high=100.0,
    )
    heard: float = setting(
        0.5, 'Time for which the next lamp of a route must be heard.', unit='s', low=0.1, high=60.0
    )
    patience: float = setting(
        3.0, 'Time to listen for the next lamp of a route.', unit='s', low=0.5, high=600.0
    )
    again: float = setting(
        10.0, 'Time until it is listened for again.', unit='s', low=0.5, high=3600.0
    )


class Mission(NamedTuple):
    """
    How far the drone has come.

    Attributes
    ----------
    phase : Phase
        What it is doing.
    memory : tuple of float
        The strategy's, once it has begun.
    leg : int
        Which lamp of its route it seeks or stays at, from 0.
    asked : int
        Which one it listens for: `leg`, or the next.
    turns : int
        Light blocks since it began to listen for that one.
    heard : int
        How many of them, at the end and without a gap, had the lamp in sight.
    refused : bool
        Whether it stays because the next lamp was not heard.

    """

    phase: Phase = Phase.REST
    memory: Memory = ()
    leg: int = 0
    asked: int = 0
    turns: int = SWITCHING
    heard: int = 0
    refused: bool = False


def mission_step(
    settings: MissionSettings,
    strategy: Strategy,
    mission: Mission,
    sight: Sight,
    altitude: float | None,
    reserve: bool,
    lamps: int = 1,
) -> tuple[Setpoint, Mission]:
    """
    Return what the controller should hold, and the mission as it now stands.

    Parameters
    ----------
    settings : MissionSettings
        Altitudes and speeds.
    strategy : Strategy
        Steers while seeking.
    mission : Mission
        As it stood.
    sight : Sight
        The newest light.
    altitude : float or None
        Estimated; None while it is too early to take off: the estimator is learning its biases,
        or nothing is known of the energy. [m]
    reserve : bool
        Whether the energy reserve is reached.
    lamps : int
        On the route.

    """
    phase, memory = mission.phase, mission.memory
    if altitude is None:
        return Setpoint(0.0, sight.heading, 0.0), mission
    if phase is Phase.REST:
        phase, memory = Phase.CLIMB, strategy.start(sight.heading)
    if phase is Phase.CLIMB and altitude > settings.altitude - settings.reached:
        phase = Phase.SEEK
    if reserve:
        phase = Phase.LAND
    mission = mission._replace(phase=phase, memory=memory)
    if phase is Phase.SEEK or phase is Phase.ARRIVED:
        return _steered(settings, strategy, mission, sight, lamps)
    if phase is Phase.CLIMB and strategy.watch is not None:
        memory = strategy.watch(settings, memory, sight)
        mission = mission._replace(memory=memory)
    height = settings.landing if phase is Phase.LAND else settings.altitude
    return Setpoint(height, memory[0], 0.0), mission


def _steered(
    settings: MissionSettings, strategy: Strategy, mission: Mission, sight: Sight, lamps: int
) -> tuple[Setpoint, Mission]:
    """Return what the strategy asks for, and hand over to the next lamp where it has arrived."""
    known = mission.asked == mission.leg and mission.turns >= SWITCHING
    course, memory = strategy.steer(settings, mission.memory, sight if known else blind(sight))
    setpoint = Setpoint(settings.altitude, course.heading, course.speed)
    mission = mission._replace(memory=memory)
    if course.arrived:
        mission = mission._replace(phase=Phase.ARRIVED)
    if lamps > 1:
        mission = _listened(settings, strategy, mission, sight, lamps)
    return setpoint, mission


def blind(sight: Sight) -> Sight:
    """Return a sight without its light: of another lamp, or of none."""
    return sight._replace(seen=False, bearing=0.0, deviation=0.0, strength=0.0, elevation=0.0)


def _listened(
    settings: MissionSettings, strategy: Strategy, mission: Mission, sight: Sight, lamps: int
) -> Mission:
    """Return a mission of several lamps after one more turn of listening."""
    turns = mission.turns + 1
    heard = mission.heard + 1 if sight.seen and turns > SWITCHING else 0
    mission = mission._replace(turns=turns, heard=heard)
    if mission.phase is not Phase.ARRIVED or mission.leg + 1 == lamps:
        return mission
    time = turns * sight.interval
    if mission.asked == mission.leg:
        wait = settings.again if mission.refused else 0.0
        if time < wait:
            return mission
        return mission._replace(asked=mission.leg + 1, turns=0, heard=0)
    if heard * sight.interval >= settings.heard and strategy.onward is not None:
        memory = strategy.onward(mission.memory)
        return Mission(Phase.SEEK, memory, mission.asked, mission.asked, turns, heard)
    if time >= settings.patience:
        return mission._replace(asked=mission.leg, turns=0, heard=0, refused=True)
    return mission


def course_step(
    course: Course, time: float, heading: float, altitude: float | None, reserve: bool
) -> Setpoint:
    """
    Return what the controller should hold on a course that is flown instead of a search.

    Parameters
    ----------
    course : Course
        The course.
    time : float
        Since the first light. [s]
    heading : float
        Of the drone, which it keeps on the floor. [rad]
    altitude, reserve
        As of `mission_step`; with the reserve reached the drone comes down where it is.

    """
    if altitude is None:
        return Setpoint(0.0, heading, 0.0)
    asked = course.asked(time)
    if reserve:
        return Setpoint(0.0, asked.heading, 0.0)
    return Setpoint(asked.altitude, asked.heading, asked.speed)
