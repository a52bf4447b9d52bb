"""List the candidate positions for lamps, and the existing lamps."""

from typing import final, NamedTuple

from lta_config.errors import BadInput
from lta_studies.light.plan.floor_plan import FloorPlan
from lta_studies.light.plan.polygon import (
    Array,
    Mask,
    points_in_polygon,
    polygon_edges,
    signed_area,
)
import numpy as np

OFF = 0.05  # m between a wall and the lamp on it
DOWN = (0.0, 0.0, -1.0)
MOST = 5000  # candidate positions

Vector = tuple[float, float, float]


@final
class LampMount(NamedTuple):
    """A candidate position for a lamp."""

    position: Vector  # position of the lamp [m]
    axis: Vector  # unit vector along the beam axis
    name: str = ''  # name of an existing lamp; else empty
    frequency: float | None = None  # frequency of an existing lamp [Hz]


def list_mounts(plan: FloorPlan) -> list[LampMount]:
    """
    Return all candidate positions, existing lamps first.

    Raise `BadInput` if there are no positions, or too many.
    """
    standing = []
    for name, lamp in plan.lamps.items():
        x, y, z = lamp.position.vector
        axis = np.array(lamp.facing.vector) / np.linalg.norm(lamp.facing.vector)
        frequency = None if lamp.frequency is None else lamp.frequency.si
        standing.append(LampMount((x, y, z), _to_vector(axis), name, frequency))
    new = list_ceiling_mounts(plan) if plan.lamp.facing == 'down' else list_wall_mounts(plan)
    mounts = standing + new
    if not mounts:
        raise BadInput(
            f'{plan.name} has no position for a lamp facing {plan.lamp.facing} at a height of '
            f'{plan.lamp.height.si:g} m; make the forbidden areas smaller, change '
            'lamp.height, or reduce lamp.spacing.'
        )
    if len(mounts) > MOST:
        raise BadInput(
            f'{plan.name} has {len(mounts)} possible positions for lamps, more than {MOST}; '
            'increase lamp.spacing.'
        )
    return mounts


def list_ceiling_mounts(plan: FloorPlan) -> list[LampMount]:
    """Return the positions of lamps that face down: a regular grid over the hall."""
    corners, spacing = plan.outline.corners, plan.lamp.spacing.si
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes = [
        low[k] + (np.arange(count) + 0.5) * (high[k] - low[k]) / count
        for k in (0, 1)
        # A whole number of equal intervals near the wanted spacing
        for count in [max(round(float(high[k] - low[k]) / spacing), 1)]
    ]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    allowed = points[_is_allowed(plan, points)]
    return [LampMount((float(x), float(y), plan.lamp.height.si), DOWN) for x, y in allowed]


def list_wall_mounts(plan: FloorPlan) -> list[LampMount]:
    """Return the positions of lamps that face sideways: on walls and taller obstacles."""
    faces = [_place_along_sides(plan.outline.corners, plan.lamp.spacing.si, inwards=True)]
    for obstacle in plan.obstacles.values():
        # A lamp can only hang on an obstacle that reaches its height.
        if obstacle.height.si > plan.lamp.height.si:
            faces += [
                _place_along_sides(footprint, plan.lamp.spacing.si, inwards=False)
                for footprint in obstacle.footprints
            ]
    points, axes = (np.vstack(part) for part in zip(*faces, strict=True))
    allowed = _is_allowed(plan, points)
    return [
        LampMount((float(x), float(y), plan.lamp.height.si), (float(a), float(b), 0.0))
        for (x, y), (a, b) in zip(points[allowed], axes[allowed], strict=True)
    ]


def _place_along_sides(corners: Array, spacing: float, inwards: bool) -> tuple[Array, Array]:
    """Return points just off the sides of a polygon, with the normals of the sides."""
    # The inside of a counter-clockwise polygon is to the left of its sides.
    left = 1.0 if (signed_area(corners) > 0.0) == inwards else -1.0
    points, axes = [], []
    for x0, y0, x1, y1 in polygon_edges(corners):
        side = np.array([x1 - x0, y1 - y0])
        length = float(np.hypot(*side))
        count = max(round(length / spacing), 1)
        # Unit normal: the side turned left by 90 degrees
        away = left * np.array([-side[1], side[0]]) / length
        # Middles of equal parts of the side
        parts = (np.arange(count)[:, None] + 0.5) / count
        points.append((x0, y0) + parts * side + OFF * away)
        axes.append(np.tile(away, (count, 1)))
    return np.vstack(points), np.vstack(axes)


def _is_allowed(plan: FloorPlan, points: Array) -> Mask:
    """Return which points are in the hall, not forbidden and not inside an obstacle."""
    allowed = points_in_polygon(points, plan.outline.corners)
    for area in plan.forbidden.values():
        allowed &= ~points_in_polygon(points, area.corners)
    for obstacle in plan.obstacles.values():
        if obstacle.height.si > plan.lamp.height.si:
            for footprint in obstacle.footprints:
                allowed &= ~points_in_polygon(points, footprint)
    return allowed


def _to_vector(vector: Array) -> Vector:
    x, y, z = vector.tolist()
    return x, y, z
