"""What a bridge needs of a link to a Crazyflie, and what a link tells; no library named."""

from collections.abc import Mapping, Sequence
from queue import SimpleQueue
from typing import NamedTuple, Protocol

OLDEST = 9  # protocol: the first with today's setpoint packets (cflib, commander.py)


class LogPacket(NamedTuple):
    """Block name, stamp of 24 bits [ms], values by `group.name`, arrival in graph time [ns]."""

    block: str
    stamp_ms: int
    values: Mapping[str, float]
    arrival_ns: int


class Ping(NamedTuple):
    """What one way to the drone and back took. [s]"""

    round_trip: float


class MalformedPacket(NamedTuple):
    """A packet came that cannot be read, and why."""

    why: str


class LinkLost(NamedTuple):
    """The link is gone, and why."""

    why: str


Event = LogPacket | Ping | MalformedPacket | LinkLost


class LinkFailed(RuntimeError):
    """A link did not come up, or a parameter did not do as told; worth another try."""


class CrazyflieLink(Protocol):
    """
    One connection at a time; `open` and `close` block and are called from one thread.

    Attributes
    ----------
    events : SimpleQueue of Event
        What it tells, from whatever thread.
    protocol : int
        The firmware's version of CRTP; -1 while unknown.

    """

    events: SimpleQueue[Event]
    protocol: int

    def open(self, deadline: float) -> None:
        """Connect, and ask for all log blocks; `LinkFailed` after a deadline. [s]"""
        ...

    def close(self) -> None:
        """Disconnect; nothing is sent afterwards."""
        ...

    def read_parameter(self, name: str) -> float | None:
        """Return a parameter in the firmware's unit; None where it has none of that name."""
        ...

    def write_parameter(self, name: str, value: float, deadline: float) -> None:
        """Set a parameter, confirmed by the Crazyflie's own word; `LinkFailed` otherwise. [s]"""
        ...

    def request_arming(self, on: bool) -> None:
        """Ask to arm or disarm."""
        ...

    def send_emergency_stop(self) -> None:
        """Send one emergency stop."""
        ...

    def feed_watchdog(self) -> None:
        """Keep the firmware's emergency-stop watchdog quiet; the first word starts it."""
        ...

    def send_hover_setpoint(self, forward: float, yaw_rate: float, height: float) -> None:
        """Send a speed [m/s], yaw rate [rad/s] and height [m]."""
        ...

    def send_duties(self, payload: bytes) -> None:
        """Send a packet to the app aboard."""
        ...

    def override_motors(self, duties: Sequence[float]) -> None:
        """Turn M1 to M4 by duties 0 to 1 whatever the supervisor says; none lets go of them."""
        ...

    def hand_over(self, land: bool) -> None:
        """Say that no more setpoints come; where asked, land."""
        ...
