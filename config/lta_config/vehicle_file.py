"""
The vehicle file: parts, rotors, an aero block and effects, every number with unit and source.

The models below are the schema; `lta_sim.vehicle` derives from it what the cores need.
"""

from collections.abc import Mapping
from typing import Annotated, Literal

from lta_config.files import find, load, Record
from lta_config.quantity import Quantity, si
from pydantic import AliasChoices, Field, model_validator

Length = Annotated[Quantity, si('m', above=0.0, sourced=True)]
Place = Annotated[Quantity, si('m', low=-20.0, high=20.0, length=3, sourced=True)]
Mass = Annotated[Quantity, si('kg', above=0.0, high=100.0, sourced=True)]
Fraction = Annotated[Quantity, si('1', low=0.0, high=1.0, sourced=True)]
Power = Annotated[Quantity, si('W', low=0.0, sourced=True)]


class Hull(Record):
    """The envelope: a balloon of revolution about body z, filled with helium of some purity."""

    diameter: Length
    height: Length
    volume_factor: Annotated[Quantity, si('1', above=0.0, sourced=True)]
    purity: Fraction


class Trim(Record):
    """How much heavier than air the vehicle is flown, and where the ballast for it goes."""

    heaviness: Annotated[Quantity, si('kg', low=-0.1, high=1.0, sourced=True)]
    ballast_position: Place


class Part(Record):
    """A body with mass, centre and outer size; `shell` is a thin ellipsoid, `box` a solid box."""

    shape: Literal['shell', 'box']
    mass: Mass
    position: Place
    size: Annotated[Quantity, si('m', above=0.0, length=3, sourced=True)]


class Rotor(Record):
    """One rotor; only a reversible one accepts negative duty."""

    reversible: bool
    position: Place


class ThrustCurve(Record):
    """T = a u^2 + b u."""

    a: Annotated[Quantity, si('N', low=0.0, sourced=True)]
    b: Annotated[Quantity, si('N', above=0.0, sourced=True)]


class Drag(Record):
    """Drag coefficients along and about x, y, z."""

    force: Quantity
    moment: Quantity


class LinearDrag(Drag):
    """Proportional to the speed."""

    force: Annotated[Quantity, si('N s/m', low=0.0, length=3, sourced=True)]
    moment: Annotated[Quantity, si('N m s', low=0.0, length=3, sourced=True)]


class QuadraticDrag(Drag):
    """Proportional to the square of the speed."""

    force: Annotated[Quantity, si('N s2/m2', low=0.0, length=3, sourced=True)]
    moment: Annotated[Quantity, si('N m s2', low=0.0, length=3, sourced=True)]


class RotorColumn(Record):
    """One column of B: wrench about the hull centre per newton of the rotor's thrust."""

    force: Annotated[Quantity, si('1', low=-1.5, high=1.5, length=3, sourced=True)]
    moment: Annotated[Quantity, si('m', low=-5.0, high=5.0, length=3, sourced=True)]


class Aero(Record):
    """What a wind tunnel says, about the hull centre."""

    linear_drag: LinearDrag
    quadratic_drag: QuadraticDrag
    thrust_allocation: Mapping[str, RotorColumn]


class Diodes(Record):
    """The ring of photodiodes, the first facing forward."""

    count: Annotated[int, Field(ge=1, le=64)]
    radius: Length
    height: Annotated[Quantity, si('m', low=-5.0, high=5.0, sourced=True)]
    feedback: Annotated[Quantity, si('ohm', above=0.0, sourced=True)]


class Sensors(Record):
    """Where the sensors sit."""

    imu_position: Place
    range_position: Place
    panel_position: Place
    diodes: Diodes


class Energy(Record):
    """Battery, consumers and panel."""

    capacity: Annotated[Quantity, si('C', above=0.0, sourced=True)]
    resistance: Annotated[Quantity, si('ohm', low=0.0, sourced=True)]
    idle: Power
    transmitting: Power
    rotor_idle: Power
    rotor_power: Annotated[Quantity, si('W/N', low=0.0, sourced=True)]
    panel_area: Annotated[Quantity, si('m2', low=0.0, sourced=True)]
    panel_efficiency: Fraction
    panel_voltage: Annotated[Quantity, si('V', above=0.0, sourced=True)]


class VehicleFile(Record):
    """A whole vehicle file."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
    about: str
    hull: Hull
    trim: Trim
    parts: Annotated[Mapping[str, Part], Field(min_length=1)]
    rotors: Mapping[str, Rotor]
    thrust_curve: ThrustCurve
    aero: Aero
    effects: Mapping[str, Mapping[str, Quantity]]
    sensors: Sensors
    energy: Energy

    @model_validator(mode='after')
    def _columns_match_rotors(self) -> 'VehicleFile':
        if list(self.aero.thrust_allocation) != list(self.rotors):
            raise ValueError(
                f'names the rotors {", ".join(self.rotors)} but the columns of thrust_allocation '
                f'{", ".join(self.aero.thrust_allocation)}; use the same names in the same order'
            )
        return self


def load_vehicle_file(name: str) -> VehicleFile:
    """Return a vehicle file by shipped name or path; anything wrong is a `BadInput` sentence."""
    return load(VehicleFile, find('vehicle', name))
