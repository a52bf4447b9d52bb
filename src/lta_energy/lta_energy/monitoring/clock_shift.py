"""
Detect a clock that was set back and shift the stored stamps into the new clock.

Messages that were delayed or repeated do not arrive in ascending order three times in a row, so
three such stamps before the newest one mean a new clock. The newest old reading is then placed at
the time of the first new one, because the time between the two is unknown.
"""

from dataclasses import replace
from typing import Final

from lta_energy.monitoring.estimate import EnergyEstimate
from lta_energy.monitoring.reading import MeterReading

ENOUGH: Final = 3  # readings


def append_stamp(before: tuple[int, ...], stamp_ns: int) -> tuple[int, ...]:
    """Append a stamp to an ascending sequence, or start a new sequence. [ns]"""
    return (*before, stamp_ns) if before and stamp_ns > before[-1] else (stamp_ns,)


def shift_stamps(estimate: EnergyEstimate, back_ns: int) -> EnergyEstimate:
    """Move the stamps of an estimate back into the new clock. [ns]"""
    last, good = _shift_reading(estimate.last, back_ns), _shift_reading(estimate.good, back_ns)
    # `good is last` marks that the newest reading is usable; keep that identity
    return estimate._replace(last=last, good=last if estimate.good is estimate.last else good)


def _shift_reading(reading: MeterReading | None, back_ns: int) -> MeterReading | None:
    return None if reading is None else replace(reading, stamp_ns=reading.stamp_ns - back_ns)
