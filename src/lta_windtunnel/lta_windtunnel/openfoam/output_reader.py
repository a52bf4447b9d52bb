"""Read OpenFOAM's output: forces on patches, momentum through them, and mesh statistics."""

from dataclasses import dataclass
from pathlib import Path
import re
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
NUMBER: Final = re.compile(r'[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?')


def parse_table(text: str) -> Array:
    """Return the numbers of a table, brackets ignored, as an array (rows, columns)."""
    rows = [
        [float(each) for each in NUMBER.findall(line)]
        for line in text.splitlines()
        if line.strip() and not line.lstrip().startswith('#')
    ]
    width = max((len(row) for row in rows), default=0)
    # The last line may be incomplete while the solver still writes, or after it was stopped
    return np.array([row for row in rows if len(row) == width]).reshape(-1, width)


@final
@dataclass(frozen=True, slots=True)
class WrenchHistory:
    """Force and moment on a patch at each iteration, at 1 kg/m3, about the origin."""

    time: Array  # iteration, or time [1 or s]
    # [N, N m]
    force: Array
    moment: Array
    viscous: Array  # viscous part of the force [N]


def read_forces(folder: Path, name: str, begin: str) -> WrenchHistory:
    """Read the output of the function object `forces_<name>` for the step that began at a time."""
    place = folder / 'postProcessing' / f'forces_{name}' / begin
    force = parse_table((place / 'force.dat').read_text(encoding='utf-8'))
    moment = parse_table((place / 'moment.dat').read_text(encoding='utf-8'))
    # A stopped solver may have written one more row to one of the files
    rows = min(len(force), len(moment))
    return WrenchHistory(
        # Columns: time, total x y z, pressure x y z, viscous x y z
        force[:rows, 0], force[:rows, 1:4], moment[:rows, 1:4], force[:rows, 7:10]
    )  # fmt: skip


def read_momentum(folder: Path, patch: str, begin: str) -> Array:
    """Return the momentum flux through a patch at each iteration, at 1 kg/m3. [N]"""
    place = folder / 'postProcessing' / f'momentum_{patch}' / begin / 'surfaceFieldValue.dat'
    rows: Array = parse_table(place.read_text(encoding='utf-8'))[:, 1:4]
    return rows


def read_slice(folder: Path) -> Array | None:
    """Return the last slice as rows of x, y, z [m] and the velocity [m/s], or None."""
    places = sorted(
        (folder / 'postProcessing' / 'slice').glob('*/*plane*'),
        key=lambda place: float(place.parent.name),
    )
    return parse_table(places[-1].read_text(encoding='utf-8')) if places else None


def _parse_number(pattern: str, text: str) -> float:
    match = re.search(pattern, text)
    # NaN fails every check that follows
    return float(match[1]) if match else float('nan')


def read_mesh(folder: Path) -> dict[str, float | dict[str, int]]:
    """Return number of cells, skewness and angles of a mesh, and the cells of each zone."""
    check = (folder / 'log.check').read_text(encoding='utf-8')
    # The line appears only if there are negative cells.
    negative = re.search(r'Number of negative volume cells: (\d+)', check)
    zones = folder / 'log.zones'
    zone_sizes = {
        name: int(count)
        for name, count in re.findall(
            r'cellZoneSet (\w+) now size (\d+)',
            zones.read_text(encoding='utf-8') if zones.is_file() else '',
        )
    }
    return {
        'cells': _parse_number(r'cells:\s+(\d+)', check),
        'non_orthogonality': _parse_number(r'non-orthogonality Max: ([\d.]+)', check),
        'skewness': _parse_number(r'Max skewness = ([\d.]+)', check),
        'negative': float(negative[1]) if negative else 0.0,
        'zones': zone_sizes,
    }


def read_patches(folder: Path) -> dict[str, int]:
    """Return the number of faces of each non-empty patch of a mesh."""
    check = (folder / 'log.check').read_text(encoding='utf-8')
    table = check.partition('Surface topology\n')[2].partition('\n\n')[0]
    # The topology result is ignored: touching bodies are not simple surfaces.
    rows = (line.split() for line in table.splitlines())
    return {name: int(faces) for name, faces, *_ in rows}
