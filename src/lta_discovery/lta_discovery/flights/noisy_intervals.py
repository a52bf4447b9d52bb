"""Exclude seconds in which a sensor is noisier than usual."""

from dataclasses import dataclass, replace
from typing import Final, final

from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.flights.noise import HALF
import numpy as np

LOUD: Final = 3.0  # times the usual noise
SECOND: Final = 25  # points of the grid
FEW: Final = 6  # readings; fewest for a noise estimate
THIRD: Final = 20.0**0.5  # noise of third differences by that of the values
CHANNEL: Final = {6: 12, 7: 13}  # of CHANNELS by column of the readings


@final
@dataclass(frozen=True, slots=True)
class ExcludedInterval:
    """An excluded part of a flight."""

    # The flight, and the checked channel. The flight itself is excluded there if the channel is
    # the pose, the commands or the whole; otherwise only that sensor.
    flight: str
    channel: str
    # Since its start [s]
    from_s: float
    to_s: float
    reason: str
    # Whether the whole vehicle is disturbed, whatever the channel: it is in a hand
    disturbs_all: bool = False


def remove_noisy_intervals(
    name: str, flight: MeasuredFlight
) -> tuple[MeasuredFlight, list[ExcludedInterval]]:
    """Exclude seconds with a noisy sensor, such as a range finder near the end of its range."""
    readings, cuts = flight.readings.copy(), []
    for column, channel in ((6, 'range'), (7, 'pressure')):
        rough = np.full(len(readings), np.nan)
        # Third differences remove smooth motion and leave the noise
        rough[:-3] = np.abs(np.diff(readings[:, column], 3)) / THIRD
        for begin in range(0, len(rough), SECOND):
            here = slice(begin, begin + SECOND)
            finite = rough[here][np.isfinite(rough[here])]
            level = flight.noise[CHANNEL[column]]
            # The median of absolute values of white noise is HALF of its deviation
            if len(finite) >= FEW and np.median(finite) < LOUD * HALF * level:
                continue
            # Nothing to exclude, and nothing to report
            if not np.isfinite(readings[here, column]).any():
                continue
            readings[here, column] = np.nan
            first, last = (float(flight.time[min(k, len(rough) - 1)]) for k in (begin, here.stop))
            reason = f'The sensor has gaps, or is more than {LOUD:g} times as noisy as usual.'
            cuts.append(ExcludedInterval(name, channel, first, last, reason))
    return replace(flight, readings=readings), cuts
