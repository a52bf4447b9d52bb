"""Faults during a flight and their times: a section of a scenario file."""

from typing import Annotated

from lta_config.files import StrictModel
from lta_config.quantity import Quantity, si_quantity

When = Annotated[Quantity, si_quantity('s', low=0.0, high=86400.0)]


class SupplyFaults(StrictModel):
    """
    Faults of the supply, each from a time after the start on.

    `panel_short`: the array is shorted and gives current without voltage. `brown_out`: the supply
    fails once, and recovers when light has charged the cell a little.
    """

    panel_short: When | None = None
    brown_out: When | None = None

    def is_shorted(self, elapsed: float) -> bool:
        """Return whether the array is shorted at a time after the start. [s]"""
        return self.panel_short is not None and elapsed >= self.panel_short.si

    def is_cut_off(self, before: float, elapsed: float) -> bool:
        """Return whether the supply is cut off between two times after the start. [s]"""
        return self.brown_out is not None and before <= self.brown_out.si < elapsed
