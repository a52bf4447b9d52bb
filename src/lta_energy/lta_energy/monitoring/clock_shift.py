"""
Readings that come in order and all lie before the newest: their clock was set back.

What was overtaken on the way, or is sent again, does not come in order and thrice in a row. The
stamps of before are then taken over into the new clock, where the newest of them lies at the
first reading by it: nothing can tell what time passed between these two.
"""

from dataclasses import replace
from typing import Final

from lta_energy.monitoring.estimate import EnergyEstimate
from lta_energy.monitoring.reading import MeterReading

ENOUGH: Final = 3  # readings


def extend_ordered_stamps(before: tuple[int, ...], stamp_ns: int) -> tuple[int, ...]:
    """Return the stamps that have come in order, with one more. [ns]"""
    return (*before, stamp_ns) if before and stamp_ns > before[-1] else (stamp_ns,)


def shift_stamps(estimate: EnergyEstimate, back_ns: int) -> EnergyEstimate:
    """Return an estimate by a clock that is so much behind that of its readings. [ns]"""
    last, good = _shift_reading(estimate.last, back_ns), _shift_reading(estimate.good, back_ns)
    # That the newest reading was a good one is told by their being one.
    return estimate._replace(last=last, good=last if estimate.good is estimate.last else good)


def _shift_reading(reading: MeterReading | None, back_ns: int) -> MeterReading | None:
    return None if reading is None else replace(reading, stamp_ns=reading.stamp_ns - back_ns)
