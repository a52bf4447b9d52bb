"""Detect whether a surface intersects itself."""

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

CHUNK: Final = 2_000_000  # pairs at a time
TOUCH: Final = 1e-9  # of an edge's length: touching is not crossing


def find_crossing_triangles(triangles: Array) -> tuple[int, int] | None:
    """
    Return the indices of two crossing triangles, or None.

    Neighbours that share a corner, and coplanar triangles, are not tested. `triangles` has shape
    (n, 3, 3). [m]
    """
    for one, other in _iterate_near_pairs(triangles):
        for first, second in ((one, other), (other, one)):
            for corner in range(3):
                begin, end = triangles[first, corner], triangles[first, corner - 2]
                hit = _find_pierced_triangles(begin, end, triangles[second])
                if hit.any():
                    k = int(np.argmax(hit))
                    return int(first[k]), int(second[k])
    return None


def _iterate_near_pairs(triangles: Array) -> Iterator[tuple[Index, Index]]:
    """Yield pairs of triangles whose boxes overlap and that share no corner, in chunks."""
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    # Sweep along x: only triangles whose x ranges overlap are compared.
    order = np.argsort(low[:, 0])
    # In the sorted order, partners of triangle k are k + 1 .. last - 1
    last = np.searchsorted(low[order, 0], high[order, 0], side='right')
    counts = np.maximum(last - np.arange(len(order)) - 1, 0)
    ends = np.cumsum(counts)
    begin = 0
    while begin < len(order):
        base = ends[begin - 1] if begin else 0
        end = max(int(np.searchsorted(ends, base + CHUNK, side='right')), begin + 1)
        sizes = counts[begin:end]
        first = np.repeat(np.arange(begin, end), sizes)
        # 0, 1, 2 ... within each triangle's partners
        step = np.arange(len(first)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        one, other = order[first], order[first + 1 + step]
        apart = (low[one] > high[other]) | (low[other] > high[one])
        one, other = one[~apart.any(axis=1)], other[~apart.any(axis=1)]
        gaps = triangles[one][:, :, None] - triangles[other][:, None]
        # Triangles that share a corner touch without crossing.
        alone = ~(np.abs(gaps).max(axis=3) == 0.0).any(axis=(1, 2))
        yield one[alone], other[alone]
        begin = end


def _find_pierced_triangles(begin: Array, end: Array, triangle: Array) -> NDArray[np.bool_]:
    """Return which segments pass through which triangles (Moeller and Trumbore 1997)."""
    way = end - begin
    side, other = triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
    normal = np.cross(way, other)
    scale = np.einsum('ij,ij->i', side, normal)
    # Parallel to the triangle's plane: no intersection, and no division by zero
    flat = np.abs(scale) < 1e-300
    scale = np.where(flat, 1.0, scale)
    away = begin - triangle[:, 0]
    u = np.einsum('ij,ij->i', away, normal) / scale
    turned = np.cross(away, side)
    v = np.einsum('ij,ij->i', way, turned) / scale
    t = np.einsum('ij,ij->i', other, turned) / scale
    # Barycentric coordinates u, v and the position t on the segment, all strictly inside
    within = (u > TOUCH) & (v > TOUCH) & (u + v < 1.0 - TOUCH)
    through: NDArray[np.bool_] = ~flat & within & (t > TOUCH) & (t < 1.0 - TOUCH)
    return through
