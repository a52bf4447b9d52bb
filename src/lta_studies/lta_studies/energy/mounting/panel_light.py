"""
Compute the light on mounted panels from their orientation and the shadow of the hull.

Shares are relative to an unshaded plate that faces the light, or to a level plate for an overcast
sky. The hull is an opaque spheroid. Panels in series carry the same current, so that without
bypass diodes the darkest one limits the string; separate panels each deliver their own.
"""

from collections.abc import Iterator
from dataclasses import dataclass
import math
from typing import final

from lta_config.schema.mount_file import MountFile
from lta_model.effects.protocol import Vector
from lta_model.light.direct_light import visible_fraction
from lta_model.mass_properties import half_axes
from lta_model.vehicle import Vehicle
import numpy as np

SUN = 4.65e-3  # rad, angular radius of the sun
GRID = 5  # points along each side of a panel
AROUND, RINGS = 24, 18  # azimuths, and elevation rings of the sky
OFF = 1e-3  # m above the face, so that rays do not start inside the hull


@final
@dataclass(frozen=True, slots=True)
class LightDirection:
    """A named light at an elevation [rad]; None is an overcast sky."""

    name: str
    height: float | None


LIGHTS = (
    LightDirection('overhead', math.radians(90.0)),
    LightDirection('45° up', math.radians(45.0)),
    LightDirection('20° up', math.radians(20.0)),
    LightDirection('level', 0.0),
    LightDirection('overcast sky', None),
)


@final
@dataclass(frozen=True, slots=True)
class PanelLightShares:
    """Shares of light, mean over all headings: panels in series, and separately. [1]"""

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
    for ring in range(RINGS):
        low, high = (0.5 * math.pi * k / RINGS for k in (ring, ring + 1))
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
    count = 1 if flat < 1e-9 else AROUND
    for k in range(count):
        # Half a step off the axes of symmetry of the vehicle
        turn = 2.0 * math.pi * (k + 0.5) / count
        yield flat * math.cos(turn), flat * math.sin(turn), math.sin(height)


def panel_light_share(vehicle: Vehicle, mount: MountFile, panel: str, towards: Vector) -> float:
    """Return the share of light on one panel from a direction. [1]"""
    facing = sum(a * b for a, b in zip(mount.panels[panel].normal.vector, towards, strict=True))
    # The light comes from behind the panel.
    if facing <= 0.0:
        return 0.0
    axes = half_axes(vehicle.file.hull)
    seen = [
        visible_fraction(axes, point, towards, SUN) for point in iterate_panel_points(mount, panel)
    ]
    return facing * math.fsum(seen) / len(seen)


def iterate_panel_points(mount: MountFile, panel: str) -> Iterator[Vector]:
    """Yield evenly spaced points just above the lit face of a panel. [m]"""
    part, normal = mount.parts[panel], mount.panels[panel].normal.vector
    # The thinnest axis of the box is the one across the panel.
    thin = min(range(3), key=lambda axis: part.size.vector[axis])
    across = [axis for axis in range(3) if axis != thin]
    middle = [
        # From the middle of the box to its lit face
        place + (0.5 * part.size.vector[thin] + OFF) * way
        for place, way in zip(part.position.vector, normal, strict=True)
    ]
    # Centres of GRID equal intervals in [-0.5, 0.5]
    steps = [(k + 0.5) / GRID - 0.5 for k in range(GRID)]
    for p in steps:
        for q in steps:
            point = list(middle)
            point[across[0]] += p * part.size.vector[across[0]]
            point[across[1]] += q * part.size.vector[across[1]]
            yield point[0], point[1], point[2]
