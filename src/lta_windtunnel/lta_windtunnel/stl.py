"""Read a user's STL surface in metres, and reject one that does not enclose a volume."""

from pathlib import Path
from typing import Final

from lta_config.errors import BadInput
from lta_config.limits import STL_BYTES, STL_TRIANGLES
from lta_windtunnel.self_intersection import find_crossing_triangles
import numpy as np
import trimesh

UNITS: Final = {'m': 1.0, 'cm': 1e-2, 'mm': 1e-3}
LARGEST, SMALLEST = 30.0, 2e-3  # m; size limits of a drone's part


def read_stl(path: Path, unit: str) -> trimesh.Trimesh:
    """
    Read the closed surface in an STL file, binary or text. [m]

    `unit`: unit of the file, which the format does not store: 'm', 'cm', 'mm'. Raise `BadInput` if
    it cannot be read, is open, intersects itself, has mixed normals, or has the size of another
    unit.
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
    mesh.vertices *= UNITS[unit]
    return validate_closed(mesh, str(path), unit)


def validate_closed(mesh: trimesh.Trimesh, name: str, unit: str) -> trimesh.Trimesh:
    """Return a surface that encloses a volume, with outward normals; else raise `BadInput`."""
    size = float(np.max(mesh.extents))
    if not SMALLEST <= size <= LARGEST:
        # Too large: probably millimetres read as metres; too small: the opposite
        other = 'mm' if size > LARGEST else 'm'
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
    if (pair := find_crossing_triangles(mesh.triangles)) is not None:
        place = mesh.triangles[pair[0]].mean(axis=0)
        raise BadInput(
            f'The surface of {name} intersects itself near ({place[0]:.3g}, '
            f'{place[1]:.3g}, {place[2]:.3g}) m; unite its solids in the CAD program, or '
            'give each as a separate body.'
        )
    # Consistently inward normals are harmless: flip them
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh
