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

from typing import final

from lta_config.course import Course
from lta_config.settings import setting
from lta_control.cascade import Setpoint
from lta_control.phases import Mission, Phase, SWITCHING
from lta_control.reserve import FlightPermission, ReserveActionSettings
from lta_control.reserve_policy import apply_reserve, heading_to_start
from lta_control.strategies.protocol import LightSight, NavigationStrategy
from lta_control.strategies.settings import StrategySettings


@final
class MissionSettings(StrategySettings):
    """Settings of the mission; altitudes are of the hull centre above the floor."""

    altitude: float = setting(0.5, 'Altitude to fly at.', unit='m', low=0.1, high=100.0)
    reached: float = setting(
        0.04, 'Distance from the altitude at which the climb ends.', unit='m', low=0.001, high=1.0
    )
    landing: float = setting(
        0.3,
        'Altitude setpoint for landing; below the standing height.',
        unit='m',
        low=0.0,
        high=100.0,
    )
    heard: float = setting(
        0.5,
        'Time for which the next lamp of a route must be received.',
        unit='s',
        low=0.1,
        high=60.0,
    )
    patience: float = setting(
        3.0, 'Time to listen for the next lamp of a route.', unit='s', low=0.5, high=600.0
    )
    again: float = setting(10.0, 'Time until the next attempt.', unit='s', low=0.5, high=3600.0)


def mission_step(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    mission: Mission,
    sight: LightSight,
    altitude: float | None,
    order: FlightPermission,
    lamps: int = 1,
    reserve: ReserveActionSettings = ReserveActionSettings(),  # noqa: B008 - frozen
) -> tuple[Setpoint, Mission]:
    """
    Return the controller's setpoint, and the new state of the mission.

    Parameters
    ----------
    strategy : NavigationStrategy
        Steers while seeking.
    sight : LightSight
        The latest light.
    altitude : float or None
        Estimated altitude; None while take-off is not allowed: the estimator calibrates its
        biases, or the energy is unknown. [m]
    order : FlightPermission
        What the energy monitor allows.
    lamps : int
        Number of lamps on the route.
    reserve : ReserveActionSettings
        Action at the energy reserve.

    """
    phase, memory = mission.phase, mission.memory
    if altitude is None or (phase is Phase.REST and order is not FlightPermission.FLY):
        return Setpoint(0.0, sight.heading, 0.0), mission
    if phase is Phase.REST:
        phase, memory = Phase.CLIMB, strategy.start(sight.heading)
        # Take-off position for a later return
        mission = mission._replace(start=sight.position)
    if phase is Phase.CLIMB and altitude > settings.altitude - settings.reached:
        phase = Phase.SEEK
    mission = mission._replace(phase=phase, memory=memory)
    mission = apply_reserve(reserve, settings.speed, mission, sight, order)
    phase, memory = mission.phase, mission.memory
    if phase is Phase.HOME:
        heading = heading_to_start(mission.start, sight.position)
        # The first element of every strategy's memory is the last commanded heading
        mission = mission._replace(memory=(heading, *memory[1:]))
        return Setpoint(settings.altitude, heading, settings.speed), mission
    if phase is Phase.SEEK or phase is Phase.ARRIVED:
        return _steer_by_strategy(settings, strategy, mission, sight, lamps)
    if phase is Phase.CLIMB and strategy.watch is not None:
        memory = strategy.watch(settings, memory, sight)
        mission = mission._replace(memory=memory)
    height = settings.landing if phase is Phase.LAND else settings.altitude
    return Setpoint(height, memory[0], 0.0), mission


def _steer_by_strategy(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    mission: Mission,
    sight: LightSight,
    lamps: int,
) -> tuple[Setpoint, Mission]:
    """Return the strategy's setpoint, and switch to the next lamp after an arrival."""
    # The first blocks after a switch may still hold the other lamp's light.
    known = mission.asked == mission.leg and mission.turns >= SWITCHING
    course, memory = strategy.steer(
        settings, mission.memory, sight if known else remove_light(sight)
    )
    setpoint = Setpoint(settings.altitude, course.heading, course.speed)
    mission = mission._replace(memory=memory)
    if course.arrived:
        mission = mission._replace(phase=Phase.ARRIVED)
    if lamps > 1:
        mission = _listen_for_next(settings, strategy, mission, sight, lamps)
    return setpoint, mission


def remove_light(sight: LightSight) -> LightSight:
    """Return a sight without its light, for a block of another lamp or of none."""
    return sight._replace(seen=False, bearing=0.0, deviation=0.0, strength=0.0, elevation=0.0)


def _listen_for_next(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    mission: Mission,
    sight: LightSight,
    lamps: int,
) -> Mission:
    """Return the mission after one more block of listening on a route of several lamps."""
    turns = mission.turns + 1
    # Consecutive blocks only: one block without the lamp starts the count again
    received = mission.heard + 1 if sight.seen and turns > SWITCHING else 0
    mission = mission._replace(turns=turns, heard=received)
    if mission.phase is not Phase.ARRIVED or mission.leg + 1 == lamps:
        return mission
    time = turns * sight.interval
    if mission.asked == mission.leg:
        # After an unsuccessful attempt, stay with the current lamp for a while
        wait = settings.again if mission.refused else 0.0
        if time < wait:
            return mission
        return mission._replace(asked=mission.leg + 1, turns=0, heard=0)
    if received * sight.interval >= settings.heard and strategy.onward is not None:
        memory = strategy.onward(mission.memory)
        leg = mission.asked
        return mission._replace(
            phase=Phase.SEEK, memory=memory, leg=leg, turns=turns, heard=received, refused=False
        )
    if time >= settings.patience:
        return mission._replace(asked=mission.leg, turns=0, heard=0, refused=True)
    return mission


def course_step(
    course: Course, time: float, heading: float, altitude: float | None, order: FlightPermission
) -> Setpoint:
    """
    Return the controller's setpoint on a fixed course that replaces the search.

    `time` counts from the first light [s], and `heading` [rad] is held on the floor. Where the
    energy does not allow to fly on, the drone lands where it is.
    """
    if altitude is None:
        return Setpoint(0.0, heading, 0.0)
    planned = course.setpoint_at(time)
    if order is not FlightPermission.FLY:
        return Setpoint(0.0, planned.heading, 0.0)
    return Setpoint(planned.altitude, planned.heading, planned.speed)
