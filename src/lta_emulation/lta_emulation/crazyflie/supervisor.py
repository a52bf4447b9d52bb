# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Emulate the supervisor of firmware 2026.08, which decides when the motors may turn.

States, transitions and times follow supervisor.c and supervisor_state_machine.c, and were verified
on the firmware as a Linux process. Not emulated: failing decks, motors that do not respond, and
the bits of the high-level commander.
"""

from collections.abc import Callable, Mapping
from enum import auto, Enum
from typing import Final, final, NamedTuple

from lta_bridge.crazyflie.supervisor_word import SupervisorBit

EVALUATION_PERIOD: Final = 0.04  # s between two evaluations
HYSTERESIS: Final = 2.0  # s with idle motors after which the drone counts as landed
LEVEL_OUT, SHUT_DOWN = 0.5, 2.0  # s, age of the low-level setpoint
WATCHDOG: Final = 1.0  # s since the newest message to the emergency-stop watchdog
TILTED, TILTED_TIME = 0.5, 1.0  # g upwards below which it is tilted; s until that counts
UPSIDE_DOWN, UPSIDE_DOWN_TIME = -0.2, 0.1  # g, s
FREE_FALL: Final = 0.1  # g on every axis
Acceleration = tuple[float, float, float]


class SupervisorState(Enum):
    """States of the supervisor."""

    CHECKS_NOT_PASSED = auto()
    CHECKS_PASSED = auto()
    ARMING = auto()
    READY = auto()
    FLYING = auto()
    LANDED = auto()
    RESET = auto()
    LEVEL_OUT = auto()
    FREE_FALL = auto()
    LOCKED = auto()
    CRASHED = auto()


class SupervisorConditions(NamedTuple):
    """Conditions of the transitions."""

    armed: bool
    flying: bool  # a motor was above idle within the last 2 s
    tumbled: bool
    crashed: bool
    stop: bool  # an emergency stop, or its watchdog
    old: bool  # the setpoint is older than 0.5 s
    too_old: bool  # the setpoint is older than 2 s
    preflight_over: bool
    landed_over: bool


Transition = tuple[Callable[[SupervisorConditions], bool], SupervisorState]
# The first matching transition is taken, one per evaluation.
TRANSITIONS: Final[Mapping[SupervisorState, tuple[Transition, ...]]] = {
    SupervisorState.CHECKS_NOT_PASSED: (
        (lambda c: c.stop, SupervisorState.FREE_FALL),
        (lambda c: not c.tumbled, SupervisorState.CHECKS_PASSED),
    ),
    SupervisorState.CHECKS_PASSED: (
        (lambda c: c.stop, SupervisorState.FREE_FALL),
        (lambda c: c.tumbled, SupervisorState.CHECKS_NOT_PASSED),
        (lambda c: c.armed, SupervisorState.ARMING),
    ),
    SupervisorState.ARMING: (
        (lambda c: c.stop, SupervisorState.FREE_FALL),
        (lambda c: c.tumbled or not c.armed, SupervisorState.CHECKS_NOT_PASSED),
        (lambda _: True, SupervisorState.READY),
    ),
    SupervisorState.READY: (
        (lambda c: c.stop, SupervisorState.FREE_FALL),
        (
            lambda c: c.tumbled or c.preflight_over or not c.armed,
            SupervisorState.CHECKS_NOT_PASSED,
        ),
        (lambda c: c.flying, SupervisorState.FLYING),
    ),
    SupervisorState.FLYING: (
        (lambda c: c.stop or c.too_old, SupervisorState.FREE_FALL),
        (lambda c: c.tumbled, SupervisorState.CRASHED),
        (lambda c: not c.armed, SupervisorState.RESET),
        (lambda c: c.old, SupervisorState.LEVEL_OUT),
        (lambda c: not c.flying, SupervisorState.LANDED),
    ),
    # Neither an emergency stop nor an old setpoint ends this one: its own time-out does.
    SupervisorState.LANDED: (
        (lambda c: c.landed_over or not c.armed, SupervisorState.RESET),
        (lambda c: c.flying, SupervisorState.FLYING),
    ),
    SupervisorState.RESET: ((lambda _: True, SupervisorState.CHECKS_NOT_PASSED),),
    # Nor does disarming end this one.
    SupervisorState.LEVEL_OUT: (
        (lambda c: c.stop or c.too_old or c.tumbled, SupervisorState.FREE_FALL),
        (lambda c: not c.old, SupervisorState.FLYING),
    ),
    SupervisorState.FREE_FALL: ((lambda _: True, SupervisorState.LOCKED),),
    SupervisorState.LOCKED: (),
    SupervisorState.CRASHED: (
        (lambda c: not c.crashed and not c.tumbled, SupervisorState.CHECKS_NOT_PASSED),
        (lambda c: c.stop, SupervisorState.LOCKED),
    ),
}
FLIES: Final = frozenset(
    {
        SupervisorState.READY,
        SupervisorState.FLYING,
        SupervisorState.LEVEL_OUT,
        SupervisorState.LANDED,
    }
)
RUNNING_STATES: Final = FLIES | {SupervisorState.ARMING}


@final
class TumbleDetector:
    """Detect tumbling by the duration of a tilt."""

    def __init__(self) -> None:
        self._since: float | None = None

    def detect_tumble(self, acceleration: Acceleration, now: float) -> bool:
        """Return whether it has tumbled, from the specific force [g] at a time [s]."""
        up = acceleration[2]
        # In free fall the direction of gravity is unknown, so the tilt restarts
        if up >= TILTED or all(abs(each) < FREE_FALL for each in acceleration):
            self._since = None
        if up >= TILTED:
            return False
        self._since = now if self._since is None else self._since
        tilted = now - self._since
        return tilted > TILTED_TIME or (up < UPSIDE_DOWN and tilted > UPSIDE_DOWN_TIME)


@final
class Supervisor:
    """
    State of the supervisor since the start of the firmware.

    Parameters
    ----------
    arms_itself : bool
        Whether the build arms automatically after its checks.

    Attributes
    ----------
    state : SupervisorState
        Current state.
    armed, tumbled, crashed : bool
        The respective bits of the status word.
    word : int
        Status word of the newest evaluation, as in `supervisor.info` and on port 9.
    landed_timeout, preflight_timeout : float
        Times after which it disarms automatically. [s]
    tumble_check : bool
        Whether being upside down counts as tumbled.

    """

    def __init__(self, arms_itself: bool = False) -> None:
        self._arms_itself = self.armed = arms_itself
        self.state = SupervisorState.CHECKS_PASSED
        self.tumbled = self.crashed = self._stop = False
        self.landed_timeout, self.preflight_timeout = 3.0, 30.0
        self.tumble_check = True
        self._tumble = TumbleDetector()
        self._due = 0.0
        self._since = 0.0  # when it entered the state
        self._turned_at: float | None = None
        self._fed_at: float | None = None
        self.word = self._status_word()

    @property
    def is_locked(self) -> bool:
        """Whether only a restart helps."""
        return self.state is SupervisorState.LOCKED

    @property
    def motors_enabled(self) -> bool:
        """Whether motors may turn."""
        return self.state in RUNNING_STATES

    @property
    def accepts_setpoints(self) -> bool:
        """Whether setpoints are flown; during arming they are not, and motors idle."""
        return self.state in FLIES

    def arm(self, on: bool) -> bool:
        """Arm or disarm; return whether that was done."""
        if on == self.armed:
            return True
        # Arming is possible only after the preflight checks; disarming always
        if on and self.state is not SupervisorState.CHECKS_PASSED:
            return False
        self.armed = on
        return True

    def recover(self) -> bool:
        """Leave the crashed state; return whether that was done."""
        if self.crashed and self.tumbled:
            return False
        self.crashed = False
        return True

    def stop(self) -> None:
        """Stop for good at the next evaluation."""
        self._stop = True

    def lock(self) -> None:
        """Lock at once, for tests."""
        self._enter_state(SupervisorState.LOCKED, self._since)
        self.word = self._status_word()

    def crash(self) -> None:
        """Crash at once, for tests."""
        self._enter_state(SupervisorState.CRASHED, self._since)
        self.word = self._status_word()

    def feed_watchdog(self, now: float) -> None:
        """Start or reset the emergency-stop watchdog at a time [s]."""
        self._fed_at = now

    def run_transitions(
        self, now: float, turning: bool, age: float | None, acceleration: Acceleration
    ) -> None:
        """
        Evaluate the transitions as often as is due.

        Parameters
        ----------
        now : float
            Time since boot. [s]
        turning : bool
            Whether a motor turns faster than at idle.
        age : float or None
            Age of the low-level setpoint; None without an active one. [s]
        acceleration : tuple of float
            Specific force on it. [g]

        """
        self._due = max(self._due, now - HYSTERESIS)  # skip evaluations missed longer ago
        while self._due <= now:
            self._due += EVALUATION_PERIOD
            self._evaluate_transition(now, turning, age or 0.0, acceleration)

    def _evaluate_transition(
        self, now: float, turning: bool, age: float, acceleration: Acceleration
    ) -> None:
        self._turned_at = now if turning else self._turned_at
        self.tumbled = self._tumble.detect_tumble(acceleration, now) and self.tumble_check
        late = self._fed_at is not None and now - self._fed_at >= WATCHDOG
        conditions = SupervisorConditions(
            armed=self.armed,
            flying=self._turned_at is not None and now - self._turned_at < HYSTERESIS,
            tumbled=self.tumbled,
            crashed=self.crashed,
            stop=self._stop or late,
            old=age > LEVEL_OUT,
            too_old=age > SHUT_DOWN,
            preflight_over=now - self._since > self.preflight_timeout,
            landed_over=now - self._since > self.landed_timeout,
        )
        # At most one transition per evaluation
        for applies, state in TRANSITIONS[self.state]:
            if applies(conditions):
                self._enter_state(state, now)
                break
        self.word = self._status_word()

    def _enter_state(self, state: SupervisorState, now: float) -> None:
        self.state, self._since = state, now
        # The flag stays set until `recover`
        self.crashed |= state is SupervisorState.CRASHED
        if state not in RUNNING_STATES:
            self.armed = self._arms_itself and state is SupervisorState.CHECKS_PASSED

    def _status_word(self) -> int:
        bits = {
            SupervisorBit.CAN_BE_ARMED: self.state is SupervisorState.CHECKS_PASSED,
            SupervisorBit.ARMED: self.armed,
            SupervisorBit.AUTO_ARM: self._arms_itself,
            SupervisorBit.CAN_FLY: self.accepts_setpoints,
            SupervisorBit.FLYING: self.state
            in (SupervisorState.FLYING, SupervisorState.LEVEL_OUT),
            SupervisorBit.TUMBLED: self.tumbled,
            SupervisorBit.LOCKED: self.is_locked,
            SupervisorBit.CRASHED: self.crashed,
        }
        return sum(bit for bit, on in bits.items() if on)
