# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Cell files, and published tables of measured cells with the arrays built from them.

A cell file is a commercial solar panel with its data-sheet values at standard conditions:
1000 W/m2 of sunlight (AM 1.5) and a cell temperature of 25 degC. `lta_model.electrical.panel`
derives the single-diode model from these numbers. A table of cells is as printed.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Annotated, Literal

from lta_config.files import find_file, load_file, Name, SchemaVersion, StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import Field, model_validator

Volts = Annotated[Quantity, si_quantity('V', above=0.0, high=1000.0, sourced=True)]
Amperes = Annotated[Quantity, si_quantity('A', above=0.0, high=100.0, sourced=True)]
Drift = Annotated[Quantity, si_quantity('1/K', low=-0.1, high=0.1, sourced=True)]


class CellRatings(StrictModel):
    """
    Data-sheet values at standard conditions.

    `ideality` is that of one junction, of which `junctions` are in series. `gap` is its band gap,
    which gives the temperature dependence. `warming` is the temperature of the cells above the air
    per irradiance.
    """

    open_circuit: Volts
    short_circuit: Amperes
    voltage: Volts  # at maximum power
    current: Amperes  # at maximum power
    junctions: Annotated[int, Field(ge=1, le=1000)]
    ideality: Annotated[Quantity, si_quantity('1', low=0.5, high=5.0, sourced=True)]
    gap: Annotated[Quantity, si_quantity('eV', low=0.5, high=4.0, sourced=True)]
    current_drift: Drift  # of the short-circuit current, relative
    warming: Annotated[Quantity, si_quantity('K m2/W', low=0.0, high=0.2, sourced=True)]

    @model_validator(mode='after')
    def _check_power_point(self) -> 'CellRatings':
        # The maximum power point lies below both ends of the current-voltage curve
        if not self.voltage.si < self.open_circuit.si:
            raise ValueError(
                f'has the voltage {self.voltage.si:g} V at maximum power, but it must be below '
                f'open_circuit, {self.open_circuit.si:g} V'
            )
        if not self.current.si < self.short_circuit.si:
            raise ValueError(
                f'has the current {self.current.si:g} A at maximum power, but it must be below '
                f'short_circuit, {self.short_circuit.si:g} A'
            )
        return self


class CellFile(StrictModel):
    """A cell file."""

    schema_version: SchemaVersion
    name: Name
    about: str
    technology: Literal['crystalline', 'amorphous', 'organic']
    size: Annotated[Quantity, si_quantity('m', above=0.0, high=10.0, length=3, sourced=True)]
    mass: Annotated[Quantity, si_quantity('kg', above=0.0, high=10.0, sourced=True)]
    electrical: CellRatings

    @property
    def area(self) -> float:
        """Area of the face, from the outer size. [m2]."""
        length, width, _ = self.size.vector
        return length * width

    @property
    def rated_power(self) -> float:
        """Power at standard conditions. [W]."""
        return self.electrical.voltage.si * self.electrical.current.si


@cache
def load_cell_file(name: str) -> CellFile:
    """Return a cell file by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(CellFile, find_file('cell', name))


Cells = Annotated[list[str], Field(min_length=1)]
Mass = Annotated[Quantity, si_quantity('kg', above=0.0, sourced=True)]
Sign = Literal['deficit', 'surplus']


class CellTableRow(StrictModel):
    """One row as printed; each entry of `cells` is a cell file that it may refer to."""

    maker: str
    model: str
    cells: Cells
    dimensions: str
    mass: Mass
    areal_mass: Annotated[Quantity, si_quantity('kg/m2', above=0.0, sourced=True)]
    # Time to charge the same depleted supercapacitor from 0 to 4 V; only ratios are meaningful
    charge: Annotated[Quantity, si_quantity('s', above=0.0, sourced=True)]
    areal_charge: Annotated[Quantity, si_quantity('s/m2', above=0.0, sourced=True)]
    defects: list[str]


class BuiltArray(StrictModel):
    """An array that was built, and the sign of its net power as printed."""

    cells: Cells
    series: Annotated[int, Field(ge=1)]
    parallel: Annotated[int, Field(ge=1)]
    mass: Mass
    area: Annotated[Quantity, si_quantity('m2', above=0.0, sourced=True)]
    standby: Sign
    transmitting: Sign
    defects: list[str]


class BuiltArrays(StrictModel):
    """The arrays that were built, and the illuminance of their test."""

    illuminance: Annotated[Quantity, si_quantity('lx', above=0.0, sourced=True)]
    built: Mapping[Name, BuiltArray]


class CellTable(StrictModel):
    """A table of cells; `lights` are the spectra under which its arrays are compared."""

    schema_version: SchemaVersion
    name: Name
    about: str
    rows: Annotated[Mapping[Name, CellTableRow], Field(min_length=1)]
    arrays: BuiltArrays
    lights: Annotated[Sequence[Name], Field(min_length=1)]


def load_cell_table(name: str) -> CellTable:
    """Return a table by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(CellTable, find_file('cell table', name))
