"""What the emulated Crazyflie is told: setpoints, and to land."""

from collections.abc import Mapping
import errno
import math
import struct
from typing import Final, final, NamedTuple

# Port 7, by their id: layout of the setpoints whose length the firmware asserts
# (crtp_commander_generic.c). A stop (0) and a position (7) may have any.
LAYOUTS: Final[Mapping[int, str]] = {
    1: '<ffff', 2: '<ffff', 4: '<ffff', 5: '<ffff', 6: '<9hi3h', 8: '<ffff', 9: '<ffff',
    10: '<ffff', 11: '<fffHB',
}  # fmt: skip
CPPM = 3  # whose length its first byte tells
YAW_SIGN: Final[Mapping[int, float]] = {5: -1.0, 10: 1.0}  # the hovers; older ones count it so
NOTIFY, NOTIFIED = 0, 4  # port 7, channel 1: no more setpoints come; bytes of its argument
LAND = 8  # port 8, "land2"
LAST = 13  # of the commands of port 8
UNBLOCKED: Final = (0, 3, 6)  # of these, what may be asked for while nothing flies


class FirmwareAssertion(Exception):
    """The firmware asserts that this packet is otherwise: it stops its motors and starts anew."""


class HoverSetpoint(NamedTuple):
    """Body-fixed speeds [m/s], yaw rate [rad/s] and height [m]."""

    forward: float = 0.0
    left: float = 0.0
    yaw_rate: float = 0.0
    height: float = 0.0


class BodyCommand(NamedTuple):
    """
    What the body shall do: duties of M1 to M4, or a hover, or come down; none of them is rest.

    `idle` is the least duty of every motor.
    """

    duties: tuple[float, ...] | None = None
    hover: HoverSetpoint | None = None
    land: bool = False
    idle: float = 0.0


def check_length(data: bytes, size: int) -> None:
    """
    Look at the length of a setpoint of port 7 as the firmware does.

    Raises
    ------
    Asserted
        If it is wrong.

    """
    wanted = None
    if size and data[0] in LAYOUTS:
        wanted = 1 + struct.calcsize(LAYOUTS[data[0]])
    elif size and data[0] == CPPM:
        wanted = 10 + 2 * (data[1] & 0x0F)
    if not size or wanted not in (None, size):
        raise FirmwareAssertion


@final
class Commander:
    """
    The newest of everything that was said, and what is in force.

    Of the setpoints only a hover is flown; any other is in force without thrust, since no bridge
    of ours sends one.
    """

    def __init__(self) -> None:
        self._hover: HoverSetpoint | None = None
        self._said: float | None = None  # when the low-level setpoint in force came
        self._land = False
        self.thrust_packets = 0

    def receive_generic(self, channel: int, data: bytes, size: int, now: float) -> None:
        """
        Take a packet of port 7 at a time [s]: a setpoint, or that no more will come.

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
        """Return a hover; None for anything else, and for one that is no number."""
        if data[0] not in YAW_SIGN:
            return None
        forward, left, yaw, height = struct.unpack_from('<ffff', data, 1)
        if not all(map(math.isfinite, (forward, left, yaw, height))):
            return None
        return HoverSetpoint(forward, left, math.radians(YAW_SIGN[data[0]] * yaw), height)

    def _set_hover(self, hover: HoverSetpoint | None, now: float) -> None:
        self._hover, self._said, self._land = hover, now, False

    def receive_attitude(self, now: float) -> None:
        """Take a packet of roll, pitch, yaw rate and thrust at a time. [s]"""
        self.thrust_packets += 1
        self._set_hover(None, now)

    def set_zero_thrust(self, now: float) -> None:
        """Take a setpoint without thrust from aboard, at a time. [s]"""
        self._set_hover(None, now)

    def release_setpoint(self) -> None:
        """Let go of the low-level setpoint."""
        self._said, self._hover = None, None

    def answer_high_level(self, data: bytes, blocked: bool) -> bytes:
        """Take a packet of port 8, which may be blocked; return the answer."""
        command, group = data[0], data[1]
        status = 0
        if command > LAST:
            status = errno.ENOEXEC
        elif blocked and command not in UNBLOCKED:
            status = errno.EBUSY
        elif command == LAND and group == 0:
            self._land = self._said is None
        return data[:3] + bytes([status])

    def setpoint_age(self, now: float) -> float | None:
        """Return the age of the low-level setpoint in force; None without one. [s]"""
        return None if self._said is None else now - self._said

    def select_command(self, level: bool) -> BodyCommand:
        """Return what is in force; where it levels out, only the height of a hover is."""
        if self._said is None:
            return BodyCommand(land=self._land)
        if level and self._hover is not None:
            return BodyCommand(hover=HoverSetpoint(height=self._hover.height))
        return BodyCommand(hover=self._hover)
