"""Find the connected areas of the floor that receive too few lamps, and why."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_studies.light.plan.layout import LampLayout
import numpy as np
from scipy import ndimage

BEYOND = 'out of reach of all possible lamp positions'
DROWNED = 'interference from other lamps'
FEW = 'too few lamps'


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
        BEYOND if reach < layout.overlap else DROWNED if near >= layout.overlap else FEW
        for reach, near in zip(layout.reachable, alone, strict=True)
    ]


def _most_common_word(words: Sequence[str]) -> str:
    # Sorted, so that ties do not depend on the order of a set.
    return max(sorted(set(words)), key=words.count)
