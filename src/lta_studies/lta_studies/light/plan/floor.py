"""
Divide the floor into cells: where the hull fits, where a lamp must be received, and walls.

A cell is free if the centre of the hull can be there at flight altitude: inside the hall, and at
least the hull's radius from every wall and from every obstacle that reaches up to the hull.
"""

from dataclasses import dataclass
from typing import final

from lta_config.errors import BadInput
from lta_model.mass_properties import half_axes
from lta_model.vehicle import Vehicle
from lta_studies.light.plan.floor_plan import (
    Array,
    distance_to_edges,
    FloorPlan,
    Mask,
    points_in_polygon,
    polygon_edges,
    signed_area,
)
import numpy as np

MOST_CELLS = 200_000  # limits memory and run time


@final
@dataclass(frozen=True, slots=True)
class FloorGrid:
    """A hall divided into cells."""

    # Centres of the cells [m]
    x: Array
    y: Array
    cell: float  # side of a cell [m]
    free: Mask  # cells where the hull fits, shape (ny, nx)
    # Free cells that must receive a lamp (inside the areas `hear`, if any), shape (ny, nx)
    target_cells: Mask
    walls: Array  # opaque vertical faces on the floor: x0 y0 x1 y1 and height, shape (w, 5) [m]
    area: float  # area of the whole floor [m2]

    @property
    def cell_centers(self) -> Array:
        """Centres of the wanted cells, shape (m, 2). [m]"""
        rows, columns = np.nonzero(self.target_cells)
        return np.stack([self.x[columns], self.y[rows]], axis=1)

    def locate_cells(self, points: Array) -> tuple[Array, Array]:
        """Return rows and columns of the cells that contain points of shape (..., 2)."""
        # x and y hold cell centres; + 0.5 moves to the edge of the first cell.
        column = np.floor((points[..., 0] - self.x[0]) / self.cell + 0.5)
        row = np.floor((points[..., 1] - self.y[0]) / self.cell + 0.5)
        return row.astype(np.intp), column.astype(np.intp)


def build_floor(plan: FloorPlan, vehicle: Vehicle, cell: float) -> FloorGrid:
    """
    Divide the floor of a plan into cells for a vehicle.

    `plan`: the hall. `vehicle`: the flying vehicle. `cell`: side of the cells [m]. Raise
    `BadInput` if the hull fits nowhere at the altitude, or there are too many cells.
    """
    _check_height(plan, vehicle)
    corners = plan.outline.corners
    low, high = corners.min(axis=0), corners.max(axis=0)
    # 1e-9 keeps an exact multiple of the cell from getting an extra row.
    counts = np.maximum(np.ceil((high - low) / cell - 1e-9).astype(int), 1)
    if counts.prod() > MOST_CELLS:
        raise BadInput(
            f'Cells of {cell:g} m divide the floor of {plan.name} into {counts.prod()} cells, '
            f'more than {MOST_CELLS}; choose larger ones with --cell.'
        )
    x, y = (low[k] + (np.arange(counts[k]) + 0.5) * cell for k in (0, 1))
    points = np.stack(np.meshgrid(x, y), axis=-1)
    free = points_in_polygon(points, corners)
    radius = max(half_axes(vehicle.file.hull)[:2])  # largest horizontal half axis [m]
    lowest = plan.altitude.si - vehicle.hull_height_on_floor
    in_the_way = [polygon_edges(corners)]
    walls = [_wall_faces(corners, plan.height.si)]
    for obstacle in plan.obstacles.values():
        for footprint in obstacle.footprints:
            walls.append(_wall_faces(footprint, obstacle.height.si))
            # The drone flies over lower obstacles; as walls they still shade the light.
            if obstacle.height.si > lowest:
                free &= ~points_in_polygon(points, footprint)
                in_the_way.append(polygon_edges(footprint))
    # The hull is a disk, so it fits at any heading.
    free &= distance_to_edges(points, np.vstack(in_the_way)) >= radius
    target = free
    if plan.hear:
        target = free & np.any(
            [points_in_polygon(points, a.corners) for a in plan.hear.values()], axis=0
        )
    if not target.any():
        raise BadInput(
            f'{vehicle.file.name}, {2 * radius:g} m wide, fits nowhere in the required area '
            f'of {plan.name} at an altitude of {plan.altitude.si:g} m; raise the altitude above '
            'the obstacles, choose smaller cells with --cell, or choose a smaller vehicle.'
        )
    return FloorGrid(x, y, cell, free, target, np.vstack(walls), abs(signed_area(corners)))


def _check_height(plan: FloorPlan, vehicle: Vehicle) -> None:
    """Raise `BadInput` for an altitude at which the vehicle hits the floor or the ceiling."""
    altitude, name = plan.altitude.si, vehicle.file.name
    standing, above = vehicle.hull_height_on_floor, half_axes(vehicle.file.hull)[2]
    if altitude < standing:
        raise BadInput(
            f'{plan.name} is flown at {altitude:g} m, but the hull centre of {name} is at '
            f'{standing:.2f} m when it stands on the floor; increase the altitude in the '
            'floor plan.'
        )
    if altitude + above > plan.height.si:
        raise BadInput(
            f'{plan.name} is flown at {altitude:g} m, but {name} reaches {above:.2f} m above '
            f'its hull centre and the ceiling is at {plan.height.si:g} m; reduce the '
            'altitude in the floor plan.'
        )


def _wall_faces(corners: Array, height: float) -> Array:
    edges = polygon_edges(corners)
    # Shape (n, 5): x and y of both ends, and the height [m]
    return np.hstack([edges, np.full((len(edges), 1), height)])
