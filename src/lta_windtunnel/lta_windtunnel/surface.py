"""Read the pressure on the bodies of a solved flow: extremes, and a map seen from below."""

from pathlib import Path
from typing import Final

from lta_windtunnel.openfoam.output_reader import parse_table
from lta_windtunnel.sweep_table import SurfacePressure
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import NearestNDInterpolator
from scipy.spatial import ConvexHull, Delaunay

Array = NDArray[np.float64]
CELLS: Final = 41  # of the map, along a side


def read_surface_pressure(folder: Path, body: str, density: float) -> SurfacePressure:
    """Return the pressure on a body (a patch of the case) at the end of a flow."""
    places = sorted(
        (folder / 'postProcessing' / 'pressure').glob(f'*/p_{body}.raw'),
        key=lambda place: float(place.parent.name),
    )
    rows = parse_table(places[-1].read_text(encoding='utf-8'))
    return summarize_surface_pressure(rows[:, :3], density * rows[:, 3])


def summarize_surface_pressure(places: Array, pressure: Array) -> SurfacePressure:
    """
    Reduce the pressure on a body to its extremes and a map.

    `places`: face centres, body axes [m]. `pressure`: relative to the far field [Pa].
    """
    low, high = int(pressure.argmin()), int(pressure.argmax())
    side = 2.0 * float(np.abs(places[:, :2]).max())
    return SurfacePressure(
        least=_round_to_three_digits(pressure[low]), most=_round_to_three_digits(pressure[high]),
        least_at=[_round_to_three_digits(each) for each in places[low]],
        most_at=[_round_to_three_digits(each) for each in places[high]],
        below=_lower_pressure_grid(places, pressure, side), side=_round_to_three_digits(side),
    )  # fmt: skip


def _lower_pressure_grid(places: Array, pressure: Array, side: float) -> list[list[float | None]]:
    """Return the pressure on the lower half, on a grid of x and y, from the nearest face."""
    under = places[:, 2] <= float(places[:, 2].mean())
    flat = places[under, :2]
    # Centres of the map's cells
    steps = side * ((np.arange(CELLS) + 0.5) / CELLS - 0.5)
    x, y = np.meshgrid(steps, steps)
    values = NearestNDInterpolator(flat, pressure[under])(x, y)
    # Cells outside the body's outline would get the value of a far face
    outline = Delaunay(flat[ConvexHull(flat).vertices])
    inside = outline.find_simplex(np.stack((x, y), axis=-1)) >= 0
    rows: list[list[float]] = np.where(inside, values, np.nan).tolist()
    # NaN is the only value unequal to itself; JSON has no NaN
    return [
        [None if value != value else _round_to_three_digits(value) for value in row]
        for row in rows
    ]


def _round_to_three_digits(number: float) -> float:
    return float(f'{number:.3g}')
