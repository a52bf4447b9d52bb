"""
The sticks of a flight that calibrates a vehicle, as a pilot would move them.

A flight has pieces, each of which begins at rest. The first ones move one stick: what the vehicle
does then is due to one axis. In the others all sticks change every second or two, each by itself,
so that nothing that they cause together looks alike. Between the pieces the drone returns.
"""

from collections.abc import Iterator
import math
from typing import Final, NamedTuple

from lta_bridge.teleop.sticks import Sticks
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


class StickHold(NamedTuple):
    """Sticks, and the time for which they are held. [s]"""

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
    """Return sticks that do not climb or sink further from the height of the place. [m]"""
    is_far = abs(above) > HIGHEST_RISE and math.copysign(1.0, above) * sticks.climb > 0.0
    return sticks._replace(climb=0.0) if is_far else sticks
