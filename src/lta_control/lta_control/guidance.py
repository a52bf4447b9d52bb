# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Choose the setpoint after each light block, along the scenario's course or by the mission.

The navigator node and the one-process loop both decide with this class.
"""

from collections.abc import Callable, Sequence
from functools import wraps
import math
from typing import final, NamedTuple, TypeVar

from lta_config.course import Course
from lta_control.cascade import CascadeMeasurement, Setpoint
from lta_control.mission import course_step, mission_step, MissionSettings
from lta_control.odometry.tracked_motion import LocatedMotion
from lta_control.phases import Mission
from lta_control.reserve import (
    decide_permission,
    explain_restriction,
    FlightPermission,
    ReserveReport,
    ReserveResponseSettings,
)
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy
from lta_control.strategies.strategy_file import explain_failure
from lta_vlc.settings import ANY_BEACON

Chooser = TypeVar('Chooser')


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
