# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A flight that calibrates a vehicle: its sticks, as a pilot would move them, and how it is flown.

A flight has pieces, each of which begins at rest. The first ones move one stick: what the vehicle
does then is due to one axis. In the others all sticks change every second or two, each by itself,
so that nothing that they cause together looks alike. Between the pieces the drone returns.
"""

from collections.abc import Callable, Generator, Iterator
import math
import time
from typing import Final, final, NamedTuple

from lta_bridge.parameters import PilotSettings
from lta_bridge.teleop.sticks import Sticks
from lta_control.odometry.tracked_motion import TrackedMotion
import numpy as np

REST_BEFORE_PIECE: Final = 1.0  # s before a piece
STICK_STEPS: Final = (  # sticks of the first pieces, each with the time for which it is held [s]
    ((Sticks(forward=1.0), 6.0), (Sticks(), 2.0)),
    ((Sticks(turn=1.0), 4.0), (Sticks(turn=-1.0), 4.0)),
    ((Sticks(climb=1.0), 3.0), (Sticks(climb=-1.0), 3.0)),
)
MIXED_PIECE: Final = 12.0  # s of mixed sticks, after which the drone has drifted off
# s for which a stick is held, and chance that it changes then; it is so held for 1.6 s on average
STICK_HOLD, CHANGE_CHANCE = 0.8, 0.5
# A blimp that flies backward turns about by itself, so the forward stick is never pulled
AHEAD_LEVELS: Final = (0.0, 0.5, 1.0)
LEVELS_BOTH_WAYS: Final = (-1.0, -0.5, 0.0, 0.5, 1.0)
HIGHEST_RISE: Final = 0.5  # m above or below the height of the place, within which sticks climb

# s without a tracked pose after which the flight ends; the navigator's own limit is 2 s
LONGEST_TRACKER_GAP: Final = 1.0
COASTING_TIME: Final = 8.0  # s for which a blimp flies on, as it has to turn about to brake
HANDOVER_PATIENCE: Final = 10.0  # wall s in which teleop takes the sticks, or hands them back
# The steps of a flight; they return why it cannot go on, or ''
Steps = Generator[None, None, str]


class StickHold(NamedTuple):
    """Sticks, and the time for which they are held [s]."""

    sticks: Sticks
    seconds: float


def plan_pieces(seconds: float, seed: int) -> Iterator[tuple[StickHold, ...]]:
    """
    Yield the pieces of a flight.

    `seconds`: sum of their times; the last one is shorter. `seed`: of the mixed sticks.
    """
    draw = np.random.default_rng(seed)
    steps = iter(STICK_STEPS)
    while seconds > 0.0:
        piece = [StickHold(Sticks(), REST_BEFORE_PIECE)]
        piece += [StickHold(*each) for each in next(steps, ())] or _mix_sticks(draw)
        yield tuple(shorten_piece(piece, seconds))
        seconds -= sum(hold.seconds for hold in piece)


def _mix_sticks(draw: np.random.Generator) -> list[StickHold]:
    """Return a piece in which each stick changes by itself."""
    now = {'forward': 0.0, 'turn': 0.0, 'climb': 0.0}
    levels = {'forward': AHEAD_LEVELS, 'turn': LEVELS_BOTH_WAYS, 'climb': LEVELS_BOTH_WAYS}
    holds = []
    for _ in range(round(MIXED_PIECE / STICK_HOLD)):
        for stick in now:
            if draw.random() < CHANGE_CHANCE:
                now[stick] = float(draw.choice(levels[stick]))
        holds.append(StickHold(Sticks(now['forward'], now['turn'], now['climb']), STICK_HOLD))
    return holds


def shorten_piece(piece: list[StickHold], seconds: float) -> Iterator[StickHold]:
    """Yield the part of a piece that takes at most so many seconds."""
    for hold in piece:
        if seconds <= 0.0:
            return
        yield hold._replace(seconds=min(hold.seconds, seconds))
        seconds -= hold.seconds


def limit_climb(sticks: Sticks, above: float) -> Sticks:
    """Return sticks that do not climb or sink further from the height of the place [m]."""
    is_far = abs(above) > HIGHEST_RISE and math.copysign(1.0, above) * sticks.climb > 0.0
    return sticks._replace(climb=0.0) if is_far else sticks


@final
class StickFlight:
    """
    Fly the pieces at a place, with the navigator's help between them.

    Parameters
    ----------
    settings : PilotSettings
        The place, and the sum of the pieces' times.
    command : callable
        Fly by the action of a name to its end.
    tell : callable
        Report what the drone does next.

    Attributes
    ----------
    sticks : Sticks
        What to send to teleop now.
    held : bool
        Whether teleop follows the sticks.

    """

    def __init__(
        self,
        settings: PilotSettings,
        command: Callable[[str], Steps],
        tell: Callable[[str], None],
    ) -> None:
        self._settings, self._command, self._tell = settings, command, tell
        self.sticks, self.held = Sticks(), False
        self._tracked: TrackedMotion | None = None
        self._above = 0.0  # height above the place [m]
        self._tracked_at = -math.inf

    def receive_tracking(self, tracked: TrackedMotion, height: float) -> None:
        """Take a pose by the tracker, and the height of the hull centre [m]."""
        self._tracked, self._tracked_at = tracked, time.monotonic()
        self._above = height - self._settings.height

    def fly(self) -> Steps:
        """Fly all pieces and land, also where one of them fails."""
        failure = yield from self._command('take_off')
        failure = failure or (yield from self._command('go_to_pose'))
        for piece in plan_pieces(self._settings.seconds, self._settings.seed):
            if failure:
                break
            failure = yield from self._move_sticks(piece)
            failure = failure or (yield from self._command('go_to_pose'))
        back = yield from self._hand_back()
        landing = yield from self._command('land')
        return failure or back or landing

    def _move_sticks(self, piece: tuple[StickHold, ...]) -> Steps:
        """Fly a piece until its end, or until the drone leaves the room, and hand it back."""
        self._tell(f'sticks move for {sum(hold.seconds for hold in piece):.0f} s')
        since = time.monotonic()
        self.sticks = Sticks(take=True)
        while not self.held:
            if time.monotonic() - since > HANDOVER_PATIENCE:
                return 'teleop does not follow the sticks'
            yield
        for sticks, seconds in piece:
            until = time.monotonic() + seconds
            while time.monotonic() < until:
                if self._tracked is None or (
                    time.monotonic() - self._tracked_at > LONGEST_TRACKER_GAP
                ):
                    return 'the tracker is lost'
                if self._could_leave(self._tracked):
                    return (yield from self._hand_back())
                self.sticks = limit_climb(sticks, self._above)
                yield
        return (yield from self._hand_back())

    def _could_leave(self, tracked: TrackedMotion) -> bool:
        """Return whether the drone could coast out of the room."""
        (x, y), (u, v) = tracked.position, tracked.velocity
        away = x + COASTING_TIME * u - self._settings.x, y + COASTING_TIME * v - self._settings.y
        return math.hypot(*away) > 0.5 * self._settings.room

    def _hand_back(self) -> Steps:
        """Hand the drone back to the navigator, if the sticks have it."""
        since = time.monotonic()
        self.sticks = Sticks(give_back=True)
        while self.held:
            if time.monotonic() - since > HANDOVER_PATIENCE:
                return 'teleop does not hand the drone back'
            yield
        self.sticks = Sticks()
        return ''
