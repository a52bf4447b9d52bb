# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Step the mission: rest, climb, seek the lamp, hold there, and land when the energy requires it.

A mission is a phase plus its strategy's memory. Phases only advance, except on a route of several
lamps: at each lamp the drone goes back to seeking, for the next one. It listens for the next lamp
while it holds its position, and leaves only when it has received that lamp for a while. Otherwise
it listens to the current lamp again, stays, and retries later.

When the energy reserve is reached, the drone lands, returns to its start or continues to the
lamp, as set in `reserve`. On the ground it stays there, and an interrupted flight is not resumed.

The received light belongs to the beacon requested one step earlier (`topics.yaml`, light/beacon).
"""

from enum import IntEnum
import math
from typing import NamedTuple

from lta_config.course import Course
from lta_config.settings import setting
from lta_control.motion import Setpoint
from lta_control.strategies.protocol import LightMeasurement, Memory, NavigationStrategy
from lta_control.strategies.settings import StrategySettings

SWITCHING = 2  # light blocks from requesting a beacon until a block surely holds its light


class Phase(IntEnum):
    """What the drone is doing."""

    REST = 0
    CLIMB = 1
    SEEK = 2
    ARRIVED = 3
    HOME = 4
    LAND = 5
    HOLD = 6  # between two commands, or at a place

    def __str__(self) -> str:
        """Return the name as diagnostics report it."""
        return self.name.lower()


class Mission(NamedTuple):
    """State of a mission."""

    phase: Phase = Phase.REST
    memory: Memory = ()  # memory of the strategy, once it has begun
    leg: int = 0  # index of the lamp that it seeks or holds at, from 0
    target: int = 0  # index of the lamp that it listens for: `leg`, or the next
    turns: int = SWITCHING  # light blocks since it began to listen for that one
    receptions: int = 0  # latest consecutive blocks with that lamp in sight
    refused: bool = False  # whether it stays because the next lamp was not received
    start: tuple[float, float] = (0.0, 0.0)  # take-off position, by dead reckoning [m, odom]
    left: float = 0.0  # remaining time for the flight back [s]
    heading: float = 0.0  # last commanded heading, held while landing [rad, odom]


class FlightPermission(IntEnum):
    """What the energy allows; a larger value ends the flight sooner."""

    FLY = 0
    RESERVE = 1
    DOWN = 2


class ReserveAction(IntEnum):
    """What to do at the energy reserve."""

    LAND = 0
    RETURN = 1
    PERCH = 2


class ReserveRule(NamedTuple):
    """`ReserveResponseSettings` as the mission takes them: numbers alone."""

    action: int
    home: float  # [m]
    patience: float
    turning: float  # [s]


class MissionSettings(StrategySettings):
    """Settings of the mission; altitudes are of the hull centre above the floor."""

    altitude: float = setting(0.5, 'm', 0.1, 100.0)
    """Altitude at which the mission is flown."""
    reached: float = setting(0.04, 'm', 0.001, 1.0)
    """The climb ends when the drone is less than this below the mission altitude."""
    landing: float = setting(0.3, 'm', 0.0, 100.0)
    """Altitude setpoint for landing; must be below the height of the hull on the ground."""
    reception_time: float = setting(0.5, 's', 0.1, 60.0)
    """Time for which the next lamp of a route must be received before flying to it."""
    patience: float = setting(3.0, 's', 0.5, 600.0)
    """
    Longest wait for light from the next lamp of a route; after that, the drone stays at its
    current lamp and tries again later.
    """
    again: float = setting(10.0, 's', 0.5, 3600.0)
    """Wait before the drone tries again to receive the next lamp of a route."""


def initial_mission(strategy: NavigationStrategy) -> Mission:
    """Return the mission at rest, with a memory of the strategy's type for compiled loops."""
    return Mission(
        Phase.REST, strategy.start(0.0), 0, 0, SWITCHING, 0, False, (0.0, 0.0), 0.0, 0.0
    )


def mission_step(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    mission: Mission,
    sight: LightMeasurement,
    altitude: float,
    order: FlightPermission,
    lamps: int,
    rule: ReserveRule,
) -> tuple[Setpoint, Mission]:
    """
    Return the controller's setpoint, and the new state of the mission.

    Parameters
    ----------
    strategy : NavigationStrategy
        Steers while seeking.
    sight : LightMeasurement
        The latest light.
    altitude : float
        Estimated altitude; NaN while take-off is not allowed: the estimator calibrates its
        biases, or the energy is unknown. [m]
    order : FlightPermission
        What the energy monitor allows.
    lamps : int
        Number of lamps on the route.
    rule : ReserveRule
        Action at the energy reserve.

    """
    waiting = mission.phase == Phase.REST and order != FlightPermission.FLY
    if math.isnan(altitude) or waiting:
        return Setpoint(0.0, sight.heading, 0.0), mission
    if mission.phase == Phase.REST:
        mission = mission._replace(
            phase=Phase.CLIMB,
            memory=strategy.start(sight.heading),
            heading=sight.heading,
            start=sight.position,  # for a later return
        )
    if mission.phase == Phase.CLIMB and altitude > settings.altitude - settings.reached:
        mission = mission._replace(phase=Phase.SEEK)
    mission = apply_reserve(rule, settings.speed, mission, sight, order)
    if mission.phase == Phase.CLIMB:
        mission = mission._replace(memory=strategy.watch(settings, mission.memory, sight))
    setpoint, mission, arrived = fly_phase(
        settings, strategy, mission, select_light(mission, sight), settings.altitude
    )
    if arrived:
        mission = mission._replace(phase=Phase.ARRIVED)
    if lamps > 1 and (mission.phase == Phase.SEEK or mission.phase == Phase.ARRIVED):
        mission = _listen_for_next(settings, strategy, mission, sight, lamps)
    return setpoint, mission


def apply_reserve(
    rule: ReserveRule,
    speed: float,
    mission: Mission,
    sight: LightMeasurement,
    order: FlightPermission,
) -> Mission:
    """
    Return the mission after applying the energy reserve.

    A flight back is never restarted and always ends in a landing, wherever it has led: it uses
    dead reckoning, which drifts with the wind. `speed` is its airspeed. [m/s]
    """
    if mission.phase == Phase.HOME:
        mission = mission._replace(left=mission.left - sight.interval)
        near = distance_to_start(mission.start, sight.position) <= rule.home
        over = near or mission.left <= 0.0 or order == FlightPermission.DOWN
        return mission._replace(phase=Phase.LAND) if over else mission
    if order == FlightPermission.FLY or mission.phase == Phase.LAND:
        return mission
    # During the climb the drone is still near its start, so it lands at once.
    if order == FlightPermission.RESERVE and mission.phase != Phase.CLIMB:
        # Continue to the lamp; the landing follows on arrival
        if rule.action == ReserveAction.PERCH and mission.phase == Phase.SEEK:
            return mission
        if rule.action == ReserveAction.RETURN and speed > 0.0:
            way = distance_to_start(mission.start, sight.position)
            # A time limit, because a head wind may make the start unreachable
            left = rule.turning + rule.patience * way / speed
            return mission._replace(phase=Phase.HOME, left=left)
    return mission._replace(phase=Phase.LAND)


def heading_to_start(start: tuple[float, float], place: tuple[float, float]) -> float:
    """Return the heading to the start [rad, odom]."""
    return math.atan2(start[1] - place[1], start[0] - place[0])


def distance_to_start(start: tuple[float, float], place: tuple[float, float]) -> float:
    """Return the distance from the start [m]."""
    return math.hypot(start[0] - place[0], start[1] - place[1])


def fly_phase(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    mission: Mission,
    sight: LightMeasurement,
    height: float,
) -> tuple[Setpoint, Mission, bool]:
    """
    Return the setpoint of a phase, the mission, and whether the strategy is at the lamp.

    Missions and commanded flights (`commanded_flight`) decide which phase it is; this flies it, at
    a height above the floor. [m]
    """
    if mission.phase == Phase.REST:
        return Setpoint(0.0, sight.heading, 0.0), mission, False
    if mission.phase == Phase.HOME:
        heading = heading_to_start(mission.start, sight.position)
        return Setpoint(height, heading, settings.speed), mission._replace(heading=heading), False
    if mission.phase == Phase.SEEK or mission.phase == Phase.ARRIVED:
        course, memory = strategy.steer(settings, mission.memory, sight)
        setpoint = Setpoint(height, course.heading, course.speed)
        return setpoint, mission._replace(memory=memory, heading=memory[0]), course.arrived
    low = mission.phase == Phase.LAND
    return Setpoint(settings.landing if low else height, mission.heading, 0.0), mission, False


def select_light(mission: Mission, sight: LightMeasurement) -> LightMeasurement:
    """Return a sight without its light if that may be of another lamp than the mission's."""
    # The first blocks after a switch may still hold the other lamp's light.
    is_current = mission.target == mission.leg and mission.turns >= SWITCHING
    return sight if is_current else remove_light(sight)


def remove_light(sight: LightMeasurement) -> LightMeasurement:
    """Return a sight without its light, for a block of another lamp or of none."""
    return sight._replace(seen=False, bearing=0.0, deviation=0.0, strength=0.0, elevation=0.0)


def _listen_for_next(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    mission: Mission,
    sight: LightMeasurement,
    lamps: int,
) -> Mission:
    """Return the mission after one more block of listening on a route of several lamps."""
    turns = mission.turns + 1
    # Consecutive blocks only: one block without the lamp starts the count again
    received = mission.receptions + 1 if sight.seen and turns > SWITCHING else 0
    mission = mission._replace(turns=turns, receptions=received)
    if mission.phase != Phase.ARRIVED or mission.leg + 1 == lamps:
        return mission
    time = turns * sight.interval
    if mission.target == mission.leg:
        # After an unsuccessful attempt, stay with the current lamp for a while
        wait = settings.again if mission.refused else 0.0
        if time < wait:
            return mission
        return mission._replace(target=mission.leg + 1, turns=0, receptions=0)
    if received * sight.interval >= settings.reception_time and strategy.arrives:
        return mission._replace(
            phase=Phase.SEEK,
            memory=strategy.onward(mission.memory),
            leg=mission.target,
            turns=turns,
            receptions=received,
            refused=False,
        )
    if time >= settings.patience:
        return mission._replace(target=mission.leg, turns=0, receptions=0, refused=True)
    return mission


def course_step(
    course: Course, time: float, heading: float, altitude: float, order: FlightPermission
) -> Setpoint:
    """
    Return the controller's setpoint on a fixed course that replaces the search.

    `time` counts from the first light [s], and `heading` [rad] is held on the floor. Where the
    energy does not allow to fly on, the drone lands where it is.
    """
    if math.isnan(altitude):
        return Setpoint(0.0, heading, 0.0)
    planned = course.setpoint_at(time)
    if order != FlightPermission.FLY:
        return Setpoint(0.0, planned.heading, 0.0)
    return Setpoint(planned.altitude, planned.heading, planned.speed)
