"""
Choose the setpoint after each light block, along the scenario's course or by the mission.

The navigator node and the one-process loop both decide with this class.
"""

from collections.abc import Sequence
import math
from typing import final

from lta_config.course import Course
from lta_control.cascade import CascadeMeasurement, Setpoint
from lta_control.mission import course_step, mission_step, MissionSettings
from lta_control.phases import Mission
from lta_control.reserve import (
    decide_permission,
    FlightPermission,
    ReserveReport,
    ReserveResponseSettings,
)
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy
from lta_vlc.settings import NO_WISH


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
        self.beacon = NO_WISH
        self._course, self._route = course, route
        self._begun_ns: int | None = None

    def choose_setpoint(
        self,
        settings: MissionSettings,
        reserve: ReserveResponseSettings,
        strategy: NavigationStrategy,
        stamp_ns: int,
        sight: LightMeasurement,
        measured: CascadeMeasurement | None,
        report: ReserveReport | None,
    ) -> Setpoint:
        """
        Return the setpoint after a light block, and update the mission.

        Parameters
        ----------
        stamp_ns : int
            Stamp of the block; a course counts from the first one. [ns]
        sight : LightMeasurement
            The light of the block.
        measured : CascadeMeasurement or None
            The drone's motion; None while the estimator calibrates.
        report : ReserveReport or None
            The latest report of the energy monitor.

        """
        # Without a known energy the drone does not take off
        altitude = math.nan if measured is None or report is None else measured.altitude
        order = self.permission = decide_permission(reserve, report, stamp_ns)
        if self._course is not None:
            self._begun_ns = stamp_ns if self._begun_ns is None else self._begun_ns
            time = (stamp_ns - self._begun_ns) * 1e-9
            setpoint = course_step(self._course, time, sight.heading, altitude, order)
        else:
            setpoint, self.mission = mission_step(
                settings, strategy, self.mission, sight, altitude, order,
                max(len(self._route), 1), reserve.rule,
            )  # fmt: skip
        if self._route:
            self.beacon = self._route[self.mission.asked][1]
        return setpoint
