# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build hull surfaces, or read those of a user in metres; they must enclose a volume."""

from pathlib import Path
from typing import Final

from lta_config.errors import BadInput
from lta_config.limits import STL_BYTES, STL_TRIANGLES
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
    Return the upper half of a full mylar balloon of radius 1: radius and height, (points, 2) [1].

    Points are denser towards the rim, where the curve is steep.
    """
    # Integrate on a 20 times finer grid than the result.
    angle = np.linspace(0.0, 0.5 * np.pi, 20 * (points - 1) + 1)
    rise = np.sin(angle) ** 2 / np.sqrt(1.0 + np.sin(angle) ** 2)
    below = cumulative_simpson(rise, x=angle, initial=0.0)
    return np.column_stack((np.sin(angle), below[-1] - below))[::20]


def ellipse_profile(points: int = PROFILE_POINTS) -> Array:
    """Return a quarter of a unit circle, from pole to rim, as `mylar_profile` [1]."""
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
    Return the surface of a hull about its centre, body axes [m].

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


SHAPE_UNITS: Final = {'m': 1.0, 'cm': 1e-2, 'mm': 1e-3}
MAX_SIZE, MIN_SIZE = 30.0, 2e-3  # m; size limits of a drone's part


def read_stl(path: Path, unit: str) -> trimesh.Trimesh:
    """
    Read the closed surface in an STL file, binary or text [m].

    `unit`: unit of the file, which the format does not store: 'm', 'cm', 'mm'. Raise `BadInput` if
    it cannot be read, is open, has mixed normals, or has the size of another unit.
    """
    if not path.is_file():
        raise BadInput(
            f'There is no STL file {path}; check the path, which is relative to the tunnel file.'
        )
    if path.stat().st_size > STL_BYTES:
        raise BadInput(
            f'{path} is larger than {STL_BYTES / 1e6:g} MB; export it with fewer triangles.'
        )
    try:
        with np.errstate(all='ignore'):  # absurd numbers are rejected below
            mesh = trimesh.load_mesh(path, file_type='stl')
    except Exception as error:  # the reader may raise anything on a broken file
        raise BadInput(f'{path} cannot be read as STL ({error}); export it again.') from None
    if not isinstance(mesh, trimesh.Trimesh) or not 4 <= len(mesh.faces) <= STL_TRIANGLES:
        raise BadInput(
            f'{path} must have a surface of 4 to {STL_TRIANGLES} triangles; export it again.'
        )
    if not np.isfinite(mesh.vertices).all():
        raise BadInput(f'{path} has infinite or NaN coordinates; export it again.')
    mesh.vertices *= SHAPE_UNITS[unit]
    return validate_closed(mesh, str(path), unit)


def validate_closed(mesh: trimesh.Trimesh, name: str, unit: str) -> trimesh.Trimesh:
    """Return a surface that encloses a volume, with outward normals; else raise `BadInput`."""
    size = float(np.max(mesh.extents))
    if not MIN_SIZE <= size <= MAX_SIZE:
        # Too large: probably millimetres read as metres; too small: the opposite
        other = 'mm' if size > MAX_SIZE else 'm'
        remedy = f'if it was drawn in {other}, set "unit: {other}" at its body in the tunnel file.'
        if other == unit:
            remedy = 'scale it in the CAD program, and export it again.'
        raise BadInput(
            f'{name} is {size:.4g} m long if its unit is {unit}, which is implausible for a '
            f'drone part; {remedy}'
        )
    if not mesh.is_watertight:
        edges = np.unique(mesh.edges_sorted, axis=0, return_counts=True)[1]
        raise BadInput(
            f'The surface of {name} is not closed: {int(np.sum(edges != 2))} edges do not '
            'join exactly two triangles. Close the holes in the CAD program, and export '
            'it again.'
        )
    if not mesh.is_winding_consistent:
        raise BadInput(
            f'In {name}, some triangle normals point inwards and others outwards; unify '
            'the normals in the CAD program, and export it again.'
        )
    # Consistently inward normals are harmless: flip them
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh
