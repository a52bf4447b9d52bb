"""Polygon geometry on the floor: inclusion, distances, area and validity."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def polygon_edges(corners: Array) -> Array:
    """Return the edges of a polygon of shape (k, 2) as rows x0 y0 x1 y1, shape (k, 4). [m]"""
    return np.hstack([corners, np.roll(corners, -1, axis=0)])


def signed_area(corners: Array) -> float:
    """Return the area of a simple polygon, positive if counter-clockwise. [m2]"""
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
    """Return the distance from points (..., 2) to the nearest edge; inf without edges. [m]"""
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
    """Format an edge. [m]"""
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
