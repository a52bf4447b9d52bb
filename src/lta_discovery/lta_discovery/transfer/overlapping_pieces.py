"""Cut a flight into overlapping pieces for forecasts."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.flights.measured_flight import MeasuredFlight, PERIOD
from lta_discovery.flights.windows import find_usable_runs, fit_state_at, Windows
from lta_discovery.forecast.horizon_errors import HORIZONS
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
import numpy as np

APART: Final = 2.5  # s; least time between beginnings
MOST: Final = 400  # pieces of all flights, to limit time and memory


def cut_horizon_pieces(
    flight: MeasuredFlight, apart: float = APART, length: float = HORIZONS[-1]
) -> Windows:
    """Cut a flight into complete pieces as long as the last horizon. [s]"""
    count = round(length / PERIOD)
    first, start = [], []
    for begin, end in find_usable_runs(flight.usable):
        for index in range(begin, end - count, round(apart / PERIOD)):
            state = fit_state_at(flight, index)
            if state is not None:
                first.append(index)
                start.append(state)
    inside = np.ones((len(first), count + 1), dtype=np.bool_)
    table = np.array(start).reshape(-1, 13)
    return Windows(np.array(first, dtype=np.int64), count + 1, table, inside)


def piece_spacing(flights: Sequence[MeasuredFlight]) -> float:
    """Return the time between beginnings of pieces that limits their number. [s]"""
    seconds = PERIOD * sum(int(flight.usable.sum()) for flight in flights)
    return max(APART, seconds / MOST)


def cut_overlapping_pieces(
    flight: FlightLinearizer,
    knobs: Sequence[FreeParameter],
    apart: float = APART,
    length: float = HORIZONS[-1],
) -> FlightLinearizer | None:
    """Return a flight in overlapping pieces; None if it is too short for any."""
    replay = flight.replay
    cut = cut_horizon_pieces(replay.flight, apart, length)
    if not len(cut.first):
        return None
    return FlightLinearizer(replay.with_pieces(cut), knobs, flight.places)
