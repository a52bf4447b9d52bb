"""
The aero file: what the wind tunnel gave, fitted, with the evidence for it.

`lta cfd run` writes it; a vehicle file that says `aero: gtmab` flies with its aero block.
"""

from collections.abc import Mapping
from typing import Annotated, Literal

from lta_config.files import find_file, load_file, StrictModel
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.vehicle_aero import AeroBlock
from pydantic import AliasChoices, Field

SUFFIX = '.aero.yaml'


class DragFitQuality(StrictModel):
    """How well the two coefficients of an axis meet its points."""

    points: int
    error: float  # largest relative error [1]
    exponent: float | None = None  # of a power law through them [1]
    spread: float  # largest of any point [1]
    cells: int  # 0 by hand
    by_hand: float  # drag here over that by hand, at the middle point [1]
    mesh: float | None = None  # drag on a coarser mesh over that here, less 1 [1]
    hull: float | None = None  # share of the hull in the drag, at the middle point [1]


class AeroEvidence(StrictModel):
    """Where the numbers come from."""

    engine: str
    fidelity: Literal['analytic', 'preview', 'reference']
    geometry: str
    density: Annotated[Quantity, si_quantity('kg/m3', above=0.0, sourced=True)]
    axes: Mapping[str, DragFitQuality]
    # What the diagonal drag of the model has no place for: lift and moment at the middle speed.
    beside: Mapping[str, str] = Field(default_factory=dict)
    warnings: list[str] = Field(default_factory=list)


class AeroFile(StrictModel):
    """A whole aero file."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
    vehicle: str
    evidence: AeroEvidence
    aero: AeroBlock


def load_aero_file(name: str) -> AeroFile:
    """Return an aero file by shipped name or path; anything wrong is a `BadInput` sentence."""
    return load_file(AeroFile, find_file('aero', name, SUFFIX))
