# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simulate the electric supply of a flight: power path, solar array, power meters, energy totals.

`advance_supply` is one control period, compiled for `Supply` and for batches.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import struct
from typing import Any, final, NamedTuple

from lta_config.compilation.flat import compile_core, TupleLayout
from lta_energy.monitoring.meters import EnergyBalance
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.loads import LoadModel, power_demand
from lta_model.electrical.mppt_charger import (
    advance_power_path,
    ChargerModel,
    PowerFlow,
    resting_flow,
    total_stored_energy,
)
from lta_model.electrical.panel import current_at_voltage, find_max_power_point, SolarArrayModel
from lta_model.scenario import FaultTimes, is_cut_off, is_shorted
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.random import Generator


@final
@dataclass(frozen=True, slots=True)
class PowerMeterSettings:
    """Steps, limits and errors of the meter; errors are bounds of uniform distributions."""

    # Of voltage and current: one count, and standard deviation of the noise before rounding [V, A]
    voltage_step: float = 4e-3
    voltage_noise: float = 2e-3
    current_step: float = 1e-4
    current_noise: float = 5e-5
    current_range: float = 3.2  # largest current in either direction [A]
    scale: float = 0.002  # largest relative scale error of voltage and current [1]
    current_offset: float = 4e-4  # largest zero offset of the current [A]


@final
@dataclass(frozen=True, slots=True)
class PowerMeterErrors:
    """Errors that stay constant during a flight: two gains, and the current offset [A]."""

    voltage_gain: float
    current_gain: float
    current_offset: float


def draw_meter_errors(settings: PowerMeterSettings, rng: Generator) -> PowerMeterErrors:
    """Return the errors of one flight."""
    voltage, current, offset = rng.uniform(-1.0, 1.0, 3).tolist()
    return PowerMeterErrors(
        voltage_gain=1.0 + settings.scale * voltage,
        current_gain=1.0 + settings.scale * current,
        current_offset=settings.current_offset * offset,
    )


def measure_voltage_and_current(
    settings: PowerMeterSettings,
    errors: PowerMeterErrors,
    voltage: float,
    current: float,
    rng: Generator,
) -> tuple[float, float]:
    """
    Return one reading of a true voltage [V] and a signed current [A].

    The measured voltage is never below 0 and the current is clipped at the range.
    """
    x, y = rng.standard_normal(2).tolist()
    volts = errors.voltage_gain * voltage + settings.voltage_noise * x
    amperes = errors.current_gain * current + errors.current_offset + settings.current_noise * y
    limit = settings.current_range
    return (
        max(0.0, round(volts / settings.voltage_step) * settings.voltage_step),
        max(-limit, min(limit, round(amperes / settings.current_step) * settings.current_step)),
    )


Thrusts = tuple[float, float, float, float, float, float, float, float]  # zero in unused slots


class SupplyComponents(NamedTuple):
    """Components of the supply."""

    cell: BatteryModel
    charger: ChargerModel
    array: SolarArrayModel


class SupplyConstants(NamedTuple):
    """What determines the supply of a flight, except its light and its thrusts."""

    parts: SupplyComponents
    loads: LoadModel
    navigation: float  # power of light sensing and computing [W]
    faults: FaultTimes


class SupplyInputs(NamedTuple):
    """Inputs of one control period."""

    irradiance: float  # on the array [W/m2]
    thrusts: Thrusts  # [N]
    payload: float  # [W]
    step: float  # number of the period, from 0
    dt: float  # [s]


class SupplyState(NamedTuple):
    """State of the supply."""

    flow: PowerFlow
    irradiance: float
    voltage: float
    current: float
    harvested: float
    consumed: float
    lost: float


def advance_supply(
    constants: SupplyConstants,
    before: SupplyState,
    meantime: SupplyInputs,
    scratch: Any,
) -> SupplyState:
    """Return the supply's state one control period later; `scratch` is not needed."""
    parts, faults, dt = constants.parts, constants.faults, meantime.dt
    # Products and no sums, whose rounding would move a fault by a period
    begun, ended = meantime.step * dt, (meantime.step + 1.0) * dt
    demand = power_demand(constants.loads, meantime.thrusts, True) + constants.navigation
    demand += meantime.payload
    voltage, current = before.voltage, before.current
    # The search for the maximum power point is slow; light is updated less often than loads
    if meantime.irradiance != before.irradiance:
        voltage, current = find_max_power_point(parts.array, meantime.irradiance)
    now = before.flow
    begin = PowerFlow(
        now.charge, now.relaxation, now.voltage, now.current, now.harvested, now.consumed,
        # An injected fault cuts the supply as a brown-out does
        now.lost, now.fed and not is_cut_off(faults, begun, ended),
    )  # fmt: skip
    available = 0.0 if is_shorted(faults, begun) else voltage * current
    flow = advance_power_path(parts.cell, parts.charger, begin, available, demand, dt)
    return SupplyState(
        flow,
        meantime.irradiance,
        voltage,
        current,
        before.harvested + flow.harvested * dt,
        before.consumed + flow.consumed * dt,
        before.lost + flow.lost * dt,
    )


Electrics = tuple[float, float]  # voltage [V] and current [A]; negative discharges
NO_SCRATCH = np.zeros(1)
DARK_SECOND = SupplyInputs(0.0, (0.0,) * 8, 0.0, 0.0, 1.0)  # without rotors
SUPPLY_INPUTS = TupleLayout(DARK_SECOND)
SUPPLY_STATE = TupleLayout(SupplyState(resting_flow(1.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


@final
class Supply:
    """The electric supply of a vehicle; its state is an array, read on demand."""

    def __init__(
        self,
        vehicle: Vehicle,
        charge: float,
        chance: Mapping[str, Generator],
        faults: FaultTimes,
        navigation: float = 0.0,
    ) -> None:
        self._parts = SupplyComponents(vehicle.battery, vehicle.charger, vehicle.panel)
        self._chance, self._faults = chance, faults
        self._meter = PowerMeterSettings()
        self.meters = {
            name: draw_meter_errors(self._meter, chance[name]) for name in ('battery', 'panel')
        }
        self._irradiance, self._periods, self._elapsed = 0.0, 0, 0.0
        begin = SupplyState(resting_flow(charge), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self._begun = total_stored_energy(self._parts.cell, begin.flow)
        self._memory = SUPPLY_STATE.write(begin)
        self._flow = SUPPLY_STATE.view(self._memory)['flow']
        self._meantime = np.empty(SUPPLY_INPUTS.size)
        # Packing into the buffer is faster than building an array
        self._pack = struct.Struct(f'{SUPPLY_INPUTS.size}d').pack_into
        constants = SupplyConstants(self._parts, vehicle.loads, navigation, faults)
        layout = TupleLayout(constants)
        self._constants = layout.write(constants)
        self._step = compile_core(advance_supply, layout, SUPPLY_STATE, SUPPLY_INPUTS)

    def prepare(self) -> None:
        """Compile the step or load it from disk, without draining the cell."""
        # On a copy of the state
        self._step(
            self._constants, self._memory.copy(), SUPPLY_INPUTS.write(DARK_SECOND), NO_SCRATCH
        )

    @property
    def _account(self) -> SupplyState:
        """Return the state."""
        return SUPPLY_STATE.read(self._memory)

    @property
    def flow(self) -> PowerFlow:
        """State of the cell, and mean powers of the last control period."""
        return self._account.flow

    @property
    def is_fed(self) -> bool:
        """Whether the supply holds."""
        return bool(self._flow['fed'])

    @property
    def voltage(self) -> float:
        """Voltage of the cell [V]."""
        return float(self._flow['voltage'])

    @property
    def cell_voltage_and_current(self) -> Electrics:
        """Voltage and current of the cell."""
        flow = self.flow
        return flow.voltage, flow.current

    @property
    def energy_totals(self) -> EnergyBalance:
        """Return the true energy totals since the start [J]."""
        now = self._account
        stored = total_stored_energy(self._parts.cell, now.flow) - self._begun
        return EnergyBalance(now.harvested, now.consumed, now.lost, stored)

    def set_irradiance(self, irradiance: float) -> None:
        """Set the irradiance on the array until the next call [W/m2]."""
        self._irradiance = irradiance

    def feed_loads(self, thrusts: Sequence[float], seconds: float) -> None:
        """Supply the rotors, with the thrusts of all slots [N], for a control period [s]."""
        self._pack(self._meantime.data, 0, self._irradiance, *thrusts, 0.0, self._periods, seconds)
        self._step(self._constants, self._memory, self._meantime, NO_SCRATCH)
        self._periods += 1
        self._elapsed = self._periods * seconds

    def read_battery_meter(self) -> Electrics:
        """Return the reading of the cell's meter, which is behind the load cut-off."""
        # After a cut-off the meter has no supply either and reads zero
        voltage, current = self.cell_voltage_and_current if self.is_fed else (0.0, 0.0)
        return measure_voltage_and_current(
            self._meter, self.meters['battery'], voltage, current, self._chance['battery']
        )

    def read_array_meter(self) -> Electrics:
        """Return the reading of the array's meter."""
        return measure_voltage_and_current(
            self._meter,
            self.meters['panel'],
            *self._array_voltage_and_current(),
            self._chance['panel'],
        )

    def _array_voltage_and_current(self) -> Electrics:
        """Return voltage and current of the array near its maximum power point."""
        now = self._account
        if is_shorted(self._faults, self._elapsed):
            # A shorted array has no voltage and its short-circuit current
            return 0.0, current_at_voltage(self._parts.array, self._irradiance, 0.0)
        if now.voltage <= 0.0:
            return 0.0, 0.0
        # Voltage of the maximum power point; the current is less where not all power is harvested
        return now.voltage, now.flow.harvested / now.voltage
