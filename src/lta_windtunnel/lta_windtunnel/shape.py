"""
Build hull surfaces: the mylar balloon, spheroids and spheres.

A mylar balloon is two flat foil discs, joined at the rim and inflated (Paulsen 1994, Am. Math.
Monthly 101:953):

    z(r) = integral from r to R of t^2 / sqrt(R^4 - t^4) dt,   R the inflated radius

With t = R sin u the integrand is R sin^2 u / sqrt(1 + sin^2 u), which has no pole. A partly filled
balloon is approximated by the same curve, scaled to the height in its file.
"""

from typing import Final

from lta_config.errors import BadInput
from lta_config.schema.vehicle_body import HullBlock
from lta_model.mass_properties import half_axes
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson
import trimesh

Array = NDArray[np.float64]

PROFILE_POINTS: Final = 61  # from the pole to the rim
PROFILE_SECTIONS: Final = 160  # around
Z_TURNED_TO: Final = {  # z to x, and z to y
    'x': np.array([[0.0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]),
    'y': np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]),
}


def mylar_profile(points: int = PROFILE_POINTS) -> Array:
    """
    Return the upper half of a full mylar balloon of radius 1: radius and height, (points, 2). [1]

    Points are denser towards the rim, where the curve is steep.
    """
    # Integrate on a 20 times finer grid than the result.
    angle = np.linspace(0.0, 0.5 * np.pi, 20 * (points - 1) + 1)
    rise = np.sin(angle) ** 2 / np.sqrt(1.0 + np.sin(angle) ** 2)
    below = cumulative_simpson(rise, x=angle, initial=0.0)
    return np.column_stack((np.sin(angle), below[-1] - below))[::20]


def ellipse_profile(points: int = PROFILE_POINTS) -> Array:
    """Return a quarter of a unit circle, from pole to rim, as `mylar_profile`. [1]"""
    angle = np.linspace(0.0, 0.5 * np.pi, points)
    return np.column_stack((np.sin(angle), np.cos(angle)))


def revolve_profile(half: Array, radius: float, height: float) -> trimesh.Trimesh:
    """
    Return the closed surface of revolution of a half profile about z.

    `half`: radius and height from the pole to the rim, in any scale. `radius`, `height`: size of
    the surface; the height is from pole to pole [m].
    """
    upper = half * (radius / half[-1, 0], 0.5 * height / half[0, 1])
    # Exact zeros close the surface at the poles and at the rim
    upper[0, 0], upper[-1, 1] = 0.0, 0.0
    around = np.vstack((upper[:-1] * (1.0, -1.0), upper[::-1]))
    mesh = trimesh.creation.revolve(around, sections=PROFILE_SECTIONS)
    # A negative volume means inward normals.
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh


def build_hull_surface(hull: HullBlock) -> trimesh.Trimesh:
    """
    Return the surface of a hull about its centre, body axes. [m]

    Raise `BadInput` if the vehicle has no hull.
    """
    if hull.shape == 'none':
        raise BadInput(
            'This vehicle has no hull, which the wind tunnel needs; choose a vehicle with a hull.'
        )
    half = half_axes(hull)
    axis = 'xyz'.index(hull.axis or 'z')
    profile = mylar_profile() if hull.shape == 'balloon' else ellipse_profile()
    mesh = revolve_profile(profile, half[axis - 1], 2.0 * half[axis])
    if axis != 2:
        mesh.apply_transform(Z_TURNED_TO['xy'[axis]])
    return mesh
