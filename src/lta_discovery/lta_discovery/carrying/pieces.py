"""A flight in pieces that are predicted seconds ahead, one begun before the last has ended."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.flights.measured import Measured, PERIOD
from lta_discovery.flights.windows import state_at, stretches, Windows
from lta_discovery.forecast.ahead import HORIZONS
from lta_discovery.model.knobs import Knob
from lta_discovery.replay.linearise import Linearised
import numpy as np

APART: Final = 2.5  # s; between beginnings, at least
MOST: Final = 400  # pieces of all flights, which bounds time and memory


def overlapping(flight: Measured, apart: float = APART) -> Windows:
    """
    Return whole pieces as long as the last horizon.

    Parameters
    ----------
    flight : Measured
        The flight.
    apart : float
        Between the beginnings of pieces. [s]

    """
    count = round(HORIZONS[-1] / PERIOD)
    first, start = [], []
    for begin, end in stretches(flight.usable):
        for index in range(begin, end - count, round(apart / PERIOD)):
            state = state_at(flight, index)
            if state is not None:
                first.append(index)
                start.append(state)
    inside = np.ones((len(first), count + 1), dtype=np.bool_)
    table = np.array(start).reshape(-1, 13)
    return Windows(np.array(first, dtype=np.int64), count + 1, table, inside)


def apart_for(flights: Sequence[Measured]) -> float:
    """Return how far apart pieces begin, so that there are not too many of them. [s]"""
    seconds = PERIOD * sum(int(flight.usable.sum()) for flight in flights)
    return max(APART, seconds / MOST)


def far(flight: Linearised, knobs: Sequence[Knob], apart: float = APART) -> Linearised | None:
    """Return a flight in such pieces, with the same knobs; None where it is too short for any."""
    replay = flight.replay
    cut = overlapping(replay.flight, apart)
    if not len(cut.first):
        return None
    return Linearised(replay.in_pieces(cut), knobs, flight.places)
