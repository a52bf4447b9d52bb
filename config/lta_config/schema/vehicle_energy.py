# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The `energy` block of a vehicle file: battery, solar array, charger and loads.

The position of the array is that of its part in the vehicle's layers.
"""

from collections.abc import Mapping
import math
from typing import Annotated

from lta_config.errors import BadInput
from lta_config.files import StrictModel
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.cell_file import CellFile, load_cell_file
from lta_config.schema.vehicle_body import Fraction
from pydantic import Field, model_validator

Power = Annotated[Quantity, si_quantity('W', low=0.0, sourced=True)]
Resistance = Annotated[Quantity, si_quantity('ohm', low=0.0, sourced=True)]
Voltage = Annotated[Quantity, si_quantity('V', above=0.0, sourced=True)]
Count = Annotated[int, Field(ge=1, le=1000)]


class BatteryBlock(StrictModel):
    """
    One lithium cell: values of a new cell at 25 degC, its temperature and its age.

    `age` is the lost share of the capacity; cells count as worn out at 20 %.
    """

    capacity: Annotated[Quantity, si_quantity('C', above=0.0, sourced=True)]
    resistance: Resistance
    relaxation_resistance: Resistance
    relaxation_time: Annotated[Quantity, si_quantity('s', above=0.0, high=1e5, sourced=True)]
    temperature: Annotated[Quantity, si_quantity('degC', low=-20.0, high=60.0, sourced=True)]
    age: Annotated[Quantity, si_quantity('1', low=0.0, high=0.8, sourced=True)]
    discharge_cutoff: Voltage  # the supply fails below it
    charge_cutoff: Voltage  # of the constant-voltage phase of charging
    charge_current: Annotated[Quantity, si_quantity('A', above=0.0, sourced=True)]

    @model_validator(mode='after')
    def _check_cutoffs(self) -> 'BatteryBlock':
        low, high = self.discharge_cutoff.si, self.charge_cutoff.si
        if low >= high:
            raise ValueError(
                f'has a discharge_cutoff of {low:g} V and a charge_cutoff of {high:g} V; '
                'discharge_cutoff must be the lower one'
            )
        return self


class SolarArrayBlock(StrictModel):
    """Solar cells of one kind in one plane: `parallel` strings of `series` cells each."""

    cell: str | CellFile  # name or path of a cell file; in a recording, also its content
    series: Count
    parallel: Count
    part: str | None = None  # that carries it; without one, sensors.panel_position applies
    normal: Annotated[Quantity, si_quantity('1', low=-1.0, high=1.0, length=3, sourced=True)]

    @model_validator(mode='after')
    def _check_normal(self) -> 'SolarArrayBlock':
        length = math.hypot(*self.normal.vector)
        if not 0.99 <= length <= 1.01:
            raise ValueError(
                f'has a normal of length {length:.3g}, but needs a unit vector; divide it by its '
                'length'
            )
        # Read now, so that an invalid cell is an error of the vehicle file
        try:
            _ = self.cell_file
        except BadInput as error:
            raise ValueError(
                f'names a solar cell in "cell" whose file cannot be used: {str(error).rstrip(".")}'
            ) from None
        return self

    @property
    def cell_file(self) -> CellFile:
        """One of the cells."""
        return load_cell_file(self.cell) if isinstance(self.cell, str) else self.cell


class ChargerBlock(StrictModel):
    """The electronics at the array: tracked share, converted share, own draw from the array."""

    tracking: Fraction
    conversion: Fraction
    idle: Power


class PowerLoadsBlock(StrictModel):
    """
    Power consumers; all others are added to `idle`.

    `transmitting` is the radio and `sensing` the light measurement with its lamp detection.
    `computing` is the additional power of a navigation strategy, by its name.
    """

    idle: Power
    transmitting: Power
    sensing: Power | None = None
    computing: Mapping[str, Power] = Field(default_factory=dict)
    rotor_idle: Power
    rotor_power: Annotated[Quantity, si_quantity('W/N', low=0.0, sourced=True)]


class EnergyBlock(StrictModel):
    """Battery, array with charger, and loads."""

    battery: BatteryBlock
    array: SolarArrayBlock | None = None
    charger: ChargerBlock | None = None
    loads: PowerLoadsBlock

    @model_validator(mode='after')
    def _check_charger(self) -> 'EnergyBlock':
        if (self.array is None) != (self.charger is None):
            have, lack = ('array', 'charger') if self.array else ('charger', 'array')
            raise ValueError(f'has "{have}" but no "{lack}"; add it, or remove "{have}"')
        return self
