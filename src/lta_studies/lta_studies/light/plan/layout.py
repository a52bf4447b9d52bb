# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define the result of a plan: lamps and their reception, its gaps, hand-overs and a route.

A flight to a lamp ends in the nearest cell that receives it; directly below a lamp the drone's own
hull hides it. The lamp hands over to every other lamp that is received there, if the straight path
to the end of that lamp's flight is free.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final, NamedTuple

from lta_studies.light.plan.floor import Array, FloorGrid, FloorPlan, LampMount, Mask
from lta_studies.light.plan.joint_snr import LightReceiver
import numpy as np
from scipy import ndimage
from scipy.sparse import csr_array
from scipy.sparse.csgraph import shortest_path


@final
@dataclass(frozen=True, slots=True)
class LayoutLamp:
    """A lamp of the layout."""

    name: str  # `lamp_1` and so on, or the name of an existing lamp
    mount: LampMount  # position and direction
    frequency: float  # flicker frequency [Hz]


@final
@dataclass(frozen=True, slots=True)
class LampLayout:
    """Result of a plan."""

    # Inputs
    plan: FloorPlan
    floor: FloorGrid
    ear: LightReceiver
    overlap: int  # number of lamps that each cell should receive
    lamps: tuple[LayoutLamp, ...]  # lamps from top left to bottom right
    # Light and SNR of each lamp over each wanted cell at the worst heading, all lamps on, shape
    # (lamps, cells) [lx, 1]
    light: Array
    snr: Array
    reachable: Array  # number of candidate positions that a cell could receive, shape (cells,)
    places: int  # number of candidate positions
    least: float  # light required to receive a single lamp [lx]
    order: int  # order up to which harmonics are outside the windows of other lamps
    bound: int  # lower bound on the number of lamps for full coverage

    @property
    def is_received(self) -> Mask:
        """Whether each lamp is received in each wanted cell, shape (lamps, cells)."""
        return np.asarray(self.snr >= self.ear.required_snr)

    @property
    def received_count(self) -> Array:
        """Return the number of lamps received in each wanted cell."""
        return np.asarray(self.is_received.sum(axis=0))

    @property
    def coverage(self) -> float:
        """Share of the wanted cells that receive enough lamps."""
        # All cells have the same area, so a share of cells is a share of area.
        return float((self.received_count >= self.overlap).mean())


OUT_OF_REACH = 'out of reach of all possible lamp positions'
INTERFERENCE = 'interference from other lamps'
TOO_FEW_LAMPS = 'too few lamps'


@final
class CoverageGap(NamedTuple):
    """A connected area of cells that receive too few lamps."""

    area: float  # area [m2]
    # Bounding box [m]
    west: float
    south: float
    east: float
    north: float
    why: str  # most common cause


def find_gaps(layout: LampLayout) -> list[CoverageGap]:
    """Return the gaps of a layout, largest first."""
    floor, half = layout.floor, 0.5 * layout.floor.cell
    # `overlap` lamps must be received everywhere; more than one allows hand-overs.
    lacking = layout.received_count < layout.overlap
    grid = np.zeros(floor.target_cells.shape, dtype=bool)
    grid[floor.target_cells] = lacking
    causes = np.full(floor.target_cells.shape, '', dtype=object)
    causes[floor.target_cells] = _find_gap_causes(layout)
    # Cells that touch at a corner belong together.
    labels, count = ndimage.label(grid, structure=np.ones((3, 3)))
    gaps = []
    for k in range(1, count + 1):
        rows, columns = np.nonzero(labels == k)
        x, y = floor.x[columns], floor.y[rows]
        why = _most_common_word(causes[rows, columns].tolist())
        west, south = float(x.min()) - half, float(y.min()) - half
        east, north = float(x.max()) + half, float(y.max()) + half
        gaps.append(CoverageGap(len(rows) * floor.cell**2, west, south, east, north, why))
    return sorted(gaps, key=lambda gap: -gap.area)


def _find_gap_causes(layout: LampLayout) -> list[str]:
    """Return the cause for each wanted cell, in case it is a gap."""
    # Lamps bright enough if no other lamp interfered
    alone = (layout.light >= layout.least).sum(axis=0)
    return [
        OUT_OF_REACH
        if reach < layout.overlap
        else INTERFERENCE
        if near >= layout.overlap
        else TOO_FEW_LAMPS
        for reach, near in zip(layout.reachable, alone, strict=True)
    ]


def _most_common_word(words: Sequence[str]) -> str:
    # Sorted, so that ties do not depend on the order of a set.
    return max(sorted(set(words)), key=words.count)


Place = tuple[float, float]


@final
@dataclass(frozen=True, slots=True)
class LampHandover:
    """Hand-overs between lamps."""

    # End of a flight to each lamp; None if it is received nowhere [m]
    arrivals: tuple[Place | None, ...]
    edges: tuple[tuple[int, int], ...]  # hand-overs, from lamp to lamp
    route: tuple[int, ...]  # the longest of the shortest paths between two lamps
    # Start of the route: the farthest place with a straight flight to the first lamp, tuple of 2
    # floats or None [m]
    start: Place | None


def plan_handover(layout: LampLayout) -> LampHandover:
    """Plan the hand-overs and the route of a layout."""
    centres, audible = layout.floor.cell_centers, layout.is_received
    ends = [find_arrival_cell(centres, audible[k], layout, k) for k in range(len(layout.lamps))]
    edges = []
    for i, here in enumerate(ends):
        for j, there in enumerate(ends):
            # Lamp j must be received where the flight to lamp i ends.
            if i == j or here is None or there is None or not audible[j, here]:
                continue
            if is_straight_path_clear(layout.floor, centres[here], centres[there]):
                edges.append((i, j))
    route = find_longest_route(len(ends), edges)
    start = None
    if route and (end := ends[route[0]]) is not None:
        start = find_farthest_place(layout.floor, centres, audible[route[0]], end)
    places = tuple(None if end is None else _to_point(centres[end]) for end in ends)
    return LampHandover(places, tuple(edges), route, start)


def find_arrival_cell(centres: Array, audible: Mask, layout: LampLayout, lamp: int) -> int | None:
    """Return the index of the cell where a flight to a lamp ends, or None."""
    if not audible.any():
        return None
    off = np.hypot(*(centres - layout.lamps[lamp].mount.position[:2]).T)
    # inf excludes cells that do not receive the lamp.
    return int(np.where(audible, off, np.inf).argmin())


def is_straight_path_clear(floor: FloorGrid, here: Array, there: Array) -> bool:
    """Return whether the hull fits along the straight path between two places [m]."""
    # Two samples per cell, so that no cell on the path is skipped.
    steps = max(int(np.ceil(2.0 * np.hypot(*(there - here)) / floor.cell)), 1)
    points = here + np.linspace(0.0, 1.0, steps + 1)[:, None] * (there - here)
    rows, columns = floor.locate_cells(points)
    return bool(floor.free[rows, columns].all())


def find_longest_route(count: int, edges: list[tuple[int, int]]) -> tuple[int, ...]:
    """Return the longest of the shortest paths in a graph, as nodes."""
    if not edges:
        return (0,) if count else ()
    rows, columns = np.array(edges).T
    graph = csr_array((np.ones(len(edges)), (rows, columns)), shape=(count, count))
    lengths, before = shortest_path(graph, unweighted=True, return_predecessors=True)
    # No path: never the longest.
    lengths[~np.isfinite(lengths)] = -1.0
    first, node = (int(k) for k in np.unravel_index(lengths.argmax(), lengths.shape))
    # Follow the predecessors from the end of the route back to its start.
    way = [node]
    while node != first:
        node = int(before[first, node])
        way.append(node)
    return tuple(reversed(way))


def find_farthest_place(floor: FloorGrid, centres: Array, audible: Mask, end: int) -> Place:
    """Return the farthest place that receives a lamp and has a straight path to it [m]."""
    off = np.where(audible, np.hypot(*(centres - centres[end]).T), -1.0)
    # From the farthest cell; the first one with a free path is the answer.
    for cell in np.argsort(-off):
        if off[cell] >= 0.0 and is_straight_path_clear(floor, centres[cell], centres[end]):
            return _to_point(centres[cell])
    return _to_point(centres[end])


def _to_point(place: Array) -> Place:
    x, y = place.tolist()
    return x, y
