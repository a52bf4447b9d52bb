# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly by commands: take off, go to a lamp or to places, land, and hold between them.

`CommandedFlight` decides after each light block, as `Guidance` does for a mission that flies by
itself. A task begins with a request and ends with a result. Without a task the drone rests on the
ground, or holds its height and heading; where a tracker sees it, or at a lamp, it also holds its
position against the wind. A tracker that is lost ends a flight to a place, and that hold.

The energy reserve applies as in a mission, with or without a task. Whatever lands the drone but
a task ends the task. A drone that stands on the ground rests, so nothing starts its motors again
but the next take-off.
"""

import math
from typing import final

from lta_config.errors import BadInput
from lta_control.actions.tasks import (
    FlightTask,
    NO_ROUTE,
    TaskKind,
    TaskLimits,
    TaskOutcome,
    TaskProgress,
    TaskResult,
    TO_PLACES,
)
from lta_control.flight_step import FOOT, has_landed, LandingWatch, watch_landing
from lta_control.guidance import decide_permission, GuidanceInputs, refuse_failures
from lta_control.mission import (
    apply_reserve,
    FlightPermission,
    fly_phase,
    Mission,
    MissionSettings,
    Phase,
    select_light,
)
from lta_control.motion import CascadeMeasurement, FLOOR_SETPOINT, Setpoint
from lta_control.odometry.tracked_motion import LocatedMotion
from lta_control.place_hold import (
    begin_hold,
    find_route_fault,
    Place,
    PlaceHold,
    Route,
    steer_to_place,
)
from lta_control.strategies.protocol import NavigationStrategy
from lta_vlc.settings import ANY_BEACON

HIGHEST_TAKE_OFF = 100.0  # m, of a take-off
FASTEST_BEACON = 100e3  # Hz
# s without sinking after which a landing is reported: later than the controller ends it, as its
# wrong end in the air would pass and a wrong report would not
LANDED = 15.0
# s at the lamp or place after which a flight there has succeeded: one that passes has left by then
STAYED = 3.0
# s without light, away from the lamp, after which a drone without a task holds
LOST_LAMP = 3.0


def check_commanded(strategy: NavigationStrategy, has_course: bool) -> None:
    """Raise `BadInput` if a flight cannot be commanded."""
    if not strategy.arrives:
        raise BadInput(
            f'The strategy {strategy.name} never reports an arrival at a lamp, so no flight to a '
            'lamp can be commanded; choose the strategy homing.'
        )
    if has_course:
        raise BadInput(
            'A scenario with a course flies by itself; choose another one to fly by commands.'
        )


@final
class CommandedFlight:
    """
    Decisions of a flight by commands.

    Parameters
    ----------
    limits : TaskLimits
        Limits, which may change in flight.
    ground_height : float
        Altitude of the hull centre when the drone stands on the floor. [m]
    room : 3-tuple of float or None
        Length, width and height of the room around the origin of the map, if it is known. [m]

    Attributes
    ----------
    mission, permission, beacon
        As in `Guidance`.
    progress : TaskProgress
        State after the newest light block.
    motors_turn : bool
        Whether a motor turns; True where that is unknown.

    """

    def __init__(
        self,
        limits: TaskLimits,
        ground_height: float,
        room: tuple[float, float, float] | None = None,
    ) -> None:
        self.mission, self.permission = Mission(), FlightPermission.DOWN
        self.beacon = ANY_BEACON
        self.progress = TaskProgress()
        self.limits, self._ground_height, self._room = limits, ground_height, room
        self.motors_turn = True
        self._height = 0.0
        self._unseen = 0.0  # time away from the lamp without its light [s]
        self._spot: PlaceHold | None = None  # that is held, or flown to, in the phase HOLD
        self._landing = LandingWatch()
        self._task: FlightTask | None = None
        self._situation: GuidanceInputs | None = None
        self._obstacle = ''  # why nothing can be commanded now

    def request(self, kind: TaskKind, value: float = 0.0, route: Route = NO_ROUTE) -> FlightTask:
        """Return a new task; raise `BadInput` if there is an obstacle."""
        if why := self.find_obstacle(kind, value, route):
            raise BadInput(why)
        now = self._situation
        assert now is not None  # else there is an obstacle
        self._end_task(TaskOutcome.CANCELED, 'a landing was commanded')
        task = self._task = FlightTask(kind, value, route)
        if kind is TaskKind.TAKE_OFF:
            self._height = value or now.settings.altitude
            self.mission = Mission(
                Phase.CLIMB, start=now.sight.position, heading=now.sight.heading
            )
        elif kind is TaskKind.GO_TO_LAMP:
            self.beacon = value
            # The memory is made by the strategy in the next step
            self.mission = self.mission._replace(phase=Phase.SEEK, memory=(), turns=0)
        elif kind in TO_PLACES:
            assert now.located is not None  # else there is an obstacle
            self._change_phase(Phase.HOLD, now)
            self._aim(route.places[0], now.located)
        else:
            self._change_phase(Phase.LAND, now)
        return task

    def cancel(self, task: FlightTask) -> bool:
        """End a task, and hold; return whether it was still flown."""
        if task is not self._task or self._situation is None:
            return False
        self._end_task(TaskOutcome.CANCELED, 'canceled')
        self._hold(self._situation)
        return True

    def fail(self, reason: str) -> None:
        """End the task by a fault, and land; refuse others until the next light block."""
        self._obstacle = reason
        self._end_task(TaskOutcome.FAULT, reason)
        if self.mission.phase is not Phase.REST:
            self.mission = self.mission._replace(phase=Phase.LAND)

    def yield_to_person(self) -> None:
        """End the task, as a person flies; hold where they hand the drone back."""
        self._obstacle = 'a person has control'
        self._end_task(TaskOutcome.CANCELED, 'a person took control')
        now = self._situation
        # They may have started from the ground
        if now is not None and (self.mission.phase is not Phase.REST or self._is_airborne(now)):
            self._hold(now)

    def _is_airborne(self, now: GuidanceInputs) -> bool:
        return now.measured is not None and not self._stands(now.measured)

    def _stands(self, measured: CascadeMeasurement) -> bool:
        return has_landed(measured.altitude, measured.climb, FLOOR_SETPOINT, self._ground_height)

    @refuse_failures
    def choose_setpoint(self, inputs: GuidanceInputs) -> Setpoint:
        """Return the setpoint after a light block."""
        self._situation, self._obstacle = inputs, ''
        self.permission = decide_permission(inputs.reserve, inputs.report, inputs.stamp_ns)
        measured = inputs.measured
        if measured is None:
            self.progress = TaskProgress()
            self.fail('the estimate is unknown')
            return FLOOR_SETPOINT._replace(heading=inputs.sight.heading)
        self._update_progress(inputs, measured)
        self._rest_on_the_ground(measured, inputs.sight.interval)
        self._apply_reserve(inputs)
        return self._step_phase(inputs, measured)

    def find_obstacle(self, kind: TaskKind, value: float = 0.0, route: Route = NO_ROUTE) -> str:
        """Return why a task cannot begin now, or ''."""
        now, phase = self._situation, self.mission.phase
        if now is None:
            return 'no light block has come yet'
        if self._obstacle:
            return self._obstacle
        if kind is TaskKind.LAND:
            return 'the drone does not fly' if phase is Phase.REST else ''
        if self._task is not None:
            return f'{self._task.kind} is in progress; cancel it first'
        if self.permission is not FlightPermission.FLY:
            return now.explain_restriction()
        if kind is TaskKind.TAKE_OFF:
            return self._find_obstacle_to_climb(now.settings, value)
        if phase is not Phase.HOLD and phase is not Phase.ARRIVED:
            return 'the drone does not fly' if phase is Phase.REST else 'the drone is landing'
        if kind in TO_PLACES:
            if now.located is None or not now.located.tracked:
                return 'no tracker sees the drone'
            lowest = self._find_lowest(now.settings)
            return find_route_fault(route, self._room, lowest, HIGHEST_TAKE_OFF)
        if not 0.0 <= value <= FASTEST_BEACON:
            return f'a lamp cannot flicker at {value:g} Hz; give 0 to {FASTEST_BEACON:g}'
        return ''

    def _find_lowest(self, settings: MissionSettings) -> float:
        """Return the height above which the drone does not count as landed [m]."""
        return self._ground_height + FOOT + settings.reached

    def _find_obstacle_to_climb(self, settings: MissionSettings, value: float) -> str:
        """Return why a take-off to a height [m] is refused, or ''."""
        if self.mission.phase is not Phase.REST:
            return 'the drone flies already'
        height = value or settings.altitude
        lowest = self._find_lowest(settings)  # as the climb ends `reached` below its height
        if not lowest < height <= HIGHEST_TAKE_OFF:
            return (
                f'the hull centre cannot fly {height:g} m above the ground; give more than '
                f'{lowest:.2f}, at most {HIGHEST_TAKE_OFF:g}'
            )
        return ''

    def _end_task(self, outcome: TaskOutcome, message: str) -> None:
        """Give the task its result, if there is one."""
        if self._task is not None:
            self._task.result = TaskResult(outcome, message)
            self._task = None

    def _change_phase(self, phase: Phase, now: GuidanceInputs) -> None:
        """Enter a phase at the present heading, and hold the present place if it is tracked."""
        located = now.located
        self._spot = None
        if located is not None and located.tracked:
            self._spot = begin_hold(located, located.position)
        self.mission = self.mission._replace(phase=phase, heading=now.sight.heading)

    def _hold(self, now: GuidanceInputs) -> None:
        """Hold the present heading, and the present height on the way up or down."""
        if self.mission.phase is not Phase.SEEK and now.measured is not None:
            self._height = now.measured.altitude
        self._change_phase(Phase.HOLD, now)

    def _update_progress(self, now: GuidanceInputs, measured: CascadeMeasurement) -> None:
        memory, sight = self.mission.memory, now.sight
        self.progress = TaskProgress(
            measured.altitude,
            measured.climb,
            sight.seen,
            now.strategy.distance(memory) if memory else math.nan,
            sight.bearing if sight.seen else math.nan,
        )

    def _rest_on_the_ground(self, measured: CascadeMeasurement, interval: float) -> None:
        """Rest where the drone stands on the ground, whatever brought it there."""
        phase = self.mission.phase
        self._landing = watch_landing(
            self._landing, measured.altitude, phase is Phase.LAND, interval
        )
        stands = self._stands(measured) or self._landing.still > LANDED
        if phase is Phase.CLIMB or not stands:
            return
        if self._task is not None:
            landing = self._task.kind is TaskKind.LAND
            self._end_task(
                TaskOutcome.SUCCEEDED if landing else TaskOutcome.FAULT,
                'the drone stands on the ground',
            )
        self.mission = Mission()

    def _apply_reserve(self, now: GuidanceInputs) -> None:
        """Land or return where the energy requires it."""
        if self.mission.phase is Phase.REST:
            return
        self.mission = apply_reserve(
            now.reserve.rule, now.settings.speed, self.mission, now.sight, self.permission
        )
        commanded = self._task is not None and self._task.kind is TaskKind.LAND
        if not commanded and self.mission.phase in (Phase.LAND, Phase.HOME):
            silent = now.report is None or now.report.age(now.stamp_ns) > now.reserve.stale
            outcome = TaskOutcome.FAULT if silent else TaskOutcome.RESERVE
            self._end_task(outcome, now.explain_restriction())

    def _aim(self, place: Place, located: LocatedMotion) -> None:
        """Hold another place from now on."""
        self._spot = begin_hold(located, (place.x, place.y))
        self._height = place.height or self._height

    def _hold_place(
        self, now: GuidanceInputs, measured: CascadeMeasurement, spot: PlaceHold, seconds: float
    ) -> Setpoint:
        """Return the setpoint at a place, or on the way there; end the flight there."""
        located, task = now.located, self._task
        if located is None or located.tracked is not spot.tracked:
            self._end_task(TaskOutcome.FAULT, 'the tracker is lost; holding height and heading')
            self._change_phase(Phase.HOLD, now)
            self._spot = None  # until the next command, also if it comes back
            return Setpoint(self._height, self.mission.heading, 0.0)
        speed, self._spot = steer_to_place(now.settings, spot, located)
        setpoint = Setpoint(self._height, self._spot.heading + located.turn, speed)
        if task is None or task.kind not in TO_PLACES:
            return setpoint
        away = math.dist(located.position, spot.goal)
        distance = math.hypot(away, measured.altitude - self._height)
        self.progress = self.progress._replace(distance=distance, place=task.place)
        is_last = task.place == len(task.route.places) - 1
        is_near = distance <= (task.route.tolerance or self.limits.tolerance)
        if is_near and not is_last:
            task.place, task.flown_ns = task.place + 1, 0
            self._aim(task.route.places[task.place], located)
        elif self._has_stayed(task, is_near):
            self._end_task(TaskOutcome.SUCCEEDED, 'the place is reached')
        elif seconds > self.limits.place:
            message = f'{distance:.2f} m from the place after {seconds:.0f} s; holding'
            self._end_task(TaskOutcome.TIMEOUT, message)
            self._change_phase(Phase.HOLD, now)
        return setpoint

    def _step_phase(self, now: GuidanceInputs, measured: CascadeMeasurement) -> Setpoint:
        """Return the setpoint of the phase, and go on to the next one."""
        settings, task, seconds = now.settings, self._task, 0.0
        if task is not None:
            task.advance(now.stamp_ns)
            seconds = task.flown_ns * 1e-9
        phase = self.mission.phase
        if phase is Phase.HOLD and self._spot is not None:
            return self._hold_place(now, measured, self._spot, seconds)
        if phase is Phase.CLIMB:
            self._climb(now, measured, seconds)
        elif phase is Phase.LAND and seconds > self.limits.land:
            self._end_task(TaskOutcome.TIMEOUT, f'not on the ground after {seconds:.0f} s')
        steers = phase is Phase.SEEK or phase is Phase.ARRIVED
        if steers and not self.mission.memory:
            memory = now.strategy.start(now.sight.heading)
            self.mission = self.mission._replace(memory=memory)
        sight = select_light(self.mission, now.sight) if steers else now.sight
        setpoint, self.mission, arrived = fly_phase(
            settings, now.strategy, self.mission, sight, self._height
        )
        if steers:
            self.mission = self.mission._replace(turns=self.mission.turns + 1)
            self._judge_flight_to_lamp(now, seconds, sees=sight.seen, arrived=arrived)
            if self.mission.phase is Phase.HOLD:
                return Setpoint(self._height, self.mission.heading, 0.0)
        return setpoint

    def _climb(self, now: GuidanceInputs, measured: CascadeMeasurement, seconds: float) -> None:
        """End a climb at its height or its time limit."""
        task = self._task
        if task is not None:
            task.driven |= self.motors_turn
        if measured.altitude > self._height - now.settings.reached:
            if task is not None and not task.driven:
                # Motors that are armed later must not hold it in the hands that carry it
                self._end_task(
                    TaskOutcome.FAULT, 'lifted without its motors; landing (are they armed?)'
                )
                self.mission = self.mission._replace(phase=Phase.LAND)
                return
            self._end_task(TaskOutcome.SUCCEEDED, 'the height is reached')
            heading = self.mission.heading
            self._change_phase(Phase.HOLD, now)
            self.mission = self.mission._replace(heading=heading)
        elif seconds > self.limits.take_off:
            # Motors that were off, and are armed later, must not start
            self._end_task(
                TaskOutcome.TIMEOUT,
                f'{measured.altitude:.2f} m high after {seconds:.0f} s; landing (are the motors '
                'armed?)',
            )
            self.mission = self.mission._replace(phase=Phase.LAND)

    def _judge_flight_to_lamp(
        self, now: GuidanceInputs, seconds: float, *, sees: bool, arrived: bool
    ) -> None:
        """End a flight to a lamp at the lamp, without its light, or at its time limit."""
        task = self._task
        self._unseen = 0.0 if sees or arrived else self._unseen + now.sight.interval
        if task is None:
            # It returns to a lamp that it was blown off, but never searches for a lost one
            if self._unseen > LOST_LAMP:
                self._change_phase(Phase.HOLD, now)
            return
        if sees:
            task.unseen_ns = 0
        unseen = task.unseen_ns * 1e-9
        # An arrival outlasts a gust; the goal does not grow by it. NaN is no distance.
        beyond = now.strategy.distance(self.mission.memory) > now.settings.homing.arrival
        if self._has_stayed(task, arrived and not beyond):
            self._end_task(TaskOutcome.SUCCEEDED, 'the lamp is reached')
            if now.located is not None and now.located.tracked:
                self._change_phase(Phase.HOLD, now)
            else:
                self.mission = self.mission._replace(phase=Phase.ARRIVED)
        elif unseen > self.limits.unseen:
            self._end_task(
                TaskOutcome.NOT_SEEN, f'no light from the lamp for {unseen:.0f} s; holding'
            )
            self._change_phase(Phase.HOLD, now)
        elif seconds > self.limits.go_to_lamp:
            self._end_task(TaskOutcome.TIMEOUT, f'not at the lamp after {seconds:.0f} s; holding')
            self._change_phase(Phase.HOLD, now)

    def _has_stayed(self, task: FlightTask, is_there: bool) -> bool:
        """Return whether the drone has been at its lamp or place for `STAYED`."""
        if not is_there:
            task.arrived_ns = None
            return False
        if task.arrived_ns is None:
            task.arrived_ns = task.flown_ns
        return (task.flown_ns - task.arrived_ns) * 1e-9 >= STAYED
