"""
Readings that come in order and all lie before the newest: their clock was set back.

What was overtaken on the way, or is sent again, does not come in order and thrice in a row. The
stamps of before are then taken over into the new clock, where the newest of them lies at the
first reading by it: nothing can tell what time passed between these two.
"""

from dataclasses import replace
from typing import Final

from lta_energy.monitoring.estimate import Estimate
from lta_energy.monitoring.reading import Reading

ENOUGH: Final = 3  # readings


def in_order(before: tuple[int, ...], stamp_ns: int) -> tuple[int, ...]:
    """Return the stamps that have come in order, with one more. [ns]"""
    return (*before, stamp_ns) if before and stamp_ns > before[-1] else (stamp_ns,)


def moved(estimate: Estimate, back_ns: int) -> Estimate:
    """Return an estimate by a clock that is so much behind that of its readings. [ns]"""
    last, good = _earlier(estimate.last, back_ns), _earlier(estimate.good, back_ns)
    # That the newest reading was a good one is told by their being one.
    return estimate._replace(last=last, good=last if estimate.good is estimate.last else good)


def _earlier(reading: Reading | None, back_ns: int) -> Reading | None:
    return None if reading is None else replace(reading, stamp_ns=reading.stamp_ns - back_ns)
