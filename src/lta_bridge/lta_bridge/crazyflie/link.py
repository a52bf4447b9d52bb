# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Interface of a link to a Crazyflie and the events that it reports, for any library."""

from collections.abc import Mapping
from queue import SimpleQueue
from typing import NamedTuple, Protocol

OLDEST = 9  # protocol: the first with today's setpoint packets (cflib, commander.py)


class LogPacket(NamedTuple):
    """Block name, 24-bit stamp [ms], values by `group.name`, graph time of arrival [ns]."""

    block: str
    stamp_ms: int
    values: Mapping[str, float]
    arrival_ns: int


class Ping(NamedTuple):
    """Round-trip time of one ping [s]."""

    round_trip: float


class MalformedPacket(NamedTuple):
    """A packet could not be read; `why` is the reason."""

    why: str


class LinkLost(NamedTuple):
    """The link was lost; `why` is the reason."""

    why: str


Event = LogPacket | Ping | MalformedPacket | LinkLost


class LinkFailed(RuntimeError):
    """Connecting failed, or a parameter could not be set; another attempt may succeed."""


class CrazyflieLink(Protocol):
    """
    A link with one connection at a time.

    `open` and `close` block and must be called from the same thread.

    Attributes
    ----------
    events : SimpleQueue of Event
        Filled from any thread.
    protocol : int
        Version of the firmware's CRTP; -1 while unknown.

    """

    events: SimpleQueue[Event]
    protocol: int

    def open(self, deadline: float) -> None:
        """Connect and start all log blocks; raise `LinkFailed` after a time [s]."""
        ...

    def close(self) -> None:
        """Disconnect; nothing is sent afterwards."""
        ...

    def read_parameter(self, name: str) -> float | None:
        """Return a parameter in the firmware's unit; None if the firmware lacks it."""
        ...

    def write_parameter(self, name: str, value: float, deadline: float) -> None:
        """Set a parameter; raise `LinkFailed` if it is not confirmed within a time [s]."""
        ...

    def request_arming(self, on: bool) -> None:
        """Request arming or disarming."""
        ...

    def send_emergency_stop(self) -> None:
        """Send one emergency stop."""
        ...

    def feed_watchdog(self) -> None:
        """Reset the firmware's emergency-stop watchdog; the first call starts it."""
        ...

    def send_hover_setpoint(self, forward: float, yaw_rate: float, height: float) -> None:
        """Send a speed [m/s], yaw rate [rad/s] and height [m]."""
        ...

    def send_duties(self, payload: bytes) -> None:
        """Send a packet to the app on the drone."""
        ...

    def hand_over(self, land: bool) -> None:
        """Announce that no more setpoints follow; land if requested."""
        ...
