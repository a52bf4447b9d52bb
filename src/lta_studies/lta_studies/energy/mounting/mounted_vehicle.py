# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build a vehicle with a panel mount, in its own or a larger hull, and light its panels.

A mount that is too heavy for the hull is not rejected. The lacking lift is reported, and the
volume that a hull of the same outline would need. In that hull all mounts are compared on equal
terms: lighter mounts get more ballast, as the vehicle file trims it.

Shares of light are relative to an unshaded plate that faces the light, or to a level plate for an
overcast sky. The hull is an opaque spheroid. Panels in series carry the same current, so that
without bypass diodes the darkest one limits the string; separate panels each deliver their own.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.files import validate_content
from lta_config.schema.mount_file import load_mount, mount_panels, MountFile
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.effects.protocol import Vector
from lta_model.light.direct_light import visible_fraction
from lta_model.mass_properties import half_axes
from lta_model.vehicle import Vehicle
import numpy as np

SUN_ANGULAR_RADIUS = 4.65e-3  # rad, angular radius of the sun
PANEL_POINTS = 5  # points along each side of a panel
RAYS_AROUND, SKY_RINGS = 24, 18  # azimuths, and elevation rings of the sky
PANEL_OFFSET = 1e-3  # m above the face, so that rays do not start inside the hull


@final
@dataclass(frozen=True, slots=True)
class LightDirection:
    """A named light at an elevation [rad]; None is an overcast sky."""

    name: str
    height: float | None


LIGHT_DIRECTIONS = (
    LightDirection('overhead', math.radians(90.0)),
    LightDirection('45° up', math.radians(45.0)),
    LightDirection('20° up', math.radians(20.0)),
    LightDirection('level', 0.0),
    LightDirection('overcast sky', None),
)


@final
@dataclass(frozen=True, slots=True)
class PanelLightShares:
    """Shares of light, mean over all headings: panels in series, and separately [1]."""

    series: float
    apart: float


def compute_light_shares(
    vehicle: Vehicle, mount: MountFile, light: LightDirection
) -> PanelLightShares:
    """Compute the light on the panels of a mount on a level vehicle."""
    if light.height is None:
        return _compute_overcast_shares(vehicle, mount)
    series, apart = [], []
    for towards in _iterate_directions(light.height):
        shares = [panel_light_share(vehicle, mount, panel, towards) for panel in mount.panels]
        # Same current in all panels: the darkest limits the string.
        series.append(min(shares))
        apart.append(sum(shares) / len(shares))
    return PanelLightShares(float(np.mean(series)), float(np.mean(apart)))


def _compute_overcast_shares(vehicle: Vehicle, mount: MountFile) -> PanelLightShares:
    """Compute the shares under a uniformly bright sky, with no light from below."""
    shares = np.zeros(len(mount.panels))
    level = 0.0
    for ring in range(SKY_RINGS):
        low, high = (0.5 * math.pi * k / SKY_RINGS for k in (ring, ring + 1))
        patch = math.sin(high) - math.sin(low)  # solid angle of the ring / 2 pi
        height = 0.5 * (low + high)
        # Light on a level plate: the cosine law, weighted by solid angle
        level += patch * math.sin(height)
        for k, panel in enumerate(mount.panels):
            around = [
                panel_light_share(vehicle, mount, panel, towards)
                for towards in _iterate_directions(height)
            ]
            shares[k] += patch * float(np.mean(around))
    shares /= level
    return PanelLightShares(float(shares.min()), float(shares.mean()))


def _iterate_directions(height: float) -> Iterator[Vector]:
    """Yield directions at an elevation [rad]; only one at the zenith."""
    flat = math.cos(height)
    count = 1 if flat < 1e-9 else RAYS_AROUND
    for k in range(count):
        # Half a step off the axes of symmetry of the vehicle
        turn = 2.0 * math.pi * (k + 0.5) / count
        yield flat * math.cos(turn), flat * math.sin(turn), math.sin(height)


def panel_light_share(vehicle: Vehicle, mount: MountFile, panel: str, towards: Vector) -> float:
    """Return the share of light on one panel from a direction [1]."""
    facing = sum(a * b for a, b in zip(mount.panels[panel].normal.vector, towards, strict=True))
    # The light comes from behind the panel.
    if facing <= 0.0:
        return 0.0
    axes = half_axes(vehicle.file.hull)
    seen = [
        visible_fraction(axes, point, towards, SUN_ANGULAR_RADIUS)
        for point in iterate_panel_points(mount, panel)
    ]
    return facing * math.fsum(seen) / len(seen)


def iterate_panel_points(mount: MountFile, panel: str) -> Iterator[Vector]:
    """Yield evenly spaced points just above the lit face of a panel [m]."""
    part, normal = mount.parts[panel], mount.panels[panel].normal.vector
    # The thinnest axis of the box is the one across the panel.
    thin = min(range(3), key=lambda axis: part.size.vector[axis])
    across = [axis for axis in range(3) if axis != thin]
    middle = [
        # From the middle of the box to its lit face
        place + (0.5 * part.size.vector[thin] + PANEL_OFFSET) * way
        for place, way in zip(part.position.vector, normal, strict=True)
    ]
    # Centres of GRID equal intervals in [-0.5, 0.5]
    steps = [(k + 0.5) / PANEL_POINTS - 0.5 for k in range(PANEL_POINTS)]
    for p in steps:
        for q in steps:
            point = list(middle)
            point[across[0]] += p * part.size.vector[across[0]]
            point[across[1]] += q * part.size.vector[across[1]]
            yield point[0], point[1], point[2]


ROOMY = 3.0  # volume factor that can carry any mount; used to compute the required lift
VOLUME_STEP = 1e-3  # resolution of the volume factor


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
        """Nose-down pitch at rest, from the centre of gravity [rad]."""
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
    """Return the lift that the hull lacks to fly a mount at the file's heaviness [kg]."""
    roomy = build_mounted_vehicle(content, name, fuller=ROOMY).vehicle
    # The roomy hull has this much more lift than the real one; ballast took up the unused part.
    return roomy.gross_lift * (1.0 - 1.0 / ROOMY) - roomy.ballast_mass


def required_volume_factor(content: Mapping[str, Any], names: Sequence[str]) -> float:
    """Return the volume factor that carries every mount; 1 if the hull does [1]."""
    most = 1.0
    for name in names:
        roomy = build_mounted_vehicle(content, name, fuller=ROOMY).vehicle
        # Lift is proportional to volume: shrink the roomy hull until no ballast is left.
        most = max(most, ROOMY * (1.0 - roomy.ballast_mass / roomy.gross_lift))
    # Rounded up to the resolution; 1e-9 keeps an exact multiple.
    return math.ceil(most / VOLUME_STEP - 1e-9) * VOLUME_STEP


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
