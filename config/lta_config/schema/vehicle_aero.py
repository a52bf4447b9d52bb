# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Aerodynamic coefficients in the vehicle file and the aero file, and the tunnel file."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from lta_config.errors import BadInput
from lta_config.files import find_file, load_file, load_yaml, Name, SchemaVersion, StrictModel
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.vehicle_body import Length, Place
from pydantic import Field, model_validator

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


Duty = Annotated[float, Field(ge=-1.0, le=1.0)]


class TunnelBody(StrictModel):
    """A box by its centre and outer size, or the closed surface in an STL file."""

    position: Place | None = None
    size: Annotated[Quantity, si_quantity('m', above=0.0, length=3, sourced=True)] | None = None
    stl: str | None = None  # path relative to the tunnel file
    unit: Literal['m', 'cm', 'mm'] | None = None  # of the STL file, which has none itself

    @model_validator(mode='after')
    def _check_shape(self) -> 'TunnelBody':
        box = self.position is not None and self.size is not None
        has_mesh = self.stl is not None and self.unit is not None
        # Both or neither
        if box == has_mesh:
            raise ValueError('needs either "position" and "size" of a box, or "stl" and "unit"')
        return self


class TunnelRotorDisk(StrictModel):
    """The actuator disk of each rotor, where a force acts on the air."""

    diameter: Length
    thickness: Length


class TunnelFile(StrictModel):
    """A tunnel file; bodies by name, of which `envelope` replaces the hull's surface."""

    schema_version: SchemaVersion
    name: Name
    about: str
    vehicle: str
    disk: TunnelRotorDisk | None = None  # without it the rotors are off
    bodies: Mapping[Name, TunnelBody] = Field(default_factory=dict)
    # Share of full thrust of rotors that run together, by name of the pattern
    patterns: Mapping[Name, Mapping[str, Duty]] = Field(default_factory=dict)

    @model_validator(mode='after')
    def _check_patterns(self) -> 'TunnelFile':
        if self.patterns and self.disk is None:
            raise ValueError(
                'has "patterns" but no "disk"; add the diameter and thickness of the rotor disks'
            )
        return self


def load_tunnel_file(name: str) -> tuple[TunnelFile, Path]:
    """Return a tunnel file by shipped name or path, and its path."""
    path = find_file('tunnel', name)
    _refuse_vehicle(path)
    return load_file(TunnelFile, path), path


def _refuse_vehicle(path: Path) -> None:
    """Raise `BadInput` for a vehicle file: its errors as a tunnel file would be misleading."""
    content = load_yaml(path)
    if isinstance(content, dict) and {'hull', 'rotors'} <= content.keys():
        raise BadInput(
            f'{path} is a vehicle file, not a tunnel file; copy one of config/tunnels and '
            f'write "vehicle: {path}" in the copy.'
        )
