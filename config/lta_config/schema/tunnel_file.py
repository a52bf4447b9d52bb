"""
The tunnel file: the bodies of a vehicle in the wind tunnel, and rotors that run together.

Hull and rotors are taken from the vehicle file. What hangs below is given here as a few simple
bodies, because a mesh does not need a battery inside a box.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from lta_config.errors import BadInput
from lta_config.files import find_file, load_file, load_yaml, Name, SchemaVersion, StrictModel
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.vehicle_body import Length, Place
from pydantic import Field, model_validator

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
