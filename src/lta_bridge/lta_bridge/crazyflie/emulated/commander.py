"""What the emulated Crazyflie is told: setpoints, landing, and duties over the app channel."""

import math
import struct
from typing import final, NamedTuple

from lta_bridge.crazyflie.duties_packet import Duties, is_newer, unpacked
from lta_bridge.crazyflie.emulated.supervisor import LEVEL_OUT

GENERIC = {
    # id: layout, and the sign of its yaw rate, which older packets count the other way
    5: ('<ffff', -1.0),
    10: ('<ffff', 1.0),
}
LAND = 8  # port 8, "land2"


class Hover(NamedTuple):
    """Body-fixed speeds [m/s], yaw rate [rad/s] and height [m]."""

    forward: float = 0.0
    left: float = 0.0
    yaw_rate: float = 0.0
    height: float = 0.0


class Wish(NamedTuple):
    """What the body shall do: duties of M1 to M4, or a hover, or come down; all None is rest."""

    duties: tuple[float, ...] | None = None
    hover: Hover | None = None
    land: bool = False


@final
class Commander:
    """The newest of everything that was said, and what is in force."""

    def __init__(self) -> None:
        self._hover: Hover | None = None
        self._stop = False
        self._said: float | None = None  # when the low-level setpoint in force came
        self._land = False
        self._duties: Duties | None = None
        self._until = 0.0
        self.thrust_packets = 0

    def generic(self, channel: int, data: bytes, now: float) -> None:
        """Take a packet of port 7 at a time [s]: a setpoint, or that no more will come."""
        if channel == 1 and data[:1] == b'\0':
            self._said, self._hover, self._stop = None, None, False
            return
        if channel != 0 or not data:
            return
        if data[0] == 0:
            self._hover, self._stop, self._said, self._land = None, True, now, False
        elif data[0] in GENERIC:
            layout, sign = GENERIC[data[0]]
            if len(data) != 1 + struct.calcsize(layout):
                return
            forward, left, yaw, height = struct.unpack(layout, data[1:])
            if all(map(math.isfinite, (forward, left, yaw, height))):
                self._hover = Hover(forward, left, math.radians(sign * yaw), height)
                self._stop, self._said, self._land = False, now, False

    def attitude(self, now: float) -> None:
        """Take a packet of roll, pitch, yaw rate and thrust at a time [s]: its stop is flown."""
        self.thrust_packets += 1
        self._hover, self._stop, self._said, self._land = None, False, now, False

    def high_level(self, data: bytes) -> bytes:
        """Take a packet of port 8; return the answer."""
        known = data[:1] == bytes([LAND])
        self._land = known and self._said is None
        return (data[:3] + b'\0\0\0')[:3] + (b'\0' if known else b'\x08')

    def app(self, data: bytes, now: float) -> None:
        """Take a packet of the app channel at a time [s], as the app aboard does."""
        duties = unpacked(data)
        if duties is None:
            return
        stale = self._duties is not None and now < self._until
        if stale and self._duties and not is_newer(duties.sequence, self._duties.sequence):
            return
        self._duties, self._until = duties, now + duties.timeout_ms * 1e-3

    def age(self, now: float) -> float | None:
        """
        Return the age of the low-level setpoint in force; None without one. [s]

        The app feeds the commander while its duties hold, and lets go when they do not.
        """
        if self.driven(now) or self._said is None:
            return None
        return now - self._said

    @property
    def stopped(self) -> bool:
        """Whether the setpoint in force is a stop."""
        return self._stop

    def driven(self, now: float) -> bool:
        """Tell whether duties of the app channel hold at a time. [s]"""
        return self._duties is not None and now < self._until

    def wish(self, now: float) -> Wish:
        """Return what is in force at a time. [s]"""
        if self.driven(now) and self._duties is not None:
            return Wish(duties=self._duties.duties)
        if self._said is not None:
            hover = self._hover
            if hover is not None and now - self._said > LEVEL_OUT:
                hover = Hover(height=hover.height)
            return Wish(hover=hover)
        return Wish(land=self._land)
