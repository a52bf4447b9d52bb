"""A published table of measured solar cells, as printed, and the arrays built from them."""

from collections.abc import Mapping
from typing import Annotated, Literal

from lta_config.files import find_file, load_file, StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import AliasChoices, Field

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
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
    """A table of cells; `lights` are kinds of light by their luminous efficacy."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Name
    about: str
    rows: Annotated[Mapping[Name, CellTableRow], Field(min_length=1)]
    arrays: BuiltArrays
    lights: Annotated[
        Mapping[Name, Annotated[Quantity, si_quantity('lm/W', above=0.0, sourced=True)]],
        Field(min_length=1),
    ]


def load_cell_table(name: str) -> CellTable:
    """Return a table by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(CellTable, find_file('cell table', name))
