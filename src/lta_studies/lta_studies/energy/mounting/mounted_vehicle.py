"""
A vehicle with its panels mounted one way or another, in its own hull or in a fuller one.

A mount that the hull cannot carry is not refused but told: how much is lacking, and how much
fuller a hull of the same outline would have to be. In that hull all mounts are compared on equal
terms: what a lighter mount saves becomes ballast, as the vehicle's file trims it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.files import validate_content
from lta_config.schema.mount_file import load_mount, mount_panels, MountFile
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.vehicle import Vehicle

ROOMY = 3.0  # times fuller: carries whatever anybody mounts, so that what is needed can be told
STEP = 1e-3  # to which a hull is made fuller


@final
@dataclass(frozen=True, slots=True)
class MountedVehicle:
    """
    A vehicle with a mount.

    Attributes
    ----------
    mount : Mount
        The mount.
    ahead : float
        How far ahead of their places the panels sit. [m]
    fuller : float
        Volume of the hull by that of the file's, the outline the same. [1]
    content : mapping
        The vehicle file, as YAML holds it.
    vehicle : Vehicle
        What follows.

    """

    mount: MountFile
    ahead: float
    fuller: float
    content: Mapping[str, Any]
    vehicle: Vehicle

    @property
    def rest_lean(self) -> float:
        """How far the nose hangs down at rest, by the centre of gravity alone. [rad]"""
        x, _, z = self.vehicle.cg
        return math.atan2(float(x), -float(z))


def build_mounted_vehicle(
    content: Mapping[str, Any], name: str, ahead: float = 0.0, fuller: float = 1.0
) -> MountedVehicle:
    """
    Return a vehicle with a mount.

    Parameters
    ----------
    content : mapping
        The vehicle file as YAML holds it.
    name : str
        Mount: shipped name or path.
    ahead : float
        How far ahead of their places the panels sit, by mistake. [m]
    fuller : float
        Volume of the hull by that of the file's. [1]

    Raises
    ------
    BadInput
        If the hull cannot carry it, or the file or the mount cannot be used.

    """
    made = mount_panels(content, name, ahead)
    if fuller != 1.0:
        made = _enlarge_hull(made, fuller)
    where = f'{content.get("name", "the vehicle")} with the mount {name}'
    return MountedVehicle(
        load_mount(name), ahead, fuller, made, Vehicle(validate_content(VehicleFile, made, where))
    )


def lacking_lift(content: Mapping[str, Any], name: str) -> float:
    """Return how much lift is lacking to fly a mount as heavy as the file says. [kg]"""
    roomy = build_mounted_vehicle(content, name, fuller=ROOMY).vehicle
    return roomy.gross_lift * (1.0 - 1.0 / ROOMY) - roomy.ballast_mass


def required_fullness(content: Mapping[str, Any], names: Sequence[str]) -> float:
    """Return how much fuller the hull must be to carry every mount; 1 where it does. [1]"""
    most = 1.0
    for name in names:
        roomy = build_mounted_vehicle(content, name, fuller=ROOMY).vehicle
        most = max(most, ROOMY * (1.0 - roomy.ballast_mass / roomy.gross_lift))
    return math.ceil(most / STEP - 1e-9) * STEP


def _enlarge_hull(content: dict[str, Any], fuller: float) -> dict[str, Any]:
    """Return a vehicle file with a fuller hull of the same outline."""
    hull = validate_content(VehicleFile, content, content['name']).hull
    if hull.volume_factor is None:
        raise BadInput(
            f'{content["name"]} has no balloon for a hull, whose fullness could be changed; take '
            'a vehicle with one, such as gtmab.'
        )
    factor = {
        'value': hull.volume_factor.si * fuller, 'unit': '1', 'source': 'a hull that carries it',
    }  # fmt: skip
    return {**content, 'hull': {**content['hull'], 'volume_factor': factor}}
