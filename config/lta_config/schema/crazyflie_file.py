"""The Crazyflie file: how the Crazyflie aboard a vehicle is commanded, wired, set and limited."""

from collections.abc import Mapping
from typing import Annotated, Final, Literal

from lta_config.errors import BadInput
from lta_config.files import (
    find_file,
    FOLDERS,
    list_shipped,
    load_yaml,
    StrictModel,
    validate_content,
)
from lta_config.quantity import Quantity, si_quantity
from pydantic import AliasChoices, Field, model_validator

MOTORS = ('m1', 'm2', 'm3', 'm4')
BESIDE = '.crazyflie.yaml'  # in place of a vehicle file's own ending


class ExpectedParameter(StrictModel):
    """What a parameter must be, whether the bridge writes it, and why."""

    value: float
    write: bool
    why: str


# What every drone must meet, whichever firmware it has; a Crazyflie file adds to it.
REQUIRED: Final[Mapping[str, ExpectedParameter]] = {
    'motorPowerSet.enable': ExpectedParameter(
        value=0,
        write=True,
        why='the override turns motors whatever watchdog, lock and disarming say (motors.c)',
    ),
    'powerDist.idleThrust': ExpectedParameter(
        value=0,
        write=True,
        why='motors would turn as soon as the drone is armed, 7000 of 65535 by default '
        '(power_distribution_quadrotor.c)',
    ),
    'supervisor.landedTimeout': ExpectedParameter(
        value=3000,
        write=True,
        why='a longer one keeps a landed drone armed with nobody watching',
    ),
    'supervisor.tmblChckEn': ExpectedParameter(
        value=1, write=True, why='a drone that has tipped over must stop its motors'
    ),
}


class FlightLimits(StrictModel):
    """What ends a flight."""

    voltage: Annotated[Quantity, si_quantity('V', above=0.0, sourced=True)]
    time: Annotated[Quantity, si_quantity('s', above=0.0, sourced=True)]
    height: Annotated[Quantity, si_quantity('m', above=0.0, sourced=True)]
    distance: Annotated[Quantity, si_quantity('m', above=0.0, sourced=True)]


class CrazyflieFile(StrictModel):
    """
    A whole file.

    Its `parameters` are those beside `REQUIRED`; `expected` has both.
    """

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    vehicle: str
    command: Literal['setpoint', 'motors']
    motors: Mapping[str, str]
    parameters: Mapping[Annotated[str, Field(pattern=r'^\w+\.\w+$')], ExpectedParameter] = Field(
        default_factory=dict
    )
    limits: FlightLimits

    @model_validator(mode='after')
    def _check_motors(self) -> 'CrazyflieFile':
        if tuple(self.motors) != MOTORS or len(set(self.motors.values())) != len(MOTORS):
            raise ValueError(
                f'has the motors {dict(self.motors)}; name one rotor each for m1, m2, m3, m4'
            )
        return self

    @model_validator(mode='after')
    def _check_required(self) -> 'CrazyflieFile':
        for name, want in self.parameters.items():
            required = REQUIRED.get(name)
            if required is not None and want.value != required.value:
                raise ValueError(
                    f'sets the parameter {name} to {want.value:g}, which must be '
                    f'{required.value:g} on every drone ({required.why}); remove that line'
                )
        return self

    @property
    def expected(self) -> Mapping[str, ExpectedParameter]:
        """What each parameter must be: what every drone must meet first, then the file's own."""
        return {**REQUIRED, **self.parameters, **REQUIRED}


def load_crazyflie(name: str, vehicle: str = '') -> CrazyflieFile:
    """
    Return a Crazyflie file.

    Parameters
    ----------
    name : str
        Of a shipped one, which is its vehicle's, or a path.
    vehicle : str
        What flies, by the name in its own file; the same name where empty.

    Raises
    ------
    BadInput
        If it cannot be read, or is of another vehicle: rotors that are named alike are wired and
        limited otherwise.

    """
    path = find_file('crazyflie', name)
    file = validate_content(CrazyflieFile, load_yaml(path), str(path))
    vehicle = vehicle or name
    if file.vehicle != vehicle:
        raise BadInput(
            f"'{path}' is for {file.vehicle}, and {vehicle} flies; give the Crazyflie file of "
            f'{vehicle}, or a copy with its wiring and limits that says vehicle: {vehicle}.'
        )
    return file


def find_crazyflie(vehicle: str, name: str, other: str = '') -> CrazyflieFile:
    """
    Return the Crazyflie file that a vehicle flies with.

    Parameters
    ----------
    vehicle : str
        Name of a shipped vehicle, or the path of its file.
    name : str
        Of the vehicle, in that file.
    given : str
        Name or path of another Crazyflie file. By default it is `VEHICLE.crazyflie.yaml` beside
        the vehicle's own file, and else the shipped one of its name.

    Raises
    ------
    BadInput
        If there is none, or it cannot be read, or is of another vehicle.

    """
    beside = find_file('vehicle', vehicle).with_suffix(BESIDE)
    if other:
        return load_crazyflie(other, name)
    if beside.is_file():
        return load_crazyflie(str(beside), name)
    if name not in (names := list_shipped(FOLDERS['crazyflie'])):
        raise BadInput(
            f'{name} has no Crazyflie file, which says how its motors are wired and what ends a '
            f'flight; write {beside.name} beside its own file, after one of {", ".join(names)}.'
        )
    return load_crazyflie(name)
