"""
What lets the motors turn: armed, flying, landed, locked.

Times are those of firmware 2026.08 (supervisor.c), seen on the firmware as a Linux process.
"""

from dataclasses import dataclass
from typing import final

from lta_bridge.crazyflie.supervisor import Bit

HYSTERESIS = 2.0  # s with the motors off after which it counts as landed
LEVEL_OUT, SHUT_DOWN = 0.5, 2.0  # s of age of a low-level setpoint
WATCHDOG = 1.0  # s after the newest word to the emergency-stop watchdog


@final
@dataclass(slots=True)
class Supervisor:
    """
    The supervisor's memory.

    Attributes
    ----------
    armed, locked, tumbled, crashed : bool
        As its word tells them.
    landed_timeout, preflight_timeout : float
        After which it disarms by itself. [s]

    """

    armed: bool = False
    locked: bool = False
    tumbled: bool = False
    crashed: bool = False
    landed_timeout: float = 3.0
    preflight_timeout: float = 30.0
    _armed_at: float = 0.0
    _turned_at: float | None = None
    _landed_at: float | None = None
    _fed_at: float | None = None

    @property
    def can_be_armed(self) -> bool:
        """Whether a request to arm succeeds."""
        return not (self.locked or self.tumbled or self.crashed or self.armed)

    @property
    def allows(self) -> bool:
        """Whether motors may turn."""
        return self.armed and not (self.locked or self.tumbled or self.crashed)

    def arm(self, on: bool, now: float) -> bool:
        """Arm or disarm at a time [s]; return whether that was done."""
        if on == self.armed:
            return True
        if on and not self.can_be_armed:
            return False
        self.armed = on
        self._armed_at, self._turned_at, self._landed_at = now, None, None
        return True

    def recover(self) -> bool:
        """Leave the crashed state."""
        self.crashed = self.crashed and self.tumbled
        return not self.crashed

    def lock(self) -> None:
        """Stop for good: only a reboot helps."""
        self.locked, self.armed = True, False

    def feed(self, now: float) -> None:
        """Start the emergency-stop watchdog at a time [s], or keep it quiet."""
        self._fed_at = now

    def flying(self, now: float) -> bool:
        """Tell whether a motor turned within two seconds before a time. [s]"""
        return self._turned_at is not None and now - self._turned_at < HYSTERESIS

    def watch(self, now: float, turning: bool, age: float | None, stopped: bool) -> None:
        """
        Look at the clock.

        Parameters
        ----------
        now : float
            Since the boot. [s]
        turning : bool
            Whether a motor turns.
        age : float or None
            Of the low-level setpoint; None where none is in force. [s]
        stopped : bool
            Whether that setpoint is a stop, which locks on the ground as well.

        """
        if self._fed_at is not None and now - self._fed_at > WATCHDOG:
            self.lock()
        if age is not None and age > SHUT_DOWN and (stopped or (self.armed and self.flying(now))):
            self.lock()
        if self.tumbled or self.crashed:
            self.armed = False
        if not self.armed:
            self._turned_at = None
            return
        if turning:
            self._turned_at, self._landed_at = now, None
        elif self._turned_at is None:
            if now - self._armed_at > self.preflight_timeout:
                self.armed = False
        elif not self.flying(now):
            landed = self._turned_at + HYSTERESIS
            self._landed_at = landed
            if now - landed > self.landed_timeout:
                self.armed = False

    def word(self, now: float) -> int:
        """Return the bits that `supervisor.info` and port 9 tell at a time. [s]"""
        told = {
            Bit.CAN_BE_ARMED: self.can_be_armed,
            Bit.ARMED: self.armed,
            Bit.CAN_FLY: self.allows,
            Bit.FLYING: self.armed and self.flying(now),
            Bit.TUMBLED: self.tumbled,
            Bit.LOCKED: self.locked,
            Bit.CRASHED: self.crashed,
        }
        return sum(bit for bit, on in told.items() if on)
