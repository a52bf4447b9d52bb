"""
What the drone is about: rest, climb, seek the lamp, and land when the energy says so.

A mission is a phase and its strategy's memory. Phases only go forward.
"""

from enum import StrEnum
from typing import final, NamedTuple

from lta_config.course import Course
from lta_config.settings import setting
from lta_control.cascade import Setpoint
from lta_control.strategies.protocol import CruiseSettings, Sight, Strategy


class Phase(StrEnum):
    """What the drone is doing."""

    REST = 'rest'
    CLIMB = 'climb'
    SEEK = 'seek'
    LAND = 'land'


@final
class MissionSettings(CruiseSettings):
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


class Mission(NamedTuple):
    """Phase, and the strategy's memory once it has begun."""

    phase: Phase = Phase.REST
    memory: tuple[float, ...] = ()


def mission_step(
    settings: MissionSettings,
    strategy: Strategy,
    mission: Mission,
    sight: Sight,
    altitude: float | None,
    reserve: bool,
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

    """
    phase, memory = mission
    if altitude is None:
        return Setpoint(0.0, sight.heading, 0.0), mission
    if phase is Phase.REST:
        phase, memory = Phase.CLIMB, strategy.start(sight.heading)
    if phase is Phase.CLIMB and altitude > settings.altitude - settings.reached:
        phase = Phase.SEEK
    if reserve:
        phase = Phase.LAND
    if phase is Phase.SEEK:
        course, memory = strategy.steer(settings, memory, sight)
        return Setpoint(settings.altitude, course.heading, course.speed), Mission(phase, memory)
    height = settings.landing if phase is Phase.LAND else settings.altitude
    return Setpoint(height, memory[0], 0.0), Mission(phase, memory)


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
