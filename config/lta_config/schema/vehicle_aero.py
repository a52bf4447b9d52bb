"""
Aerodynamic coefficients: the aero block of a vehicle file, and the aero file.

The block has drag along and about the axes, and the rotor columns. It may also name an aero file,
which `lta cfd run` writes: coefficients fitted to wind-tunnel results, with the evidence for them.
A vehicle file with `aero: gtmab` uses its aero block.
"""

from collections.abc import Mapping
from typing import Annotated, Literal

from lta_config.files import find_file, load_file, Name, SchemaVersion, StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import Field

Force = Annotated[Quantity, si_quantity('1', low=-1.5, high=1.5, length=3, sourced=True)]
Moment = Annotated[Quantity, si_quantity('m', low=-5.0, high=5.0, length=3, sourced=True)]


class DragCoefficients(StrictModel):
    """Drag coefficients along and about x, y, z."""

    force: Quantity
    moment: Quantity


class LinearDrag(DragCoefficients):
    """Drag proportional to the speed."""

    force: Annotated[Quantity, si_quantity('N s/m', low=0.0, length=3, sourced=True)]
    moment: Annotated[Quantity, si_quantity('N m s', low=0.0, length=3, sourced=True)]


class QuadraticDrag(DragCoefficients):
    """Drag proportional to the square of the speed."""

    force: Annotated[Quantity, si_quantity('N s2/m2', low=0.0, length=3, sourced=True)]
    moment: Annotated[Quantity, si_quantity('N m s2', low=0.0, length=3, sourced=True)]


class WrenchPerNewton(StrictModel):
    """Force and moment about the hull centre per newton of thrust."""

    force: Force
    moment: Moment


class RotorColumn(WrenchPerNewton):
    """One column of B; `reverse` is that of reversed thrust, if it differs."""

    reverse: WrenchPerNewton | None = None


class RotorCoupling(WrenchPerNewton):
    """The joint effect of the jets of some rotors, per newton of the weakest of them."""

    rotors: Annotated[list[str], Field(min_length=2)]
    reversed: bool = False  # whether it applies to reversed thrust


class AeroCoefficients(StrictModel):
    """
    Aerodynamic coefficients about the hull centre.

    A rotor without a column in `thrust_allocation` gets it from its position and axis. The motor's
    torque is added in both cases, because a column describes jets without swirl.
    """

    linear_drag: LinearDrag
    quadratic_drag: QuadraticDrag
    thrust_allocation: Mapping[str, RotorColumn] = Field(default_factory=dict)
    coupling: RotorCoupling | None = None


AERO_SUFFIX = '.aero.yaml'


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

    schema_version: SchemaVersion
    name: Name
    vehicle: str
    evidence: AeroProvenance
    aero: AeroCoefficients


def load_aero_file(name: str) -> AeroFile:
    """Return an aero file by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(AeroFile, find_file('aero', name, AERO_SUFFIX))
