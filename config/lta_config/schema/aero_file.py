"""
The aero file: coefficients fitted to wind-tunnel results, with the evidence for them.

`lta cfd run` writes it. A vehicle file with `aero: gtmab` uses its aero block.
"""

from collections.abc import Mapping
from typing import Annotated, Literal

from lta_config.files import find_file, load_file, StrictModel
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.vehicle_aero import AeroCoefficients
from pydantic import AliasChoices, Field

SUFFIX = '.aero.yaml'


class DragFitQuality(StrictModel):
    """How well the two drag coefficients of an axis fit its points."""

    # Speeds at which the force was computed
    points: int
    error: float  # largest relative error [1]
    exponent: float | None = None  # of a power law through them [1]
    spread: float  # largest of any point [1]
    cells: int  # of the mesh; 0 for the analytic engine
    by_hand: float  # this drag over the analytic one, at the middle point [1]
    mesh: float | None = None  # relative change of the drag on a coarser mesh [1]
    hull: float | None = None  # share of the hull in the drag, at the middle point [1]


class AeroProvenance(StrictModel):
    """The origin of the coefficients."""

    engine: str
    fidelity: Literal['analytic', 'preview', 'reference']
    geometry: str
    density: Annotated[Quantity, si_quantity('kg/m3', above=0.0, sourced=True)]
    axes: Mapping[str, DragFitQuality]
    # Lift and moment at the middle speed, which the model's diagonal drag cannot represent
    beside: Mapping[str, str] = Field(default_factory=dict)
    warnings: list[str] = Field(default_factory=list)


class AeroFile(StrictModel):
    """An aero file."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
    vehicle: str
    evidence: AeroProvenance
    aero: AeroCoefficients


def load_aero_file(name: str) -> AeroFile:
    """Return an aero file by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(AeroFile, find_file('aero', name, SUFFIX))
