# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The power path: array -> charger -> loads and cell, with its limits.

The charger tracks a share of the array's maximum power, draws its own power from the array while
it works, and converts the rest with some efficiency; in too dim light it is off. Loads come first;
the rest charges the cell within its charging current and voltage, and excess light is not
harvested. Below the cell's cut-off, or with an empty cell, the supply fails: the loads are off
until light has charged the cell a little.

Plain functions of scalars and named tuples, which compile. At every step

    harvested = consumed + lost + change of the stored energy.
"""

from typing import Annotated, final, NamedTuple, Self

from lta_config.files import StrictModel
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_model.electrical.battery import (
    advance_cell,
    BatteryModel,
    open_circuit_voltage,
    relaxation_energy,
    resistive_heat,
    stored_energy,
)
from pydantic import Field

RESTART_CHARGE = 0.05  # charge at which a failed supply comes back; assumed
Share = Annotated[float, Field(ge=0.0, le=1.0)]


@final
class ChargerModel(StrictModel):
    """
    The charger between array and cell.

    Attributes
    ----------
    tracking : float
        Share of the array's largest power that it tracks. [1]
    conversion : float
        Power out by power in. [1]
    idle : float
        Own draw from the array while it works. [W]

    """

    tracking: Share
    conversion: Share
    idle: Annotated[float, Field(ge=0.0, allow_inf_nan=False)]

    @classmethod
    def from_energy(cls, energy: EnergyBlock) -> Self:
        """Return the charger of a vehicle file, or one without output if it has none."""
        data = energy.charger
        if data is None:
            return cls(tracking=0.0, conversion=0.0, idle=0.0)
        return cls(tracking=data.tracking.si, conversion=data.conversion.si, idle=data.idle.si)


class PowerFlow(NamedTuple):
    """The cell after a step, and the mean powers of that step."""

    # State of charge [1] and relaxation voltage [V]
    charge: float
    relaxation: float
    # At the cell's terminals; a positive current charges [V, A]
    voltage: float
    current: float
    # From the array, by the loads, and as heat in cell and charger [W]
    harvested: float
    consumed: float
    lost: float
    fed: bool  # whether the supply holds; otherwise the loads are off


def resting_flow(charge: float) -> PowerFlow:
    """Return a cell at rest in the dark, at a state of charge [1]."""
    return PowerFlow(charge, 0.0, open_circuit_voltage(charge), 0.0, 0.0, 0.0, 0.0, charge > 0.0)


def charger_output(charger: ChargerModel, available: float) -> float:
    """Return the output power at the array's largest power; 0 while the charger is off [W]."""
    return convert_harvest(charger, available * charger.tracking)


def convert_harvest(charger: ChargerModel, harvest: float) -> float:
    """Return the output power for a power that is taken from the array; 0 if too little [W]."""
    # The own draw is taken before the conversion: the LT3652's supply pin is at the array
    return max(0.0, harvest - charger.idle) * charger.conversion


def charge_power_limit(cell: BatteryModel, charge: float, relaxation: float, dt: float) -> float:
    """Return the largest power with which a cell may be charged during dt [s] [W]."""
    behind = open_circuit_voltage(charge) + relaxation
    # Constant-current phase, and no more than the cell can hold
    current = min(cell.charge_current, (1.0 - charge) * cell.capacity / dt)
    room = cell.charge_cutoff - behind
    # Constant-voltage phase: terminals at the charge cut-off
    if room < cell.resistance * current:
        current = room / cell.resistance if cell.resistance > 0.0 else 0.0
    current = max(0.0, current)
    return (behind + cell.resistance * current) * current


def advance_power_path(
    cell: BatteryModel,
    charger: ChargerModel,
    before: PowerFlow,
    available: float,
    demand: float,
    dt: float,
) -> PowerFlow:
    """
    Return the power path after dt [s] of constant light and load.

    `available` is the largest power of the array in this light, `demand` that of the loads. [W]
    """
    bright = charger_output(charger, available)
    # A failed supply feeds no loads
    load = demand if before.fed else 0.0
    # Surplus light is not harvested once the charge limit is reached
    power = min(bright - load, charge_power_limit(cell, before.charge, before.relaxation, dt))
    output = power + load
    # Back through the converter to the array's side
    harvested = output / charger.conversion + charger.idle if bright > 0.0 else 0.0
    charge, relaxation, voltage, current = advance_cell(
        cell, before.charge, before.relaxation, power, dt
    )
    if before.fed:
        # Under-voltage lockout
        fed = voltage >= cell.discharge_cutoff and charge > 0.0
    else:
        # Hysteresis: comes back only while light charges, above the restart charge
        fed = current > 0.0 and charge >= RESTART_CHARGE
    return PowerFlow(
        charge,
        relaxation,
        voltage,
        current,
        harvested,
        output - voltage * current,  # less than the demand where the cell cannot supply it
        resistive_heat(cell, before.relaxation, current, dt) + harvested - output,
        fed,
    )


def total_stored_energy(cell: BatteryModel, flow: PowerFlow) -> float:
    """Return the energy that a cell holds, in its chemistry and in its RC pair [J]."""
    return stored_energy(flow.charge, cell.capacity) + relaxation_energy(cell, flow.relaxation)
