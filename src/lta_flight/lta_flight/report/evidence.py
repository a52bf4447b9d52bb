"""What the results of a flight are drawn from: a recording, or a flight in this process."""

from typing import Protocol

from lta_data.bag.recorded_flight import PointSeries
from lta_data.scene import RecordedScene
from lta_flight.report.goal import FlightGoal
from lta_report.curves import DirectionCurve, ElectricalCurve, MotionCurve, TimeCurve


class FlightEvidence(Protocol):
    """A flight as `View` tells it; `has_topics` says which of it there is."""

    def has_topics(self, *topics: str) -> bool:
        """Tell whether there is something of all these topics."""
        ...

    @property
    def scene(self) -> RecordedScene:
        """The world of the flight."""
        ...

    @property
    def span(self) -> tuple[float, float]:
        """First and last instant of the motion. [s]"""
        ...

    @property
    def goal(self) -> FlightGoal:
        """The lamps to be reached, and when each was."""
        ...

    @property
    def truth(self) -> MotionCurve:
        """The true motion."""
        ...

    @property
    def estimate(self) -> MotionCurve:
        """The drone's own idea of its motion."""
        ...

    @property
    def altitude_setpoint(self) -> TimeCurve:
        """Altitude to hold. [m]"""
        ...

    @property
    def speed_setpoint(self) -> TimeCurve:
        """Forward airspeed to hold. [m/s]"""
        ...

    @property
    def peaks(self) -> PointSeries:
        """SNR and frequency of each diode's peak, at the middle of its block."""
        ...

    @property
    def sighting(self) -> DirectionCurve:
        """Direction to the lamp that the drone steers by, at the middle of its block."""
        ...

    @property
    def bearing(self) -> DirectionCurve:
        """The paper's direction to the lamp, at the middle of its block."""
        ...

    @property
    def battery(self) -> ElectricalCurve:
        """The cell as measured."""
        ...
