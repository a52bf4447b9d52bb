"""What the monitor knows of its own vehicle: the cell and the charger, as the file has them."""

import math
from typing import NamedTuple, Self

from lta_config.schema.vehicle_energy import Energy
from lta_model.electrical.battery import Battery
from lta_model.electrical.power_path import Charger


class Aboard(NamedTuple):
    """The cell and the charger of a vehicle."""

    cell: Battery
    charger: Charger

    @classmethod
    def of(cls, energy: Energy) -> Self:
        """Return what a vehicle file says."""
        return cls(Battery.of(energy), Charger.of(energy))

    def given(self, harvest: float) -> float:
        """Return what the charger makes of what the array gives; 0 if unmeasured. [W]"""
        if not math.isfinite(harvest):
            return 0.0
        return max(0.0, harvest * self.charger.conversion - self.charger.idle)
