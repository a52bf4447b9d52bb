# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Read OpenFOAM's output: forces on patches, momentum through them, and facts of a mesh."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
import re
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FORCE_NUMBER: Final = re.compile(r'[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?')


def read_table(path: Path) -> Array:
    """Return the numbers of a table, brackets ignored, as an array (rows, columns)."""
    rows = [
        [float(each) for each in FORCE_NUMBER.findall(line)]
        for line in path.read_text(encoding='utf-8').splitlines()
        if line.strip() and not line.lstrip().startswith('#')
    ]
    width = max((len(row) for row in rows), default=0)
    # The last line may be incomplete while the solver still writes, or after it was stopped
    return np.array([row for row in rows if len(row) == width]).reshape(-1, width)


def read_last_table(folder: Path, record: str, pattern: str) -> Array | None:
    """Return the table that a record wrote last, or None if it wrote none."""
    paths = (folder / 'postProcessing' / record).glob(f'*/{pattern}')
    last = max(paths, key=lambda path: float(path.parent.name), default=None)
    return None if last is None else read_table(last)


@final
@dataclass(frozen=True, slots=True)
class WrenchHistory:
    """Force and moment on a patch at each iteration, at 1 kg/m3, about the origin."""

    time: Array  # iteration, or time [1 or s]
    # [N, N m]
    force: Array
    moment: Array
    viscous: Array  # viscous part of the force [N]

    def select(self, rows: slice | NDArray[np.bool_]) -> 'WrenchHistory':
        """Return some iterations."""
        return WrenchHistory(
            self.time[rows], self.force[rows], self.moment[rows], self.viscous[rows]
        )


def read_forces(folder: Path, name: str, begin: str) -> WrenchHistory:
    """Read the record `forces_<name>` of the step that began at a time."""
    place = folder / 'postProcessing' / f'forces_{name}' / begin
    force, moment = read_table(place / 'force.dat'), read_table(place / 'moment.dat')
    # A stopped solver may have written one more row to one of the files
    rows = min(len(force), len(moment))
    # Columns: time, total x y z, pressure x y z, viscous x y z
    force, moment = force[:rows], moment[:rows]
    return WrenchHistory(force[:, 0], force[:, 1:4], moment[:, 1:4], force[:, 7:10])


def read_momentum(folder: Path, patch: str, begin: str) -> Array:
    """Return the momentum flux through a patch at each iteration, at 1 kg/m3 [N]."""
    place = folder / 'postProcessing' / f'momentum_{patch}' / begin
    return read_table(place / 'surfaceFieldValue.dat')[:, 1:4]


@final
@dataclass(frozen=True, slots=True)
class MeshFacts:
    """What checkMesh and topoSet say of a mesh; NaN, which fails every check, if missing."""

    cells: float
    non_orthogonality: float  # largest [deg]
    negative: float  # number of cells of negative volume
    zones: Mapping[str, int]  # cells of each zone
    faces: Mapping[str, int]  # faces of each non-empty patch


def read_mesh(folder: Path) -> MeshFacts:
    """Return the facts of a mesh."""
    check = (folder / 'log.check').read_text(encoding='utf-8')
    log = folder / 'log.zones'
    zones = log.read_text(encoding='utf-8') if log.is_file() else ''
    # The topology result is ignored: touching bodies are not simple surfaces.
    patches = check.partition('Surface topology\n')[2].partition('\n\n')[0]

    def find(pattern: str, otherwise: float = float('nan')) -> float:
        match = re.search(pattern, check)
        return float(match[1]) if match else otherwise

    return MeshFacts(
        find(r'cells:\s+(\d+)'),
        find(r'non-orthogonality Max: ([\d.]+)'),
        # The line appears only if there are negative cells.
        find(r'Number of negative volume cells: (\d+)', 0.0),
        {name: int(n) for name, n in re.findall(r'cellZoneSet (\w+) now size (\d+)', zones)},
        {name: int(n) for name, n, *_ in (line.split() for line in patches.splitlines())},
    )
