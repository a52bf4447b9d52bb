"""The electricity of one flight: power path and array, the meters that watch them, the books."""

from collections.abc import Mapping, Sequence
from typing import final

from lta_config.compilation.flat import compiled, Layout
from lta_energy.monitoring.books import Books
from lta_model.electrical import loads
from lta_model.electrical.panel import current_at
from lta_model.electrical.power_path import at_rest, Flow, held
from lta_model.scenario_faults import Faults
from lta_model.vehicle import Vehicle
from lta_sim.sensors import power
from lta_sim.supply_step import Account, Meantime, Parts, supplied
import numpy as np
from numpy.random import Generator

Electrics = tuple[float, float]  # voltage [V] and current [A]; negative discharges
NOTHING = np.zeros(1)


@final
class Supply:
    """
    What feeds a vehicle.

    Parameters
    ----------
    vehicle : Vehicle
        Its cell, array, charger and loads.
    charge : float
        State of charge at the start. [1]
    chance : mapping of str to Generator
        Chance of the meters of `battery` and `panel`.
    faults : Faults
        What fails on the way.
    looking : float
        What the drone finds lamps with, beside controller and radio. [W]

    """

    def __init__(
        self,
        vehicle: Vehicle,
        charge: float,
        chance: Mapping[str, Generator],
        faults: Faults,
        looking: float = 0.0,
    ) -> None:
        self._parts = Parts(vehicle.battery, vehicle.charger, vehicle.panel)
        self._loads, self._chance, self._faults = vehicle.loads, chance, faults
        self._looking = looking
        self._meter = power.PowerMeterSettings()
        self.meters = {
            name: power.draw(self._meter, chance[name]) for name in ('battery', 'panel')
        }
        self._irradiance = self._elapsed = 0.0
        self._account = Account(at_rest(charge), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self._begun = held(self._parts.cell, self._account.flow)
        self._layout = Layout(self._account)
        self._memory = self._layout.write(self._account)
        constants = Layout(self._parts)
        meantime = Layout(Meantime(0.0, 0.0, 0.0, False, False))
        self._constants = constants.write(self._parts)
        self._step = compiled(supplied, constants, self._layout, meantime)

    def prepare(self) -> None:
        """Compile a step, or load it from disk; nothing is drained."""
        second = np.array([0.0, 0.0, 1.0, False, False])
        self._step(self._constants, self._memory.copy(), second, NOTHING)

    @property
    def flow(self) -> Flow:
        """Cell and powers of the last control period."""
        return self._account.flow

    @property
    def electrics(self) -> Electrics:
        """Voltage and current of the cell."""
        return self.flow.voltage, self.flow.current

    @property
    def books(self) -> Books:
        """Energy since the start, as it truly is. [J]."""
        now = self._account
        stored = held(self._parts.cell, now.flow) - self._begun
        return Books(now.harvested, now.consumed, now.lost, stored)

    def shine(self, irradiance: float) -> None:
        """Take note of the light on the array, which holds until the next note. [W/m2]"""
        self._irradiance = irradiance

    def drain(self, thrusts: Sequence[float], seconds: float) -> None:
        """Feed rotors of such thrusts [N] and the rest from the cell and what the array brings."""
        asked = loads.demand(self._loads, thrusts, transmitting=True) + self._looking
        before, self._elapsed = self._elapsed, self._elapsed + seconds
        shorted = self._faults.shorted(before)
        cut = self._faults.cut(before, self._elapsed)
        meantime = np.array([self._irradiance, asked, seconds, shorted, cut])
        self._step(self._constants, self._memory, meantime, NOTHING)
        self._account = self._layout.read(self._memory)

    def meter_battery(self) -> Electrics:
        """Return what the cell's meter says; it sits behind what cuts off the loads."""
        voltage, current = self.electrics if self.flow.fed else (0.0, 0.0)
        return power.measure(
            self._meter, self.meters['battery'], voltage, current, self._chance['battery']
        )

    def meter_panel(self) -> Electrics:
        """Return what the array's meter says."""
        return power.measure(
            self._meter, self.meters['panel'], *self._at_array(), self._chance['panel']
        )

    def _at_array(self) -> Electrics:
        """Return voltage and current of the array, held beside its largest power."""
        now = self._account
        if self._faults.shorted(self._elapsed):
            return 0.0, current_at(self._parts.array, self._irradiance, 0.0)
        if now.voltage <= 0.0:
            return 0.0, 0.0
        return now.voltage, now.flow.harvested / now.voltage
