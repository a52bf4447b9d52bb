# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Emulate the commander, which receives setpoints and landing commands."""

from collections.abc import Mapping
import errno
import math
import struct
from typing import Final, final, NamedTuple, Protocol

# Port 7, by their id: layout of the setpoints whose length the firmware asserts
# (crtp_commander_generic.c). A stop (0) and a position (7) may have any.
LAYOUTS: Final[Mapping[int, str]] = {
    1: '<ffff', 2: '<ffff', 4: '<ffff', 5: '<ffff', 6: '<9hi3h', 8: '<ffff', 9: '<ffff',
    10: '<ffff', 11: '<fffHB',
}  # fmt: skip
CPPM = 3  # setpoint whose first byte determines its length
YAW_SIGN: Final[Mapping[int, float]] = {
    5: -1.0,
    10: 1.0,
}  # hover setpoints; the older one has the opposite sign
NOTIFY, NOTIFIED = 0, 4  # port 7, channel 1: no more setpoints follow; size of its argument
LAND = 8  # port 8, "land2"
LAST = 13  # last command number of port 8
UNBLOCKED: Final = (0, 3, 6)  # commands of port 8 that are allowed when not flying


class FirmwareAssertion(Exception):
    """The firmware fails an assertion on this packet: it stops its motors and restarts."""


class HoverSetpoint(NamedTuple):
    """Body-fixed speeds [m/s], yaw rate [rad/s] and height [m]."""

    forward: float = 0.0
    left: float = 0.0
    yaw_rate: float = 0.0
    height: float = 0.0


class BodyCommand(NamedTuple):
    """
    Command of a body: duties of M1 to M4, a hover, or a landing; none of them means rest.

    `idle` is the smallest duty of every motor.
    """

    duties: tuple[float, ...] | None = None
    hover: HoverSetpoint | None = None
    land: bool = False
    idle: float = 0.0


def check_length(data: bytes, size: int) -> None:
    """
    Check the length of a setpoint of port 7, as the firmware does.

    Raises
    ------
    Asserted
        If it is wrong.

    """
    expected = None
    if size and data[0] in LAYOUTS:
        expected = 1 + struct.calcsize(LAYOUTS[data[0]])
    elif size and data[0] == CPPM:
        # Number of auxiliary channels in the low nibble, two bytes each
        expected = 10 + 2 * (data[1] & 0x0F)
    if not size or expected not in (None, size):
        raise FirmwareAssertion


@final
class Commander:
    """
    Store the newest commands and select the active one.

    Only hover setpoints are flown. Any other setpoint is active without thrust, since LTA's bridge
    sends none.
    """

    def __init__(self) -> None:
        self._hover: HoverSetpoint | None = None
        self._received_at: float | None = None  # arrival of the active low-level setpoint
        self._land = False

    def receive_generic_setpoint(self, channel: int, data: bytes, size: int, now: float) -> None:
        """
        Receive a packet of port 7 at a time [s]: a setpoint, or the end of setpoints.

        Raises
        ------
        Asserted
            If its length is wrong.

        """
        if channel == 1 and data[0] == NOTIFY:
            if size != 1 + NOTIFIED:
                raise FirmwareAssertion
            self.release_setpoint()
        elif channel == 0:
            check_length(data, size)
            self._set_hover(self._parse_hover(data), now)

    @staticmethod
    def _parse_hover(data: bytes) -> HoverSetpoint | None:
        """Return a hover; None for any other setpoint or values that are not finite."""
        if data[0] not in YAW_SIGN:
            return None
        forward, left, yaw, height = struct.unpack_from('<ffff', data, 1)
        if not all(map(math.isfinite, (forward, left, yaw, height))):
            return None
        # The packet has the yaw rate in deg/s
        return HoverSetpoint(forward, left, math.radians(YAW_SIGN[data[0]] * yaw), height)

    def _set_hover(self, hover: HoverSetpoint | None, now: float) -> None:
        self._hover, self._received_at, self._land = hover, now, False

    def receive_attitude(self, now: float) -> None:
        """Receive a packet of roll, pitch, yaw rate and thrust at a time [s]."""
        self._set_hover(None, now)

    def set_zero_thrust(self, now: float) -> None:
        """Set a zero-thrust setpoint from the app at a time [s]."""
        self._set_hover(None, now)

    def release_setpoint(self) -> None:
        """Release the low-level setpoint."""
        self._received_at, self._hover = None, None

    def answer_high_level(self, data: bytes, blocked: bool) -> bytes:
        """Receive a packet of port 8, which may be blocked; return the answer."""
        command, group = data[0], data[1]
        status = 0
        if command > LAST:
            status = errno.ENOEXEC
        elif blocked and command not in UNBLOCKED:
            status = errno.EBUSY
        elif command == LAND and group == 0:
            # An active low-level setpoint has priority over the high-level commander
            self._land = self._received_at is None
        return data[:3] + bytes([status])

    def setpoint_age(self, now: float) -> float | None:
        """Return the age of the active low-level setpoint; None without one [s]."""
        return None if self._received_at is None else now - self._received_at

    def select_command(self, level: bool) -> BodyCommand:
        """Return the active command; when levelling out, only the height of a hover."""
        if self._received_at is None:
            return BodyCommand(land=self._land)
        if level and self._hover is not None:
            return BodyCommand(hover=HoverSetpoint(height=self._hover.height))
        return BodyCommand(hover=self._hover)


STOPPED_DUTIES = (0.0, 0.0, 0.0, 0.0)


class CrazyflieBody(Protocol):
    """A body with motors and sensors."""

    @property
    def duties(self) -> tuple[float, ...]:
        """Present duty of M1 to M4, 0 to 1."""
        ...

    def advance(self, now: float, wish: BodyCommand) -> None:
        """Advance to a time since boot under a command [s]."""
        ...

    def read_log_values(self) -> Mapping[str, float]:
        """Return the newest values of log variables, in the firmware's units."""
        ...
