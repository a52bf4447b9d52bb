"""Faults during a flight and their times: a section of a scenario file."""

import math
from typing import Annotated, NamedTuple

from lta_config.files import StrictModel
from lta_config.quantity import Quantity, si_quantity

When = Annotated[Quantity, si_quantity('s', low=0.0, high=86400.0)]


class FaultTimes(NamedTuple):
    """`SupplyFaults` as numbers, for compiled code: times after the start, inf for never. [s]"""

    panel_short: float
    brown_out: float


class SupplyFaults(StrictModel):
    """
    Faults of the supply, each from a time after the start on.

    `panel_short`: the array is shorted and gives current without voltage. `brown_out`: the supply
    fails once, and recovers when light has charged the cell a little.
    """

    panel_short: When | None = None
    brown_out: When | None = None

    @property
    def times(self) -> FaultTimes:
        """The times of the faults."""
        return FaultTimes(
            math.inf if self.panel_short is None else self.panel_short.si,
            math.inf if self.brown_out is None else self.brown_out.si,
        )


def is_shorted(faults: FaultTimes, elapsed: float) -> bool:
    """Return whether the array is shorted at a time after the start. [s]"""
    return elapsed >= faults.panel_short


def is_cut_off(faults: FaultTimes, before: float, elapsed: float) -> bool:
    """Return whether the supply is cut off between two times after the start. [s]"""
    return before <= faults.brown_out < elapsed
