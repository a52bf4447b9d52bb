# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The Crazyflie file: command mode, wiring, parameters and limits of a vehicle's Crazyflie.

A board and a vehicle file recognize each other by a hash.
"""

from collections.abc import Mapping
import json
from typing import Annotated, Any, Final, Literal
import zlib

from lta_config.errors import BadInput
from lta_config.files import (
    find_file,
    KIND_FOLDERS,
    list_shipped_names,
    load_yaml,
    SchemaVersion,
    StrictModel,
    validate_content,
)
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.vehicle_file import VehicleFile
from pydantic import Field, model_validator

CF_MOTORS = ('m1', 'm2', 'm3', 'm4')
CRAZYFLIE_SUFFIX = '.crazyflie.yaml'  # replaces the suffix of the vehicle file


class ExpectedParameter(StrictModel):
    """The required value of a firmware parameter, whether the bridge writes it, and why."""

    value: float
    write: bool
    why: str


# Required on every drone with any firmware; a Crazyflie file adds further parameters
REQUIRED: Final[Mapping[str, ExpectedParameter]] = {
    'motorPowerSet.enable': ExpectedParameter(
        value=0,
        write=True,
        why='otherwise watchdog, lock and disarming cannot stop the motors, see motors.c',
    ),
    'powerDist.idleThrust': ExpectedParameter(
        value=0,
        write=True,
        why='otherwise the motors turn as soon as the drone is armed; the default is 7000 of '
        '65535, see power_distribution_quadrotor.c',
    ),
    'supervisor.landedTimeout': ExpectedParameter(
        value=3000,  # ms
        write=True,
        why='with a longer timeout, a landed drone stays armed unattended',
    ),
    'supervisor.tmblChckEn': ExpectedParameter(
        value=1, write=True, why='a drone that has tipped over must stop its motors'
    ),
}


class FlightLimits(StrictModel):
    """Limits that end a flight."""

    voltage: Annotated[Quantity, si_quantity('V', above=0.0, sourced=True)]
    time: Annotated[Quantity, si_quantity('s', above=0.0, sourced=True)]
    height: Annotated[Quantity, si_quantity('m', above=0.0, sourced=True)]
    distance: Annotated[Quantity, si_quantity('m', above=0.0, sourced=True)]


class CrazyflieFile(StrictModel):
    """
    A Crazyflie file.

    `parameters` excludes `REQUIRED`; `expected` includes it.
    """

    schema_version: SchemaVersion
    vehicle: str
    command: Literal['setpoint', 'motors']
    motors: Mapping[str, str]
    parameters: Mapping[Annotated[str, Field(pattern=r'^\w+\.\w+$')], ExpectedParameter] = Field(
        default_factory=dict
    )
    limits: FlightLimits

    @model_validator(mode='after')
    def _check_motors(self) -> 'CrazyflieFile':
        if tuple(self.motors) != CF_MOTORS or len(set(self.motors.values())) != len(CF_MOTORS):
            raise ValueError(
                f'has the motors {dict(self.motors)}; assign a different rotor to each of m1, m2, '
                'm3 and m4, in this order'
            )
        return self

    @model_validator(mode='after')
    def _check_required(self) -> 'CrazyflieFile':
        for name, want in self.parameters.items():
            required = REQUIRED.get(name)
            if required is not None and want.value != required.value:
                raise ValueError(
                    f'sets the firmware parameter {name} to {want.value:g}, but it must be '
                    f'{required.value:g} on every drone ({required.why}); remove that line'
                )
        return self

    @property
    def expected(self) -> Mapping[str, ExpectedParameter]:
        """All expected parameters, those required on every drone first."""
        # The first mapping sets the order, the last one the values
        return {**REQUIRED, **self.parameters, **REQUIRED}


def load_crazyflie(name: str, vehicle: str = '') -> CrazyflieFile:
    """
    Return a Crazyflie file.

    Parameters
    ----------
    name : str
        Name of a shipped file, which is that of its vehicle, or a path.
    vehicle : str
        The flown vehicle, by the name in its file; by default `name`.

    Raises
    ------
    BadInput
        If it cannot be read, or is for another vehicle: rotors with the same names may have other
        wiring and limits.

    """
    path = find_file('crazyflie', name)
    file = validate_content(CrazyflieFile, load_yaml(path), str(path))
    vehicle = vehicle or name
    if file.vehicle != vehicle:
        raise BadInput(
            f"'{path}' is for the vehicle {file.vehicle}, but {vehicle} is to fly; give the "
            f'Crazyflie file of {vehicle}, or copy this one, adapt its motors and limits, and set '
            f'"vehicle: {vehicle}".'
        )
    return file


def find_crazyflie(vehicle: str, name: str, other: str = '') -> CrazyflieFile:
    """
    Return the Crazyflie file of a vehicle.

    Parameters
    ----------
    vehicle : str
        Name of a shipped vehicle, or the path of its file.
    name : str
        The vehicle's name in that file.
    other : str
        Name or path of another Crazyflie file. By default it is `VEHICLE.crazyflie.yaml` next to
        the vehicle's own file, or the shipped one with its name.

    Raises
    ------
    BadInput
        If there is none, it cannot be read, or it is for another vehicle.

    """
    beside = find_file('vehicle', vehicle).with_suffix(CRAZYFLIE_SUFFIX)
    # An explicit file has priority over the one next to the vehicle
    if other:
        return load_crazyflie(other, name)
    if beside.is_file():
        return load_crazyflie(str(beside), name)
    if name not in (names := list_shipped_names(KIND_FOLDERS['crazyflie'])):
        raise BadInput(
            f'The vehicle {name} has no Crazyflie file (motor wiring and flight limits); create '
            f'{beside.name} next to the vehicle file, starting from a copy in config/crazyflies '
            f'({", ".join(names)}).'
        )
    return load_crazyflie(name)


HASHED_DECIMALS = 6  # decimals of a number in SI units


def hash_airframe(vehicle: VehicleFile, file: CrazyflieFile) -> int:
    """Return the hash of a vehicle's name, rotors and motor wiring, 32 bits."""
    rotors = {
        name: [rotor.reversible, _to_numbers(rotor.position), _to_numbers(rotor.axis)]
        for name, rotor in vehicle.rotors.items()
    }
    return _hash({'name': vehicle.name, 'rotors': rotors, 'motors': dict(file.motors)})


def hash_diodes(vehicle: VehicleFile) -> int:
    """Return the hash of a vehicle's name and of the directions of its photodiodes, 32 bits."""
    diodes = vehicle.sensors.diodes
    axes = diodes.axes.value if diodes.axes else None
    return _hash({'name': vehicle.name, 'count': diodes.count, 'axes': axes})


def _to_numbers(quantity: Quantity) -> list[float]:
    return [round(number, HASHED_DECIMALS) + 0.0 for number in quantity.vector]


def _hash(content: Mapping[str, Any]) -> int:
    return zlib.crc32(json.dumps(content, sort_keys=True).encode()) or 1
