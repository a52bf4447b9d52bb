"""The Crazyflie file: how the Crazyflie aboard a vehicle is commanded, wired, set and limited."""

from collections.abc import Mapping
from typing import Annotated, Literal

from lta_config.files import checked, find, load_yaml, Record
from lta_config.quantity import Quantity, si
from pydantic import AliasChoices, Field, model_validator

MOTORS = ('m1', 'm2', 'm3', 'm4')


class Expected(Record):
    """What a parameter must be, whether the bridge writes it, and why."""

    value: float
    write: bool
    why: str


class FlightLimits(Record):
    """What ends a flight."""

    voltage: Annotated[Quantity, si('V', above=0.0, sourced=True)]
    time: Annotated[Quantity, si('s', above=0.0, sourced=True)]
    height: Annotated[Quantity, si('m', above=0.0, sourced=True)]
    distance: Annotated[Quantity, si('m', above=0.0, sourced=True)]


class CrazyflieFile(Record):
    """A whole file."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    vehicle: str
    command: Literal['setpoint', 'motors']
    motors: Mapping[str, str]
    parameters: Mapping[Annotated[str, Field(pattern=r'^\w+\.\w+$')], Expected]
    limits: FlightLimits

    @model_validator(mode='after')
    def _every_motor_has_a_rotor(self) -> 'CrazyflieFile':
        if tuple(self.motors) != MOTORS or len(set(self.motors.values())) != len(MOTORS):
            raise ValueError(
                f'has the motors {dict(self.motors)}; name one rotor each for m1, m2, m3, m4'
            )
        return self


def load_crazyflie(name: str) -> CrazyflieFile:
    """Return the Crazyflie file of a vehicle by its name, or by path; `BadInput` otherwise."""
    path = find('crazyflie', name)
    return checked(CrazyflieFile, load_yaml(path), str(path))
