# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Choose the setpoint after each light block, along the scenario's course or by the mission.

The navigator node and the one-process loop both decide with this class.
"""

from collections.abc import Callable, Sequence
from functools import wraps
import math
from typing import final, Literal, NamedTuple, TypeVar

from lta_config.course import Course
from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_control.mission import (
    course_step,
    FlightPermission,
    Mission,
    mission_step,
    MissionSettings,
    ReserveAction,
    ReserveRule,
)
from lta_control.motion import CascadeMeasurement, Setpoint
from lta_control.odometry.tracked_motion import LocatedMotion
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy
from lta_control.strategies.strategy_file import explain_failure
from lta_vlc.settings import ANY_BEACON

Action = Literal['land', 'return', 'perch']
Chooser = TypeVar('Chooser')


@final
class ReserveResponseSettings(Settings):
    """Action at the energy reserve, and how long a report is valid."""

    action: Action = setting('land', fixed=True)
    """
    What to do at the energy reserve: "land" at once, "return" to the start and land there, or
    "perch": fly on to the lamp and land there (needs a strategy that reports its arrival, such as
    homing).
    """
    stale: float = setting(1.0, 's', 0.2, 600.0)
    """If the latest report of the energy monitor is older than this, the drone lands."""
    home: float = setting(0.5, 'm', 0.05, 100.0)
    """Distance from the start at which the returning drone lands."""
    patience: float = setting(2.0, low=1.0, high=20.0)
    """Time limit of the flight back to the start, as a multiple of distance / airspeed."""
    turning: float = setting(20.0, 's', 0.0, 600.0)
    """Time added to the limit of the flight back, for slowing down and turning."""

    @property
    def rule(self) -> ReserveRule:
        """Return the part that decides in flight."""
        action = ReserveAction[self.action.upper()]
        return ReserveRule(action, self.home, self.patience, self.turning)


class ReserveReport(NamedTuple):
    """Latest report of the energy monitor."""

    reserve_ns: int  # arrival of `energy/reserve` in graph time [ns]
    reserve: bool  # whether the reserve is reached
    urgent: bool  # whether to land at once
    why: str = ''  # reason in words
    # Arrival of `energy/status`, from which `urgent` and `why` are; None: with the reserve
    status_ns: int | None = None

    def age(self, now_ns: int) -> float:
        """Return the time since the arrival of the older part, in graph time [s]."""
        status_ns = self.reserve_ns if self.status_ns is None else self.status_ns
        return (now_ns - min(self.reserve_ns, status_ns)) * 1e-9


def decide_permission(
    settings: ReserveResponseSettings, word: ReserveReport | None, now_ns: int
) -> FlightPermission:
    """Return what the energy allows; without a fresh report the drone must land."""
    if word is None or word.age(now_ns) > settings.stale or word.urgent:
        return FlightPermission.DOWN
    return permission_at_reserve(word.reserve)


def permission_at_reserve(reserve: bool) -> FlightPermission:
    """Return what the energy allows, by whether the reserve is reached."""
    return FlightPermission.RESERVE if reserve else FlightPermission.FLY


def explain_restriction(
    settings: ReserveResponseSettings, word: ReserveReport | None, now_ns: int
) -> str:
    """Return why the energy restricts the flight, in words."""
    if word is None:
        return 'no report from the energy monitor'
    age = word.age(now_ns)
    if age > settings.stale:
        return f'no report from the energy monitor for {age:.1f} s'
    return word.why or 'the energy reserve is reached'


def check_reserve(settings: ReserveResponseSettings, strategy: NavigationStrategy) -> None:
    """Raise `BadInput` if the strategy does not support the action at the reserve."""
    if settings.action == 'perch' and not strategy.arrives:
        raise BadInput(
            f'The strategy {strategy.name} never reports an arrival at a lamp, so it does not '
            'support reserve.action perch; choose the strategy homing, or set '
            'reserve.action to land or return.'
        )


class GuidanceInputs(NamedTuple):
    """What a setpoint is chosen from after a light block."""

    settings: MissionSettings
    reserve: ReserveResponseSettings
    strategy: NavigationStrategy
    stamp_ns: int  # stamp of the block; a course counts from the first one [ns]
    sight: LightMeasurement  # the light of the block
    measured: CascadeMeasurement | None  # the drone's motion; None while the estimator calibrates
    report: ReserveReport | None  # the latest report of the energy monitor
    located: LocatedMotion | None = None  # for places that are held; None where it is unknown

    def explain_restriction(self) -> str:
        """Return why the energy restricts the flight, in words."""
        return explain_restriction(self.reserve, self.report, self.stamp_ns)


def refuse_failures(
    choose: Callable[[Chooser, GuidanceInputs], Setpoint],
) -> Callable[[Chooser, GuidanceInputs], Setpoint]:
    """Make a choice of setpoints raise `BadInput` where a strategy from a file fails."""

    @wraps(choose)
    def choose_or_refuse(chooser: Chooser, inputs: GuidanceInputs) -> Setpoint:
        if not inputs.strategy.file:
            return choose(chooser, inputs)
        try:
            # Messages take floats only
            setpoint = Setpoint(*map(float, choose(chooser, inputs)))
            # An unknown heading of the drone is no fault of the strategy
            if math.isfinite(inputs.sight.heading) and not all(map(math.isfinite, setpoint)):
                raise ValueError(
                    f'it commands a heading of {setpoint.heading} rad at {setpoint.speed} m/s'
                )
        except (Exception, SystemExit) as error:
            raise explain_failure(inputs.strategy, error) from error
        return setpoint

    return choose_or_refuse


@final
class Guidance:
    """
    Decisions of one flight.

    Parameters
    ----------
    course : Course or None
        Course that replaces the search.
    route : sequence of (str, float)
        Name and beacon frequency [Hz] of each lamp in the order of the flight; empty without a
        route.

    Attributes
    ----------
    course, route
        As given.
    mission : Mission
        State of the mission, which a course does not change.
    permission : FlightPermission
        What the energy allowed after the newest light block.
    beacon : float
        Beacon frequency to listen to next; 0 for the demodulator's own, as before the first light
        block. [Hz]

    """

    def __init__(self, course: Course | None, route: Sequence[tuple[str, float]]) -> None:
        self.mission, self.permission = Mission(), FlightPermission.DOWN
        self.beacon = ANY_BEACON
        self.course, self.route = course, route
        self._begun_ns: int | None = None

    @refuse_failures
    def choose_setpoint(self, inputs: GuidanceInputs) -> Setpoint:
        """Return the setpoint after a light block, and update the mission."""
        sight, measured = inputs.sight, inputs.measured
        # Without a known energy the drone does not take off
        altitude = math.nan if measured is None or inputs.report is None else measured.altitude
        order = self.permission = decide_permission(inputs.reserve, inputs.report, inputs.stamp_ns)
        if self.course is not None:
            self._begun_ns = inputs.stamp_ns if self._begun_ns is None else self._begun_ns
            time = (inputs.stamp_ns - self._begun_ns) * 1e-9
            setpoint = course_step(self.course, time, sight.heading, altitude, order)
        else:
            setpoint, self.mission = mission_step(
                inputs.settings, inputs.strategy, self.mission, sight, altitude, order,
                max(len(self.route), 1), inputs.reserve.rule,
            )  # fmt: skip
        if self.route:
            self.beacon = self.route[self.mission.target][1]
        return setpoint
