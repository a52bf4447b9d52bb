# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define the floor plan file: a hall, its obstacles, the flight altitude and the lamps to lay out.

Positions are on the plan's own axes, with z up from the floor. Obstacles reach from the floor to
their height; walls reach to the ceiling.
"""

from dataclasses import dataclass
import math
from typing import Annotated, final, Literal, NamedTuple, Self

from lta_config.errors import BadInput
from lta_config.files import StrictModel
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.spectrum_file import Efficacy
from lta_model.light.lamp import lambertian_order
from lta_model.mass_properties import half_axes
from lta_model.scenario_light import AmbientScene
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray
from pydantic import AliasChoices, Field, model_validator

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Vector = tuple[float, float, float]


@final
class LampMount(NamedTuple):
    """A candidate position for a lamp."""

    position: Vector  # position of the lamp [m]
    axis: Vector  # unit vector along the beam axis
    name: str = ''  # name of an existing lamp; else empty
    frequency: float | None = None  # frequency of an existing lamp [Hz]


def polygon_edges(corners: Array) -> Array:
    """Return the edges of a polygon of shape (k, 2) as rows x0 y0 x1 y1, shape (k, 4) [m]."""
    return np.hstack([corners, np.roll(corners, -1, axis=0)])


def signed_area(corners: Array) -> float:
    """Return the area of a simple polygon, positive if counter-clockwise [m2]."""
    x, y = corners.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def points_in_polygon(points: Array, corners: Array) -> Mask:
    """Return which points (..., 2) are in a polygon (k, 2), by the even-odd rule."""
    x, y = points[..., 0], points[..., 1]
    odd = np.zeros(x.shape, dtype=bool)
    for x0, y0, x1, y1 in polygon_edges(corners):
        # A horizontal ray has no single crossing with a horizontal edge.
        if y0 == y1:
            continue
        # A corner counts for one of its two edges only, so a ray through it is not counted twice.
        across = (y0 > y) != (y1 > y)
        odd ^= across & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return odd


def distance_to_edges(points: Array, edges: Array) -> Array:
    """Return the distance from points (..., 2) to the nearest edge; inf without edges [m]."""
    nearest = np.full(points.shape[:-1], np.inf)
    for x0, y0, x1, y1 in edges:
        along = np.array([x1 - x0, y1 - y0])
        ahead = points - (x0, y0)
        # Projection on the edge, limited to its ends
        part = np.clip(ahead @ along / (along @ along), 0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(ahead - part[..., None] * along, axis=-1))
    return nearest


def find_polygon_flaw(corners: Array) -> str | None:
    """Return why corners of shape (k, 2) are not a simple polygon, or None."""
    edges = polygon_edges(corners)
    sides = np.hypot(*(edges[:, 2:] - edges[:, :2]).T)
    if sides.min() <= 0.0:
        x, y = corners[int(sides.argmin())]
        return f'has the corner ({x:g}, {y:g}) m twice in succession; remove one'
    count = len(edges)
    for i in range(count):
        # Neighbouring sides share a corner and are skipped; so do the last and the first.
        for j in range(i + 2, count):
            if (j + 1) % count != i and _has_common_point(edges[i], edges[j]):
                return (
                    f'intersects itself: its side {_format_edge(edges[i])} meets '
                    f'{_format_edge(edges[j])}; reorder '
                    'its corners'
                )
    if abs(signed_area(corners)) <= 1e-9 * float(sides.max()) ** 2:
        return 'encloses no area; its corners must not lie on one line'
    return None


def _format_edge(edge: Array) -> str:
    """Format an edge [m]."""
    x0, y0, x1, y1 = edge
    return f'from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g}) m'


def _has_common_point(first: Array, second: Array) -> bool:
    """Return whether two edges have a point in common."""

    def side(edge: Array, x: float, y: float) -> float:
        x0, y0, x1, y1 = edge
        return float(np.sign((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)))

    def within(edge: Array, x: float, y: float) -> bool:
        x0, y0, x1, y1 = edge
        return bool(min(x0, x1) <= x <= max(x0, x1) and min(y0, y1) <= y <= max(y0, y1))

    a, b = side(first, *second[:2]), side(first, *second[2:])
    c, d = side(second, *first[:2]), side(second, *first[2:])
    # The ends of each edge are on different sides of the other.
    if a * b < 0.0 and c * d < 0.0:
        return True
    return (
        (a == 0.0 and within(first, *second[:2]))
        or (b == 0.0 and within(first, *second[2:]))
        or (c == 0.0 and within(second, *first[:2]))
        or (d == 0.0 and within(second, *first[2:]))
    )


Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
Length = Annotated[Quantity, si_quantity('m', above=0.0, high=1000.0)]
Albedo = Annotated[float, Field(ge=0.0, lt=1.0)]
MOST_CORNERS, MOST_ROWS = 1000, 200
NO_STEP = Quantity(value=(0.0, 0.0), unit='m')
ON_WALL = 1e-6  # m, rounding tolerance for lamps exactly on a wall


class FloorArea(StrictModel):
    """A simple polygon, with its corners in order."""

    x: Quantity
    y: Quantity

    @model_validator(mode='after')
    def _check_polygon(self) -> Self:
        across, up = len(self.x.vector), len(self.y.vector)
        if self.x.dimension != 'm' or self.y.dimension != 'm':
            raise ValueError('has corners without a unit of length; give x and y in m')
        if across != up or not 3 <= across <= MOST_CORNERS:
            raise ValueError(
                f'has {across} numbers in x and {up} in y; give x and y the same number of '
                f'values, from 3 to {MOST_CORNERS}'
            )
        if wrong := find_polygon_flaw(self.corners):
            raise ValueError(wrong)
        return self

    @property
    def corners(self) -> Array:
        """Corners, shape (k, 2) [m]."""
        return np.stack([self.x.vector, self.y.vector], axis=1)


@final
class FloorObstacle(FloorArea):
    """An obstacle on the floor, such as a rack; repeated `count` times with a `step`."""

    height: Length
    count: Annotated[int, Field(ge=1, le=MOST_ROWS)] = 1
    step: Annotated[Quantity, si_quantity('m', low=-1000.0, high=1000.0, length=2)] = NO_STEP

    @model_validator(mode='after')
    def _check_step(self) -> Self:
        if self.count > 1 and not any(self.step.vector):
            raise ValueError(
                f'has {self.count} copies in one place; set step to the distance between two '
                'neighbouring copies along x and y'
            )
        return self

    @property
    def footprints(self) -> list[Array]:
        """Corners of each copy, shape (k, 2) [m]."""
        step = np.array(self.step.vector)
        return [self.corners + k * step for k in range(self.count)]


@final
class LampKind(StrictModel):
    """
    The lamps to lay out: identical and at the same height.

    They face down, or sideways on walls and on obstacles that reach above them. `spacing` is the
    distance between candidate positions.
    """

    flux: Annotated[Quantity, si_quantity('lm', above=0.0, high=1e7)]
    half_power: Annotated[Quantity, si_quantity('rad', low=math.radians(1.0), high=1.55)]
    efficacy: Efficacy
    duty: Annotated[Quantity, si_quantity('1', low=0.01, high=0.99)]
    height: Length
    facing: Literal['down', 'sideways']
    spacing: Annotated[Quantity, si_quantity('m', low=0.25, high=50.0)]

    @property
    def lambertian_order(self) -> float:
        """Lambertian order."""
        return lambertian_order(self.half_power.si)


@final
class ExistingLamp(StrictModel):
    """An existing lamp of the same kind; it keeps its frequency if it has one."""

    position: Annotated[Quantity, si_quantity('m', low=-1000.0, high=1000.0, length=3)]
    facing: Annotated[Quantity, si_quantity('1', length=3)]
    frequency: Annotated[Quantity, si_quantity('Hz', above=0.0, high=1e5)] | None = None

    @model_validator(mode='after')
    def _check_facing(self) -> Self:
        if not any(self.facing.vector):
            raise ValueError('has the facing [0, 0, 0]; set facing to the direction of the beam')
        return self


class FloorPlan(StrictModel):
    """A floor plan file; `hear` limits the area where the drone must receive a lamp."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Name
    about: str
    outline: FloorArea
    height: Length
    albedo: Albedo
    altitude: Length
    lamp: LampKind
    ambient: AmbientScene
    obstacles: dict[Name, FloorObstacle] = Field(default_factory=dict)
    hear: dict[Name, FloorArea] = Field(default_factory=dict)
    forbidden: dict[Name, FloorArea] = Field(default_factory=dict)
    lamps: dict[Name, ExistingLamp] = Field(default_factory=dict)

    @model_validator(mode='after')
    def _check_heights(self) -> Self:
        ceiling, lamp = self.height.si, self.lamp.height.si
        if lamp > ceiling:
            raise ValueError(
                f'has lamp.height at {lamp:g} m, above the ceiling at {ceiling:g} m; lower '
                'lamp.height'
            )
        if self.altitude.si >= ceiling:
            raise ValueError(
                f'has an altitude of {self.altitude.si:g} m, but the ceiling is at '
                f'{ceiling:g} m; lower the altitude'
            )
        for name, obstacle in self.obstacles.items():
            if obstacle.height.si > ceiling:
                raise ValueError(
                    f'has the obstacle {name} of {obstacle.height.si:g} m height, but the '
                    f'ceiling is at {ceiling:g} m; lower the obstacle'
                )
        for name, standing in self.lamps.items():
            x, y, z = standing.position.vector
            place, corners = np.array([x, y]), self.outline.corners
            off = distance_to_edges(place, polygon_edges(corners))
            # A lamp may hang on a wall, where rounding decides whether it is inside.
            if (
                not (points_in_polygon(place, corners) or off <= ON_WALL)
                or not 0.0 <= z <= ceiling
            ):
                raise ValueError(
                    f'has the lamp {name} at ({x:g}, {y:g}, {z:g}) m, outside the hall; correct '
                    'its position'
                )
        return self


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
        """Centres of the wanted cells, shape (m, 2) [m]."""
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
