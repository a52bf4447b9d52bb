"""The data that the results of a flight need, from a recording or a simulation."""

from typing import Protocol

from lta_data.bag.recorded_flight import PointSeries
from lta_data.scene import RecordedScene
from lta_flight.report.goal import FlightGoal
from lta_report.curves import DirectionCurve, ElectricalCurve, MotionCurve, TimeCurve


class FlightDataSource(Protocol):
    """Data of a flight as in `FlightView`; `has_topics` reports what is available."""

    def has_topics(self, *topics: str) -> bool:
        """Return whether all these topics have data."""
        ...

    @property
    def scene(self) -> RecordedScene:
        """The world of the flight."""
        ...

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of the motion. [s]"""
        ...

    @property
    def goal(self) -> FlightGoal:
        """The target lamps, and when each was reached."""
        ...

    @property
    def truth(self) -> MotionCurve:
        """The true motion."""
        ...

    @property
    def estimate(self) -> MotionCurve:
        """The motion that the drone estimated."""
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
        """SNR and frequency of each diode's peak, at the middle of each block."""
        ...

    @property
    def sighting(self) -> DirectionCurve:
        """Direction to the lamp that the drone steers by, at the middle of each block."""
        ...

    @property
    def bearing(self) -> DirectionCurve:
        """The paper's bearing of the lamp, at the middle of each block."""
        ...

    @property
    def battery(self) -> ElectricalCurve:
        """The battery as measured."""
        ...
