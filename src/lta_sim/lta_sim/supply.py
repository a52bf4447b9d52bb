"""The electricity of one flight: cell, panel and loads, and the meters that watch them."""

from collections.abc import Mapping, Sequence
from typing import final

from lta_energy import battery, loads, panel
from lta_sim.sensors import power
from lta_sim.vehicle import Vehicle
from numpy.random import Generator

Electrics = tuple[float, float]  # voltage [V] and current [A]; negative discharges


@final
class Supply:
    """
    What feeds a vehicle.

    Parameters
    ----------
    vehicle : Vehicle
        Its cell, panel and loads.
    charge : float
        State of charge at the start. [1]
    chance : mapping of str to Generator
        Chance of the meters of `battery` and `panel`.

    """

    def __init__(self, vehicle: Vehicle, charge: float, chance: Mapping[str, Generator]) -> None:
        self.charge = charge
        self._cell, self._cells, self._loads = vehicle.battery, vehicle.panel, vehicle.loads
        self._chance = chance
        self._meter = power.PowerMeterSettings()
        self.meters = {
            name: power.draw(self._meter, chance[name]) for name in ('battery', 'panel')
        }
        self.electrics: Electrics = (battery.open_circuit_voltage(charge), 0.0)
        self.harvested = 0.0

    def harvest(self, irradiance: float) -> float:
        """Return what the panel gives in light of so many W/m2. [W]"""
        return panel.power(irradiance, self._cells.area, self._cells.efficiency)

    def shine(self, irradiance: float) -> None:
        """Take note of the light on the panel, which holds until the next note. [W/m2]"""
        self.harvested = self.harvest(irradiance)

    def drain(self, thrusts: Sequence[float], seconds: float) -> None:
        """Feed rotors of such thrusts [N] and the rest from the cell and what the panel brings."""
        asked = loads.demand(self._loads, thrusts, transmitting=True)
        cell = self._cell
        self.charge, voltage, current = battery.advance(
            self.charge, self.harvested - asked, cell.capacity, cell.resistance, seconds
        )
        self.electrics = (voltage, current)

    def meter_battery(self) -> Electrics:
        """Return what the cell's meter says."""
        return power.measure(
            self._meter, self.meters['battery'], *self.electrics, self._chance['battery']
        )

    def meter_panel(self, irradiance: float) -> Electrics:
        """Return what the panel's meter says in light of so many W/m2."""
        voltage = self._cells.voltage
        current = self.harvest(irradiance) / voltage
        return power.measure(
            self._meter, self.meters['panel'], voltage, current, self._chance['panel']
        )
