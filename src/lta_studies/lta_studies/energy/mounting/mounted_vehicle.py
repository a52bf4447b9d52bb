"""
Build a vehicle with a panel mount, in its own hull or in one with a larger volume.

A mount that is too heavy for the hull is not rejected. The lacking lift is reported, and the
volume that a hull of the same outline would need. In that hull all mounts are compared on equal
terms: lighter mounts get more ballast, as the vehicle file trims it.
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

ROOMY = 3.0  # volume factor that can carry any mount; used to compute the required lift
STEP = 1e-3  # resolution of the volume factor


@final
@dataclass(frozen=True, slots=True)
class MountedVehicle:
    """A vehicle with a mount."""

    mount: MountFile
    ahead: float  # forward misplacement of the panels [m]
    fuller: float  # volume of the hull relative to the file, with the same outline [1]
    content: Mapping[str, Any]  # content of the vehicle file
    vehicle: Vehicle  # the resulting vehicle

    @property
    def nose_down_pitch(self) -> float:
        """Nose-down pitch at rest, from the centre of gravity. [rad]"""
        x, _, z = self.vehicle.cg
        # At rest the centre of gravity hangs vertically below the centre of buoyancy.
        return math.atan2(float(x), -float(z))


def build_mounted_vehicle(
    content: Mapping[str, Any], name: str, ahead: float = 0.0, fuller: float = 1.0
) -> MountedVehicle:
    """
    Build a vehicle with a mount.

    Parameters
    ----------
    content : mapping
        Content of the vehicle file.
    name : str
        Shipped name or path of the mount.
    ahead : float
        Forward misplacement of the panels. [m]
    fuller : float
        Volume of the hull relative to the file. [1]

    Raises
    ------
    BadInput
        If the hull cannot carry it, or the file or the mount cannot be used.

    """
    mounted = mount_panels(content, name, ahead)
    if fuller != 1.0:
        mounted = _enlarge_hull(mounted, fuller)
    where = f'{content.get("name", "the vehicle")} with the mount {name}'
    return MountedVehicle(
        load_mount(name),
        ahead,
        fuller,
        mounted,
        Vehicle(validate_content(VehicleFile, mounted, where)),
    )


def lift_deficit(content: Mapping[str, Any], name: str) -> float:
    """Return the lift that the hull lacks to fly a mount at the file's heaviness. [kg]"""
    roomy = build_mounted_vehicle(content, name, fuller=ROOMY).vehicle
    # The roomy hull has this much more lift than the real one; ballast took up the unused part.
    return roomy.gross_lift * (1.0 - 1.0 / ROOMY) - roomy.ballast_mass


def required_volume_factor(content: Mapping[str, Any], names: Sequence[str]) -> float:
    """Return the volume factor that carries every mount; 1 if the hull does. [1]"""
    most = 1.0
    for name in names:
        roomy = build_mounted_vehicle(content, name, fuller=ROOMY).vehicle
        # Lift is proportional to volume: shrink the roomy hull until no ballast is left.
        most = max(most, ROOMY * (1.0 - roomy.ballast_mass / roomy.gross_lift))
    # Rounded up to the resolution; 1e-9 keeps an exact multiple.
    return math.ceil(most / STEP - 1e-9) * STEP


def _enlarge_hull(content: dict[str, Any], fuller: float) -> dict[str, Any]:
    """Return the vehicle file with a larger hull volume and the same outline."""
    hull = validate_content(VehicleFile, content, content['name']).hull
    if hull.volume_factor is None:
        raise BadInput(
            f'The hull of {content["name"]} has no volume_factor, so it cannot be enlarged '
            'to carry the mount; choose another vehicle, such as gtmab.'
        )
    factor = {
        'value': hull.volume_factor.si * fuller, 'unit': '1',
        'source': 'enlarged to carry the mounts',
    }  # fmt: skip
    return {**content, 'hull': {**content['hull'], 'volume_factor': factor}}
