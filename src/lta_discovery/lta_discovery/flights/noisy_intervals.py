"""Seconds in which a sensor says less than it usually does, and what else is left out."""

from dataclasses import dataclass, replace
from typing import Final, final

from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.flights.noise import HALF
import numpy as np

LOUD: Final = 3.0  # times the usual noise
SECOND: Final = 25  # points of the grid
FEW: Final = 6  # readings; of fewer no noise is told
THIRD: Final = 20.0**0.5  # of third differences by that of the values
CHANNEL: Final = {6: 12, 7: 13}  # of CHANNELS by column of the readings


@final
@dataclass(frozen=True, slots=True)
class ExcludedInterval:
    """
    What is left out.

    Attributes
    ----------
    flight, channel : str
        Of which flight, and what the check was about; the flight is left out where that is the
        pose, the commands or the whole, else the sensor alone.
    from_s, to_s : float
        Since its start. [s]
    reason : str
        A sentence of the check.

    """

    flight: str
    channel: str
    from_s: float
    to_s: float
    reason: str


def remove_noisy_intervals(
    name: str, flight: MeasuredFlight
) -> tuple[MeasuredFlight, list[ExcludedInterval]]:
    """Leave out seconds in which a sensor is noisier than usual, as near the end of its range."""
    readings, cuts = flight.readings.copy(), []
    for column, channel in ((6, 'range'), (7, 'pressure')):
        rough = np.full(len(readings), np.nan)
        rough[:-3] = np.abs(np.diff(readings[:, column], 3)) / THIRD
        for begin in range(0, len(rough), SECOND):
            here = slice(begin, begin + SECOND)
            known = rough[here][np.isfinite(rough[here])]
            level = flight.noise[CHANNEL[column]]
            if len(known) >= FEW and np.median(known) < LOUD * HALF * level:
                continue
            if not np.isfinite(readings[here, column]).any():
                continue
            readings[here, column] = np.nan
            first, last = (float(flight.time[min(k, len(rough) - 1)]) for k in (begin, here.stop))
            said = f'It is silent in between, or more than {LOUD:g} times as noisy as usual.'
            cuts.append(ExcludedInterval(name, channel, first, last, said))
    return replace(flight, readings=readings), cuts
