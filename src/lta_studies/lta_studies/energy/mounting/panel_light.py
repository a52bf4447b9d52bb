"""
The light on panels as they are mounted: where they face, and what the hull leaves them.

Shares are of what a plate gets that faces the light and nothing shades; of an overcast sky, what
a level plate gets. The hull is the spheroid of its half axes and opaque. Panels in series carry
one current: without bypass diodes the darkest rules the string; side by side each gives its own.
"""

from collections.abc import Iterator
from dataclasses import dataclass
import math
from typing import final

from lta_config.schema.mount_file import MountFile
from lta_model.effects.protocol import Vector
from lta_model.hull import half_axes
from lta_model.light.shade import visible_fraction
from lta_model.vehicle import Vehicle
import numpy as np

SUN = 4.65e-3  # rad, half of the width of the sun's disc; lamps are taken as small
GRID = 5  # points along each side of a panel
AROUND, RINGS = 24, 18  # directions around, and heights of the sky
OFF = 1e-3  # m, how far above its face a panel is looked at


@final
@dataclass(frozen=True, slots=True)
class LightDirection:
    """A light by its name: its height above the horizon, or None for an overcast sky. [rad]"""

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
    """Shares of light, mean over all headings: of panels in series, and each on its own. [1]"""

    series: float
    apart: float


def compute_light_shares(
    vehicle: Vehicle, mount: MountFile, light: LightDirection
) -> PanelLightShares:
    """Return the light on the panels of a mount on a level vehicle."""
    if light.height is None:
        return _compute_overcast_shares(vehicle, mount)
    series, apart = [], []
    for towards in _iterate_directions(light.height):
        shares = [panel_light_share(vehicle, mount, panel, towards) for panel in mount.panels]
        series.append(min(shares))
        apart.append(sum(shares) / len(shares))
    return PanelLightShares(float(np.mean(series)), float(np.mean(apart)))


def _compute_overcast_shares(vehicle: Vehicle, mount: MountFile) -> PanelLightShares:
    """Return the share under a sky that is equally bright everywhere, none from below."""
    shares = np.zeros(len(mount.panels))
    level = 0.0
    for ring in range(RINGS):
        low, high = (0.5 * math.pi * k / RINGS for k in (ring, ring + 1))
        patch = math.sin(high) - math.sin(low)
        height = 0.5 * (low + high)
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
    """Yield directions of one height above the horizon; one alone at the zenith. [rad]"""
    flat = math.cos(height)
    count = 1 if flat < 1e-9 else AROUND
    for k in range(count):
        turn = 2.0 * math.pi * (k + 0.5) / count
        yield flat * math.cos(turn), flat * math.sin(turn), math.sin(height)


def panel_light_share(vehicle: Vehicle, mount: MountFile, panel: str, towards: Vector) -> float:
    """Return what one panel gets of a small light in a direction, of a plate that faces it. [1]"""
    facing = sum(a * b for a, b in zip(mount.panels[panel].normal.vector, towards, strict=True))
    if facing <= 0.0:
        return 0.0
    axes = half_axes(vehicle.file.hull)
    seen = [
        visible_fraction(axes, point, towards, SUN) for point in iterate_panel_points(mount, panel)
    ]
    return facing * math.fsum(seen) / len(seen)


def iterate_panel_points(mount: MountFile, panel: str) -> Iterator[Vector]:
    """Yield points spread evenly over the lit face of a panel, just above it. [m]"""
    part, normal = mount.parts[panel], mount.panels[panel].normal.vector
    thin = min(range(3), key=lambda axis: part.size.vector[axis])
    across = [axis for axis in range(3) if axis != thin]
    middle = [
        place + (0.5 * part.size.vector[thin] + OFF) * way
        for place, way in zip(part.position.vector, normal, strict=True)
    ]
    steps = [(k + 0.5) / GRID - 0.5 for k in range(GRID)]
    for p in steps:
        for q in steps:
            point = list(middle)
            point[across[0]] += p * part.size.vector[across[0]]
            point[across[1]] += q * part.size.vector[across[1]]
            yield point[0], point[1], point[2]
