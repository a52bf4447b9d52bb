# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build meshes: a block of cubes, refined towards the bodies by snappyHexMesh, hull with layers.

All lengths scale with the hull's length, so that small and large drones get the same mesh. The
base cube is a quarter of the hull's length; each refinement level halves it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_windtunnel.openfoam.case import FoamCase, ProgramStep
from lta_windtunnel.openfoam.input_files import (
    Entry,
    fill_settings,
    format_control,
    format_files,
    format_steady_settings,
)
from lta_windtunnel.tunnel_model import HULL_PATCH
import numpy as np
from numpy.typing import NDArray
import trimesh

Array = NDArray[np.float64]
Region = tuple[Mapping[str, Entry], int]  # shape and level
BASE_CUBE: Final = 0.25  # of the hull's length
# Vertex numbers of each face of a block, in blockMesh's order: outward normals
BLOCK_FACES: Final = {
    'x-': [0, 4, 7, 3], 'x+': [1, 2, 6, 5], 'y-': [0, 1, 5, 4], 'y+': [3, 7, 6, 2],
    'z-': [0, 3, 2, 1], 'z+': [4, 5, 6, 7],
}  # fmt: skip


@final
@dataclass(frozen=True, slots=True)
class MeshFineness:
    """Resolution of a mesh."""

    # Levels on the hull and on other bodies
    hull: int = 4
    parts: int = 5
    trail: int = 2  # level behind the hull, up to 1.5 lengths; one less up to 3
    shell: float = 0.12  # distance around the hull that is refined to level 3 [lengths]
    layers: int = 6  # number of prism layers on the hull
    expansion: float = 1.3  # thickness ratio of successive layers [1]
    cells: int = 185_000  # expected number of cells of the whole domain


def build_mesh_case(
    name: str,
    surfaces: Mapping[str, trimesh.Trimesh],
    size: float,
    fine: MeshFineness,
    box: tuple[Array, Array],
    patches: Mapping[str, Sequence[str]],
    regions: Mapping[str, Region],
    inside: Sequence[float],
    zones: Sequence[Entry] = (),
) -> FoamCase:
    """
    Return the case that creates a mesh.

    Parameters
    ----------
    name : str
        Name for users.
    surfaces : mapping of str to Trimesh
        Bodies in the axes of the mesh. [m]
    size : float
        Length of the hull. [m]
    fine : MeshFineness
        Resolution.
    box : (array, array)
        Lowest and highest corner, in lengths of the hull. [1]
    patches : mapping of str to sequence of str
        Faces of the box ('x-', 'z+', ...) in each patch; 'symmetry' in a name makes it a plane of
        symmetry, beyond which nothing is solved.
    regions : mapping of str to (mapping, int)
        Shape and level of each refined region.
    inside : sequence of 3 floats
        A point in the air that lies on no cell face, in lengths of the hull. [1]
    zones : sequence of mappings
        Actions of topoSet that create cell zones.

    """
    files: dict[str, str | bytes] = {}
    for each, mesh in surfaces.items():
        data = mesh.export(file_type='stl')
        assert isinstance(data, bytes)
        files[f'constant/triSurface/{each}.stl'] = data
    cube = BASE_CUBE * size
    files |= format_files({
        'system/blockMeshDict': _build_block(size * box[0], size * box[1], cube, patches)
    })  # fmt: skip
    levels = {each: fine.hull if each == HULL_PATCH else fine.parts for each in surfaces}
    files['system/snappyHexMeshDict'] = _format_refinement(levels, size, fine, regions, inside)
    files |= format_control('snappyHexMesh', 0, 1, {})
    # snappyHexMesh requires schemes and solvers even though no flow is solved
    settings = format_steady_settings('kOmegaSST')
    files |= {path: text for path, text in settings.items() if path.startswith('system')}
    steps = [
        ProgramStep('block', ('blockMesh',)),
        ProgramStep('snappy', ('snappyHexMesh', '-overwrite'), rounds=60),
    ]
    if zones:
        files |= format_files({'system/topoSetDict': {'actions': zones}})
        steps.append(ProgramStep('zones', ('topoSet',)))
    steps.append(ProgramStep('check', ('checkMesh',)))
    # Of a domain that is cut, y > 0 and z > 0 is left
    cut = [axis for axis, plane in ((1, 'symmetryY'), (2, 'symmetryZ')) if plane in patches]
    bodies = tuple(each for each, mesh in surfaces.items() if (mesh.bounds[1][cut] > 0.0).all())
    return FoamCase(name, files, steps, cells=int(fine.cells * 0.5 ** len(cut)), bodies=bodies)


def _build_block(
    low: Array, high: Array, edge: float, patches: Mapping[str, Sequence[str]]
) -> dict[str, Entry]:
    """Return blockMeshDict of a box of cubes between two corners [m]."""
    counts = np.maximum(np.rint((high - low) / edge), 1).astype(int)
    ends = (low, high)
    corners = [
        (i, j, k) for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]  # as blockMesh counts them
    boundary: list[Entry] = []
    for name, sides in patches.items():
        kind = 'symmetryPlane' if 'symmetry' in name else 'patch'
        boundary += [name, {'type': kind, 'faces': [BLOCK_FACES[side] for side in sides]}]
    return {
        'scale': 1,
        'vertices': [[float(ends[corner[a]][a]) for a in range(3)] for corner in corners],
        'blocks': ['hex', list(range(8)), counts.tolist(), 'simpleGrading', [1, 1, 1]],
        'boundary': boundary,
    }


def _format_refinement(
    levels: Mapping[str, int],
    size: float,
    fine: MeshFineness,
    regions: Mapping[str, Region],
    inside: Sequence[float],
) -> str:
    """Return snappyHexMeshDict for the level of each surface and a point in the air [m]."""
    geometry: dict[str, Entry] = {
        f'{name}.stl': {'type': 'triSurfaceMesh', 'name': name} for name in levels
    }
    around: dict[str, Entry] = {
        # The distance is ignored in mode 'inside', but required
        name: {'mode': 'inside', 'levels': [[1e15, level]]}
        for name, (_, level) in regions.items()
    }
    around[HULL_PATCH] = {'mode': 'distance', 'levels': [[fine.shell * size, 3]]}
    # snappyHexMesh detects a surface only between the centres of two cells, so coarse cells would
    # miss a thin plate or bar. Cells are therefore refined wherever their corner may touch it: two
    # cells of each level, from the finest down to level 3.
    cube = BASE_CUBE * size
    around |= {
        name: {
            'mode': 'distance',
            'levels': [[2.0 * cube * 2.0**-each, each] for each in range(level, 2, -1)],
        }
        for name, level in levels.items()
        if name != HULL_PATCH
    }
    return fill_settings(
        'mesh.snappyHexMeshDict',
        geometry={**geometry, **{name: shape for name, (shape, _) in regions.items()}},
        inside=[each * size for each in inside],
        surfaces={
            name: {'level': [level, level], 'patchInfo': {'type': 'wall'}}
            for name, level in levels.items()
        },
        regions=around,
        hull=HULL_PATCH,
        layers=fine.layers,
        expansion=fine.expansion,
    )
