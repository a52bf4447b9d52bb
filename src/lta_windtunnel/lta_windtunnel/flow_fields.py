# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sample the fields of a solved flow: pressure on the bodies, and the velocity in a plane."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from lta_windtunnel.flow_plan import TunnelFlow
from lta_windtunnel.openfoam.output_reader import read_last_table
from lta_windtunnel.sweep_table import round_digits, SurfacePressure
from lta_windtunnel.tunnel import has_symmetry_planes, rotate_into_tunnel
from lta_windtunnel.tunnel_model import TunnelModel
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import griddata, NearestNDInterpolator
from scipy.spatial import ConvexHull, Delaunay
import trimesh

Array = NDArray[np.float64]
MAP_CELLS: Final = 41  # of the map of a pressure, along a side
SLICE_POINTS: Final = 220  # of a slice, along the longer side


def read_surface_pressure(folder: Path, body: str, density: float) -> SurfacePressure:
    """Return the pressure on a body (a patch of the case) at the end of a flow."""
    rows = read_last_table(folder, 'pressure', f'p_{body}.raw')
    assert rows is not None  # or the solver failed
    return summarize_surface_pressure(rows[:, :3], density * rows[:, 3])


def summarize_surface_pressure(places: Array, pressure: Array) -> SurfacePressure:
    """
    Reduce the pressure on a body to its extremes and a map.

    `places`: face centres, body axes [m]. `pressure`: relative to the far field [Pa].
    """
    low, high = int(pressure.argmin()), int(pressure.argmax())
    side = 2.0 * float(np.abs(places[:, :2]).max())
    return SurfacePressure(
        least=round_digits(pressure[low], 3), most=round_digits(pressure[high], 3),
        least_at=[round_digits(each, 3) for each in places[low]],
        most_at=[round_digits(each, 3) for each in places[high]],
        below=_lower_pressure_grid(places, pressure, side), side=round_digits(side, 3),
    )  # fmt: skip


def _lower_pressure_grid(places: Array, pressure: Array, side: float) -> list[list[float | None]]:
    """Return the pressure on the lower half, on a grid of x and y, from the nearest face."""
    under = places[:, 2] <= float(places[:, 2].mean())
    flat = places[under, :2]
    # Centres of the map's cells
    steps = side * ((np.arange(MAP_CELLS) + 0.5) / MAP_CELLS - 0.5)
    x, y = np.meshgrid(steps, steps)
    values = NearestNDInterpolator(flat, pressure[under])(x, y)
    # Cells outside the body's outline would get the value of a far face
    outline = Delaunay(flat[ConvexHull(flat).vertices])
    inside = outline.find_simplex(np.stack((x, y), axis=-1)) >= 0
    rows: list[list[float]] = np.where(inside, values, np.nan).tolist()
    # NaN is the only value unequal to itself; JSON has no NaN
    return [[None if value != value else round_digits(value, 3) for value in row] for row in rows]


@final
@dataclass(frozen=True, slots=True)
class FlowSlice:
    """Air speed in a plane."""

    about: str  # axis or pattern
    # Coordinates along the two sides of the picture [m]
    across: Array
    up: Array
    names: tuple[str, str]  # labels of the sides
    speed: Array  # NaN inside the bodies [m/s]


def read_flow_slice(model: TunnelModel, flow: TunnelFlow, place: Path) -> FlowSlice | None:
    """Return the slice of a solved flow, or None if none was written."""
    rows = read_last_table(place, 'slice', '*plane*')
    if rows is None or len(rows) < 100:
        return None
    size = model.length
    speed = np.linalg.norm(rows[:, 3:6], axis=1)
    if flow.kind == 'blow':
        # The slice contains z and either x or y: the one that varies
        across = int(np.argmax(np.ptp(rows[:, :2], axis=0)))
        window = ((-1.0, 1.0), (-1.5, 0.6))
        names = ('xyz'[across] + ' [m]', 'z [m]')
        turn = np.eye(3)
    else:
        across = 0
        window = ((-0.9, 2.2), (-0.9, 0.9))
        names = ('along the wind [m]', 'across it [m]')
        turn = np.eye(3) if flow.kind == 'spin' else rotate_into_tunnel(flow.about)
        # The flow was solved at 1 m/s
        speed = speed * flow.speeds[-1]
    points = rows[:, [across, 2]]
    if flow.kind == 'wind' and has_symmetry_planes(model, flow.about)[1]:
        # Mirror the solved half
        points = np.vstack((points, points * (1.0, -1.0)))
        speed = np.concatenate((speed, speed))
    ends = size * np.array(window)
    step = float(np.ptp(ends[0])) / SLICE_POINTS
    sides = [np.arange(low, high + step, step) for low, high in ends]
    grid = griddata(points, speed, tuple(np.meshgrid(*sides)), method='linear')
    return FlowSlice(
        flow.about, sides[0], sides[1], names, _mask_bodies(model, turn, across, sides, grid)
    )


def _mask_bodies(
    model: TunnelModel, turn: Array, across: int, sides: list[Array], grid: Array
) -> Array:
    """Return the grid with NaN inside the cross-sections of the bodies."""
    grid = grid.copy()
    normal = np.eye(3)[1 - across]
    for mesh in model.bodies.values():
        turned = mesh.copy()
        whole = np.eye(4)
        whole[:3, :3] = turn
        turned.apply_transform(whole)
        # Close to the plane of the slice, which is 0.002 lengths off the centre
        origin = 0.0023 * model.length * normal
        plane = (normal, origin)
        cut = trimesh.intersections.mesh_plane(turned, *plane)  # type: ignore[no-untyped-call]
        if len(cut):
            grid[_find_enclosed_points(cut[:, :, [across, 2]], sides)] = np.nan
    return grid


def _find_enclosed_points(lines: Array, sides: list[Array]) -> NDArray[np.bool_]:
    """Return which points of a grid are inside closed lines, by counting ray crossings."""
    x, y = np.meshgrid(*sides)
    odd = np.zeros(x.shape, dtype=bool)
    for (x1, y1), (x2, y2) in lines:
        crosses = (y1 > y) != (y2 > y)
        if crosses.any():
            at = x1 + (y - y1) * (x2 - x1) / (y2 - y1 if y2 != y1 else 1.0)
            odd ^= crosses & (x < at)
    return odd
