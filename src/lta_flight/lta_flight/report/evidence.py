"""What the results of a flight are drawn from: a recording, or a flight in this process."""

from typing import Protocol

from lta_data.bag.flight import Points
from lta_data.scene import Scene
from lta_flight.report.goal import Goal
from lta_report.curves import Arrow, Electricity, Motion, Track


class Evidence(Protocol):
    """A flight as `View` tells it; `has` says which of it there is."""

    def has(self, *topics: str) -> bool:
        """Tell whether there is something of all these topics."""
        ...

    @property
    def scene(self) -> Scene:
        """The world of the flight."""
        ...

    @property
    def span(self) -> tuple[float, float]:
        """First and last instant of the motion. [s]"""
        ...

    @property
    def goal(self) -> Goal:
        """The lamps to be reached, and when each was."""
        ...

    @property
    def truth(self) -> Motion:
        """The true motion."""
        ...

    @property
    def estimate(self) -> Motion:
        """The drone's own idea of its motion."""
        ...

    @property
    def altitude_setpoint(self) -> Track:
        """Altitude to hold. [m]"""
        ...

    @property
    def speed_setpoint(self) -> Track:
        """Forward airspeed to hold. [m/s]"""
        ...

    @property
    def peaks(self) -> Points:
        """SNR and frequency of each diode's peak, at the middle of its block."""
        ...

    @property
    def sighting(self) -> Arrow:
        """Direction to the lamp that the drone steers by, at the middle of its block."""
        ...

    @property
    def bearing(self) -> Arrow:
        """The paper's direction to the lamp, at the middle of its block."""
        ...

    @property
    def battery(self) -> Electricity:
        """The cell as measured."""
        ...
