# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate by hand: drag by Hoerner, plates and discs, and the pressure of potential flow.

Used without a flow solver, and to check solved flows: the two should agree within a factor of two.
Hulls are treated as spheroids of the same size.

Along an axis, with l the length along it and d the size across it, relative to the frontal area
(Hoerner 1965, Fluid-Dynamic Drag, 6-19; for bodies of revolution in axial flow, so an
approximation for a balloon that flies edge-on; quoted after later texts):

    C_D = 0.44 d / l + 4 C_f l / d + 4 C_f sqrt(d / l),   C_f = 1.328 / sqrt(Re_l)   (Blasius)

About the axis of revolution: friction of a laminar rotating disc, both sides (Karman 1921); a
sphere has 1.67 times as much (Howarth 1951), interpolated by the height over the diameter:

    M = 0.616 pi rho R^4 sqrt(nu w^3) (1 + 0.67 h / d)

About other axes: the same friction plus the drag of a plate moved broadside, zero for a sphere:
C_D rho R^5 (2 / 15) 2 (1 - h / d)^2 w^2 (an assumption). Boxes count as plates.

The potential on the surface of an ellipsoid in a stream U along one of its axes is (1 + k) U x
(Lamb 1932, Hydrodynamics, article 114), with k the added mass over the displaced mass. The air
therefore slides along the surface at (1 + k) times the tangential part of U:

    C_p = 1 - (1 + k)^2 (1 - (n.e)^2)

with n the normal and e the direction of the stream. A sphere has k = 1/2: C_p is 1 to -5/4.
"""

from collections.abc import Mapping
import math
from typing import Final

from lta_config.schema.vehicle_body import HullBlock
from lta_model.mass_properties import added_mass, half_axes
from lta_windtunnel.tunnel_model import HULL_PATCH, TunnelModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PLATE: Final = 1.17  # square plate across the flow (Aeronautical Engineer's Data Book, 5.13(b))


def hull_drag_coefficient(along: float, across: float, speed: float, viscosity: float) -> float:
    """
    Return the drag coefficient of a hull relative to its frontal area [1].

    `along` and `across` are its sizes, of two unequal ones across the smaller [m]; `speed` is in
    m/s and `viscosity` kinematic [m2/s].
    """
    friction = 1.328 / math.sqrt(speed * along / viscosity)
    slender = across / along
    return 0.44 * slender + 4.0 * friction / slender + 4.0 * friction * math.sqrt(slender)


def drag_force(model: TunnelModel, axis: int, speed: float, air: tuple[float, float]) -> float:
    """
    Return the drag along a body axis (0, 1, 2 for x, y, z). [N].

    `speed` is in m/s; `air` holds density [kg/m3] and kinematic viscosity [m2/s].
    """
    density, viscosity = air
    sizes = model.hull.extents
    # Negative indices wrap around: the two other axes
    across = min(float(sizes[axis - 1]), float(sizes[axis - 2]))
    hull = hull_drag_coefficient(
        float(sizes[axis]), across, speed, viscosity
    ) * model.frontal_area(axis)
    boxes = sum(PLATE * area for area in _frontal_areas(model, axis).values())
    return 0.5 * density * speed**2 * (hull + boxes)


def damping_moment(model: TunnelModel, axis: int, rate: float, air: tuple[float, float]) -> float:
    """Return the moment against rotation about a body axis. [N m]; see `drag_force`."""
    density, viscosity = air
    sizes = model.hull.extents
    # The axis of revolution is the one whose size differs most from the median.
    revolution = int(np.argmax(np.abs(sizes - np.median(sizes))))
    height, diameter = float(sizes[revolution]), float(sizes[revolution - 1])
    # About a transverse axis, the largest dimension sweeps the air
    radius = 0.5 * (diameter if axis == revolution else max(height, diameter))
    flat = float(np.min(sizes) / np.max(sizes))
    disc = 0.616 * math.pi * density * radius**4 * math.sqrt(viscosity * rate**3)
    moment = disc * (1.0 + 0.67 * (height / diameter if axis == revolution else flat))
    if axis != revolution:
        # The plate term vanishes for a sphere (flat = 1).
        plate = PLATE * density * radius**5 * 2.0 / 15.0 * 2.0
        moment += plate * (1.0 - flat) ** 2 * rate**2
    return moment + _box_damping(model, axis, density) * rate**2


def _frontal_areas(model: TunnelModel, axis: int) -> Mapping[str, float]:
    """Return the frontal area of each box along an axis. [m2]."""
    return {
        name: float(np.prod(np.delete(mesh.extents, axis)))
        for name, mesh in model.bodies.items()
        if name != HULL_PATCH
    }


def _box_damping(model: TunnelModel, axis: int, density: float) -> float:
    """Return 0.5 rho Cd A r^3 of all boxes about an axis, summed in strips. [N m s2]."""
    total = 0.0
    for name, mesh in model.bodies.items():
        if name == HULL_PATCH:
            continue
        for face in (each for each in range(3) if each != axis):
            # Moved along `face` at the distance along the third axis.
            # The three axis indices sum to 3
            arm = 3 - axis - face
            low, high = mesh.bounds[:, arm]
            # 21 points suffice for the cubic integrand.
            places = np.linspace(low, high, 21)
            cubed = float(np.trapezoid(np.abs(places) ** 3, places))
            wide = float(mesh.extents[axis])
            total += 0.5 * density * PLATE * wide * cubed
    return total


def pressure_coefficient(normals: Array, along: int, share: float) -> Array:
    """
    Return the pressure over the dynamic pressure of the stream [1].

    `normals`: unit normals of the surface. `along`: 0, 1, 2 for a stream along x, y, z. `share`:
    added mass along it over the displaced mass [1].
    """
    facing = np.asarray(normals)[..., along]
    coefficient: Array = 1.0 - (1.0 + share) ** 2 * (1.0 - facing**2)
    return coefficient


def added_mass_share(shape: HullBlock, along: int) -> float:
    """Return a hull's added mass along an axis over the air mass that its spheroid displaces."""
    a, b, c = half_axes(shape)
    displaced = 4.0 / 3.0 * np.pi * a * b * c
    return float(added_mass(shape, 1.0)[along] / displaced)


def pressure_extremes(
    shape: HullBlock, along: int, speed: float, density: float
) -> tuple[float, float]:
    """
    Return the lowest and the highest pressure on a hull in flight along an axis [Pa].

    A balloon counts as the spheroid of its diameter and height. Speed in m/s, density in kg/m3.
    """
    dynamic = 0.5 * density * speed**2
    beside, ahead = np.zeros(3), np.zeros(3)
    # Lowest pressure where the surface is parallel to the stream, highest at the stagnation point
    beside[along - 1], ahead[along] = 1.0, 1.0
    low, high = pressure_coefficient(
        np.array([beside, ahead]), along, added_mass_share(shape, along)
    )
    return float(dynamic * low), float(dynamic * high)
