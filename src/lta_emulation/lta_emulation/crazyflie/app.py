# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Emulate the app of firmware/crazyflie, version 3, which receives duties on the app channel."""

from typing import Final, final

from lta_bridge.crazyflie.duties_packet import DutiesPacket, is_newer, unpack_duties

APP_VERSION: Final = 3
FULL_RATIO: Final = 65535
IDLE_RATIO: Final = (
    1.0 / FULL_RATIO
)  # ratio of motor 1: above idle for the supervisor, too small to turn the motor
DISARM_DELAY: Final = 1.0  # s from the expiry of the last duties to disarming
LET_GO: Final = 0.5  # s more until it releases the commander
LONGEST_TIMEOUT: Final = 0.5  # s, upper limit of the time-out in a packet


@final
class MotorDutyApp:
    """
    State of the app.

    The firmware disarms a drone 2 s after its motors have stopped, since it then counts as landed.
    So while packets are valid and a motor has turned before, motor 1 gets the smallest ratio. With
    8 bits of PWM this does not turn it, but a coasting blimp still counts as flying.
    """

    def __init__(self) -> None:
        self._newest: DutiesPacket | None = None
        self._until = 0.0  # when the duties expire
        self._feeding = self._turned = False

    def receive_packet(self, data: bytes, now: float) -> None:
        """Receive a packet at a time [s]; ignore invalid and outdated ones."""
        duties = unpack_duties(data)
        if duties is None:
            return
        newest = self._newest
        # After a pause the sender may have restarted its sequence numbers
        ordered = newest is not None and now < self._until + DISARM_DELAY
        if ordered and newest and not is_newer(duties.sequence, newest.sequence):
            return
        self._newest, self._until = duties, now + min(duties.timeout_ms * 1e-3, LONGEST_TIMEOUT)
        self._feeding = True
        self._turned |= any(duty > 0.0 for duty in duties.duties)

    def has_valid_duties(self, now: float) -> bool:
        """Return whether the newest duties are valid at a time [s]."""
        return self._newest is not None and now < self._until

    def motor_duties(self, now: float) -> tuple[float, ...]:
        """Return the duties of M1 to M4 at a time [s]."""
        if self._newest is None or not self.has_valid_duties(now):
            return (0.0,) * 4
        # Brushed motors of the Crazyflie cannot reverse
        first, *others = (max(0.0, duty) for duty in self._newest.duties)
        return (max(first, IDLE_RATIO) if self._turned else first, *others)

    def is_renewing_setpoint(self) -> bool:
        """Return whether the app renews a zero-thrust setpoint now, which prevents the lock."""
        return self._feeding

    def requests_disarm(self, now: float) -> bool:
        """Return whether the app requests disarming at a time [s]."""
        return self._feeding and now >= self._until + DISARM_DELAY

    def release_if_due(self, now: float) -> bool:
        """Return True once when the app releases the commander [s]."""
        if not self._feeding or now < self._until + DISARM_DELAY + LET_GO:
            return False
        self._feeding = False
        return True

    def reset_after_disarming(self) -> None:
        """Reset after disarming."""
        self._turned = False
