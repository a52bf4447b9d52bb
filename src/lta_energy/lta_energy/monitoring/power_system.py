"""Describe the cell and the charger of the vehicle file for the monitor."""

import math
from typing import NamedTuple, Self

from lta_config.schema.vehicle_energy import EnergyBlock
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.charger import ChargerModel, convert_harvest


class PowerSystem(NamedTuple):
    """The cell and the charger of a vehicle."""

    cell: BatteryModel
    charger: ChargerModel

    @classmethod
    def from_entry(cls, energy: EnergyBlock) -> Self:
        """Build cell and charger from the energy block of a vehicle file."""
        return cls(BatteryModel.from_energy(energy), ChargerModel.from_energy(energy))

    def charger_output(self, harvest: float) -> float:
        """Return the charger's output for a measured panel power; 0 if not measured. [W]"""
        if not math.isfinite(harvest):
            return 0.0
        # No tracking factor here: the measured panel power already contains it
        return convert_harvest(self.charger, harvest)
