"""The app of firmware/crazyflie, version 2: duties over the app channel, and what follows them."""

from typing import Final, final

from lta_bridge.crazyflie.duties_packet import DutiesPacket, is_newer, unpack_duties

VERSION: Final = 2
FULL_RATIO: Final = 65535
STEP: Final = 1.0 / FULL_RATIO  # of motor 1: over idle to the supervisor, nothing to the motor
REST: Final = 1.0  # s after the last duties have held until it disarms the drone
LET_GO: Final = 0.5  # s more until it lets go of the commander
MOST: Final = 0.5  # s that duties hold at most, whatever their packet asks for


@final
class DutiesApp:
    """
    What the app remembers.

    A drone whose motors stand counts as landed 2 s later and is disarmed. So while packets hold,
    and a motor has turned before, motor 1 gets the least ratio there is: it turns nothing, since
    the PWM has 8 bits, and a coasting blimp counts as flying.
    """

    def __init__(self) -> None:
        self._newest: DutiesPacket | None = None
        self._until = 0.0  # when they hold no longer
        self._feeding = self._turned = False

    def receive_packet(self, data: bytes, now: float) -> None:
        """Take a packet at a time [s]; one that is no duties, or older than the last, is none."""
        duties = unpack_duties(data)
        if duties is None:
            return
        newest = self._newest
        ordered = newest is not None and now < self._until + REST
        if ordered and newest and not is_newer(duties.sequence, newest.sequence):
            return
        self._newest, self._until = duties, now + min(duties.timeout_ms * 1e-3, MOST)
        self._feeding = True
        self._turned |= any(duty > 0.0 for duty in duties.duties)

    def is_current(self, now: float) -> bool:
        """Tell whether the newest duties hold at a time. [s]"""
        return self._newest is not None and now < self._until

    def current_duties(self, now: float) -> tuple[float, ...]:
        """Return the duties of M1 to M4 at a time. [s]"""
        if self._newest is None or not self.is_current(now):
            return (0.0,) * 4
        first, *others = (max(0.0, duty) for duty in self._newest.duties)
        return (max(first, STEP) if self._turned else first, *others)

    def is_feeding(self) -> bool:
        """Tell whether the app renews a setpoint without thrust now, which keeps the lock away."""
        return self._feeding

    def requests_disarm(self, now: float) -> bool:
        """Tell whether the app asks the supervisor to disarm at a time. [s]"""
        return self._feeding and now >= self._until + REST

    def take_release(self, now: float) -> bool:
        """Tell, once, that the app lets go of the commander. [s]"""
        if not self._feeding or now < self._until + REST + LET_GO:
            return False
        self._feeding = False
        return True

    def forget_turning(self) -> None:
        """Forget that a motor turned: nobody is armed."""
        self._turned = False
