# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Define the model in the wind tunnel: closed surfaces by name, and the rotor disks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
import math
from pathlib import Path
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.schema.mount_file import MountFile
from lta_config.schema.vehicle_aero import (
    load_tunnel_file,
    TunnelBody,
    TunnelFile,
    TunnelRotorDisk,
)
from lta_config.schema.vehicle_file import load_vehicle_file, VehicleFile
from lta_windtunnel.shape import build_hull_surface, read_stl
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
import trimesh

Array = NDArray[np.float64]
Three = tuple[float, float, float]

HULL_PATCH: Final = 'envelope'
PLAN_SYMMETRIES: Final = [  # eight: four quarter turns about z, mirrored across y = 0 or not
    np.array([[c, -s * m, 0.0], [s, c * m, 0.0], [0.0, 0.0, 1.0]])
    for m in (1.0, -1.0)
    for c, s in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
]
QUARTER_TURN: Final = PLAN_SYMMETRIES[1]  # x to y
SYMMETRY_TOLERANCE: Final = 1e-3  # of the length: how well a mirrored surface must lie on itself


@final
@dataclass(frozen=True, slots=True)
class RotorDisk:
    """The disk of a rotor: centre from the hull centre [m], axis, size [m], full thrust [N]."""

    place: Three
    axis: Three
    radius: float
    thickness: float
    thrust: float

    def disk_points(self, count: int = 16) -> Array:
        """Return points of the disk: centre and rim of both faces. [m]."""
        axis = np.array(self.axis)
        # Any vector across the axis; the least parallel base vector is numerically safe
        side = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
        side /= np.linalg.norm(side)
        turn = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)[:, None]
        ring = self.radius * (np.cos(turn) * side + np.sin(turn) * np.cross(axis, side))
        half = 0.5 * self.thickness * axis
        points: Array = np.vstack((np.zeros(3), ring + half, ring - half)) + np.array(self.place)
        return points


@final
@dataclass(frozen=True, slots=True)
class TunnelModel:
    """The model in the wind tunnel, in body axes about the hull centre."""

    name: str
    bodies: Mapping[str, trimesh.Trimesh]
    rotors: Mapping[str, RotorDisk]
    patterns: Mapping[str, Mapping[str, float]]
    # Cache: whether each rotation or mirroring maps the bodies onto themselves.
    _alike: dict[bytes, bool] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def hull(self) -> trimesh.Trimesh:
        """Surface of the hull."""
        return self.bodies[HULL_PATCH]

    @property
    def length(self) -> float:
        """Largest dimension of the hull, to which the tunnel is scaled [m]."""
        return float(np.max(self.hull.extents))

    def frontal_area(self, axis: int) -> float:
        """Return the projected area of a convex hull along an axis [m2]."""
        # Front and back faces both project onto the shadow, hence the half
        return 0.5 * float(np.abs(self.hull.area_faces * self.hull.face_normals[:, axis]).sum())

    def is_mirror_symmetric(self, axis: int) -> bool:
        """Return whether all bodies together are their own mirror image across an axis."""
        return bool(self._select_symmetries([np.diag(np.where(np.arange(3) == axis, -1.0, 1.0))]))

    def find_symmetries(self) -> list[Array]:
        """Return the quarter turns and reflections that map the bodies onto themselves."""
        return self._select_symmetries(PLAN_SYMMETRIES)

    @property
    def has_quarter_symmetry(self) -> bool:
        """Whether a quarter turn maps the bodies onto themselves (x equals y)."""
        return bool(self._select_symmetries([QUARTER_TURN]))

    def _select_symmetries(self, changes: Sequence[Array]) -> list[Array]:
        """Return those transforms that map the bodies onto themselves."""
        # Adding 0.0 turns -0.0 into 0.0, which has other bytes
        keyed = [((each + 0.0).tobytes(), each) for each in changes]
        new = {key: each for key, each in keyed if key not in self._alike}
        if new:
            corners = np.vstack([mesh.vertices for mesh in self.bodies.values()])
            tree, near = cKDTree(corners), SYMMETRY_TOLERANCE * self.length
            for key, each in new.items():
                # A corner without a neighbour within reach is infinitely far: that ends it early.
                off, _ = tree.query(corners @ each.T, distance_upper_bound=near)
                self._alike[key] = bool(np.isfinite(off).all())
        return [each for key, each in keyed if self._alike[key]]

    @property
    def fingerprint(self) -> str:
        """Hash of the whole geometry."""
        digest = sha256()
        for name, mesh in self.bodies.items():
            # Adding 0.0 removes -0.0, so that the hash is the same on every machine.
            digest.update(name.encode() + (np.round(mesh.triangles, 7) + 0.0).tobytes())
        # Stored sweeps have the hash of the class name `Rotor`.
        rotors = repr(sorted(self.rotors.items())).replace('RotorDisk(', 'Rotor(')
        digest.update(rotors.encode())
        return digest.hexdigest()[:16]


def load_tunnel_model(name: str, mount: MountFile | None = None) -> TunnelModel:
    """
    Load the model of a tunnel file.

    Raise `BadInput` if a file is invalid, a surface is open, or a rotor is inside a body.
    """
    file, path = load_tunnel_file(name)
    vehicle = load_vehicle_file(file.vehicle)
    bodies = {each: _load_surface(body, path.parent) for each, body in file.bodies.items()}
    if HULL_PATCH not in bodies:
        bodies = {HULL_PATCH: build_hull_surface(vehicle.hull), **bodies}
    for each, part in (mount.parts if mount else {}).items():
        bodies[each] = build_box_surface(part.position.vector, part.size.vector)
    rotors = (
        {each: _build_rotor_disk(vehicle, each, file.disk) for each in vehicle.rotors}
        if file.disk
        else {}
    )
    _check_patterns(file, rotors, bodies)
    label = file.name if mount is None else f'{file.name}_{mount.name}'
    return TunnelModel(label, bodies, rotors, file.patterns)


def build_box_surface(centre: tuple[float, ...], size: tuple[float, ...]) -> trimesh.Trimesh:
    """Return a box. [m]."""
    mesh: trimesh.Trimesh = trimesh.creation.box(extents=size)
    mesh.apply_translation(centre)
    return mesh


def _load_surface(body: TunnelBody, folder: Path) -> trimesh.Trimesh:
    if body.stl is not None:
        return read_stl(folder / body.stl, body.unit or 'm')
    assert body.position is not None  # or the file was refused
    assert body.size is not None
    return build_box_surface(body.position.vector, body.size.vector)


def _build_rotor_disk(vehicle: VehicleFile, name: str, disk: TunnelRotorDisk) -> RotorDisk:
    rotor = vehicle.rotors[name]
    curve = rotor.thrust_curve or vehicle.thrust_curve
    assert curve is not None  # or the vehicle file was refused
    x, y, z = rotor.position.vector
    axis = np.array(rotor.axis.vector) / np.linalg.norm(rotor.axis.vector)
    return RotorDisk(
        (x, y, z),
        (float(axis[0]), float(axis[1]), float(axis[2])),
        0.5 * disk.diameter.si,
        disk.thickness.si,
        # Thrust curve a u^2 + b u at full duty, u = 1
        curve.a.si + curve.b.si,
    )


def _check_patterns(
    file: TunnelFile, rotors: Mapping[str, RotorDisk], bodies: Mapping[str, trimesh.Trimesh]
) -> None:
    """Raise `BadInput` for patterns with unknown rotors, and for rotors inside a body."""
    for pattern, shares in file.patterns.items():
        if strangers := [name for name in shares if name not in rotors]:
            raise BadInput(
                f'The rotor pattern {pattern} in the tunnel file {file.name} names unknown '
                f'rotors ({", ".join(strangers)}); the rotors of {file.vehicle} are '
                f'{", ".join(rotors)}.'
            )
    for name, rotor in rotors.items():
        for other, mesh in bodies.items():
            low, high = mesh.bounds
            near = rotor.disk_points()
            # Test only points in the bounding box: the winding number is slow
            near = near[np.all((near >= low) & (near <= high), axis=1)]
            if np.any(winding_number(mesh.triangles, near) > 0.5):
                x, y, z = rotor.place
                raise BadInput(
                    f'The rotor {name} at ({x:g}, {y:g}, {z:g}) m is inside the body '
                    f'{other}; move one of them.'
                )


def winding_number(triangles: Array, points: Array) -> Array:
    """
    Return the winding number of a closed surface about each point: 1 inside, 0 outside.

    The solid angle of each triangle is that of van Oosterom and Strackee (1983). `triangles` has
    shape (n, 3, 3), `points` (m, 3). [m]
    """
    around = []
    for point in points:
        a, b, c = np.moveaxis(triangles - point, 1, 0)
        la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
        above = np.einsum('ij,ij->i', a, np.cross(b, c))
        below = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        around.append(float(np.arctan2(above, below).sum()) / (2.0 * math.pi))
    return np.array(around)
