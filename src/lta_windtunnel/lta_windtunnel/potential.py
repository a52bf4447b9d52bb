"""
Compute the pressure on a spheroid in potential flow, in closed form.

The potential on the surface of an ellipsoid in a stream U along one of its axes is (1 + k) U x
(Lamb 1932, Hydrodynamics, article 114), with k the added mass over the displaced mass. The air
therefore slides along the surface at (1 + k) times the tangential part of U:

    C_p = 1 - (1 + k)^2 (1 - (n.e)^2)

with n the normal and e the direction of the stream. A sphere has k = 1/2: C_p is 1 to -5/4.
"""

from lta_config.schema.vehicle_body import HullBlock
from lta_model import hull
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def pressure_coefficient(normals: Array, along: int, share: float) -> Array:
    """
    Return the pressure over the dynamic pressure of the stream. [1]

    `normals`: unit normals of the surface. `along`: 0, 1, 2 for a stream along x, y, z. `share`:
    added mass along it over the displaced mass [1].
    """
    facing = np.asarray(normals)[..., along]
    coefficient: Array = 1.0 - (1.0 + share) ** 2 * (1.0 - facing**2)
    return coefficient


def added_mass_share(shape: HullBlock, along: int) -> float:
    """Return a hull's added mass along an axis over the air mass that its spheroid displaces."""
    a, b, c = hull.half_axes(shape)
    displaced = 4.0 / 3.0 * np.pi * a * b * c
    return float(hull.added_mass(shape, 1.0)[along] / displaced)


def pressure_extremes(
    shape: HullBlock, along: int, speed: float, density: float
) -> tuple[float, float]:
    """
    Return the lowest and the highest pressure on a hull in flight along an axis. [Pa]

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
