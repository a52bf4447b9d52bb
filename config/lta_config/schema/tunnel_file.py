"""
The tunnel file: what of a vehicle stands in the wind tunnel, and which rotors blow together.

Hull and rotors are those of the vehicle file. What hangs below is given here as few plain bodies:
a mesh has no use for a battery inside a box.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from lta_config.errors import BadInput
from lta_config.files import find_file, load_file, load_yaml, StrictModel
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.vehicle_body import Length, Place
from pydantic import AliasChoices, Field, model_validator

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
Duty = Annotated[float, Field(ge=-1.0, le=1.0)]


class TunnelBody(StrictModel):
    """A box by its centre and outer size, or the closed surface in an STL file."""

    position: Place | None = None
    size: Annotated[Quantity, si_quantity('m', above=0.0, length=3, sourced=True)] | None = None
    stl: str | None = None  # beside the tunnel file
    unit: Literal['m', 'cm', 'mm'] | None = None  # that the STL file is in

    @model_validator(mode='after')
    def _check_shape(self) -> 'TunnelBody':
        box = self.position is not None and self.size is not None
        given = self.stl is not None and self.unit is not None
        if box == given:
            raise ValueError('needs either position and size of a box, or stl and its unit')
        return self


class TunnelRotorDisk(StrictModel):
    """The disk of each rotor: the air in it is pushed."""

    diameter: Length
    thickness: Length


class TunnelFile(StrictModel):
    """A whole tunnel file; bodies by name, `envelope` replaces the hull's own surface."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Name
    about: str
    vehicle: str
    disk: TunnelRotorDisk | None = None  # without it no rotor blows
    bodies: Mapping[Name, TunnelBody] = Field(default_factory=dict)
    # Share of full thrust of rotors that blow together, by name of the pattern.
    patterns: Mapping[Name, Mapping[str, Duty]] = Field(default_factory=dict)

    @model_validator(mode='after')
    def _check_patterns(self) -> 'TunnelFile':
        if self.patterns and self.disk is None:
            raise ValueError('has patterns of rotors but no disk; give its diameter and thickness')
        return self


def load_tunnel_file(name: str) -> tuple[TunnelFile, Path]:
    """Return a tunnel file by shipped name or path, and where it is."""
    path = find_file('tunnel', name)
    _refuse_vehicle(path)
    return load_file(TunnelFile, path), path


def _refuse_vehicle(path: Path) -> None:
    """Refuse a vehicle file by what it is: its faults as a tunnel file would help nobody."""
    content = load_yaml(path)
    if isinstance(content, dict) and {'hull', 'rotors'} <= content.keys():
        raise BadInput(
            f'{path} is a vehicle file, not a tunnel file; copy one of config/tunnels and name '
            f'this one in it (vehicle: {path}).'
        )
