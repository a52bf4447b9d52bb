"""
Build meshes: a block of cubes, refined towards the bodies by snappyHexMesh, hull with layers.

All lengths scale with the hull's length, so that small and large drones get the same mesh. The
base cube is a quarter of the hull's length; each refinement level halves it.
"""

from collections.abc import Container, Mapping, Sequence
from io import BytesIO
from typing import Final

from lta_windtunnel.openfoam.case import FoamCase, ProgramStep
from lta_windtunnel.openfoam.dictionary import Entry, format_dictionary
from lta_windtunnel.tunnel_model import HULL
import numpy as np
from numpy.typing import NDArray
import trimesh

Array = NDArray[np.float64]
SURFACES: Final = 'constant/triSurface/'
BASE: Final = 0.25  # of the hull's length
FEATURE: Final = 130.0  # deg: layers go around the edges of boxes
QUALITY: Final[Mapping[str, Entry]] = {
    'maxNonOrtho': 65, 'maxBoundarySkewness': 20, 'maxInternalSkewness': 4, 'maxConcave': 80,
    'minVol': 1e-16, 'minTetQuality': 1e-15, 'minArea': -1, 'minTwist': 0.02,
    'minDeterminant': 0.001, 'minFaceWeight': 0.05, 'minVolRatio': 0.01,
    'minTriangleTwist': -1, 'nSmoothScale': 4, 'errorReduction': 0.75,
    'relaxed': {'maxNonOrtho': 75},
}  # fmt: skip


def format_block_mesh(
    low: Array, high: Array, size: float, patches: Mapping[str, Sequence[str]]
) -> str:
    """
    Return blockMeshDict of a box of cubes.

    `low`, `high`: corners [m]. `size`: edge of a cube [m]. `patches`: faces ('x-', 'z+', ...) of
    each patch; 'symmetry' in a name makes it a symmetry plane.
    """
    counts = np.maximum(np.rint((high - low) / size), 1).astype(int)
    ends = (low, high)
    corners = [
        (i, j, k) for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]  # as blockMesh counts them
    vertices = [[float(ends[c[a]][a]) for a in range(3)] for c in corners]
    # Vertex numbers of each face, in blockMesh's order: outward normals
    faces = {
        'x-': [0, 4, 7, 3], 'x+': [1, 2, 6, 5], 'y-': [0, 1, 5, 4], 'y+': [3, 7, 6, 2],
        'z-': [0, 3, 2, 1], 'z+': [4, 5, 6, 7],
    }  # fmt: skip
    boundary: list[Entry] = []
    for name, sides in patches.items():
        kind = 'symmetryPlane' if 'symmetry' in name else 'patch'
        boundary += [name, {'type': kind, 'faces': [faces[side] for side in sides]}]
    return format_dictionary('blockMeshDict', {
        'scale': 1,
        'vertices': vertices,
        'blocks': ['hex', list(range(8)), counts.tolist(), 'simpleGrading', [1, 1, 1]],
        'boundary': boundary,
    })  # fmt: skip


def format_snappy_mesh(
    bodies: Mapping[str, int],
    cube: float,
    regions: Mapping[str, tuple[Mapping[str, Entry], int]],
    inside: Sequence[float],
    shell: tuple[float, int],
    layers: int,
    expansion: float,
    most: int,
) -> str:
    """
    Return snappyHexMeshDict.

    Parameters
    ----------
    bodies : mapping of str to int
        Refinement level of each surface.
    cube : float
        Edge of the base cube. [m]
    regions : mapping of str to (mapping, int)
        Shape and level of each refined region.
    inside : sequence of 3 floats
        A point in the air. [m]
    shell : (float, int)
        Refinement distance around the hull [m], and its level.
    layers : int
        Number of prism layers on the hull.
    expansion : float
        Thickness ratio of successive layers. [1]
    most : int
        Maximum number of cells.

    """
    geometry: dict[str, Entry] = {
        f'{name}.stl': {'type': 'triSurfaceMesh', 'name': name} for name in bodies
    }
    geometry |= {name: shape for name, (shape, _) in regions.items()}
    around: dict[str, Entry] = {
        # The distance is ignored in mode 'inside', but required
        name: {'mode': 'inside', 'levels': [[1e15, level]]}
        for name, (_, level) in regions.items()
    }
    around[HULL] = {'mode': 'distance', 'levels': [list(shell)]}
    around |= {
        name: {'mode': 'distance', 'levels': _refinement_shells(cube, level)}
        for name, level in bodies.items()
        if name != HULL
    }
    return format_dictionary('snappyHexMeshDict', {
        'castellatedMesh': True, 'snap': True, 'addLayers': layers > 0,
        'geometry': geometry,
        'castellatedMeshControls': {
            'maxLocalCells': most, 'maxGlobalCells': most, 'minRefinementCells': 10,
            'nCellsBetweenLevels': 3, 'features': [], 'resolveFeatureAngle': 30,
            'allowFreeStandingZoneFaces': True, 'locationInMesh': list(inside),
            'refinementSurfaces': {
                name: {'level': [level, level], 'patchInfo': {'type': 'wall'}}
                for name, level in bodies.items()
            },
            'refinementRegions': around,
        },
        'snapControls': {
            'nSmoothPatch': 3, 'tolerance': 2.0, 'nSolveIter': 30, 'nRelaxIter': 5,
            'nFeatureSnapIter': 10, 'implicitFeatureSnap': True, 'explicitFeatureSnap': False,
            'multiRegionFeatureSnap': False,
        },
        'addLayersControls': {
            'relativeSizes': True, 'layers': {HULL: {'nSurfaceLayers': layers}},
            'expansionRatio': expansion, 'finalLayerThickness': 0.35, 'minThickness': 0.02,
            'nGrow': 0, 'featureAngle': FEATURE, 'slipFeatureAngle': 30, 'nRelaxIter': 5,
            'nSmoothSurfaceNormals': 1, 'nSmoothNormals': 3, 'nSmoothThickness': 10,
            'maxFaceThicknessRatio': 0.5, 'maxThicknessToMedialRatio': 0.3,
            'minMedialAxisAngle': 90, 'nBufferCellsNoExtrude': 0, 'nLayerIter': 50,
            'nRelaxedIter': 20,
        },
        'meshQualityControls': QUALITY,
        'writeFlags': [], 'mergeTolerance': 1e-6,
    })  # fmt: skip


def build_mesh_case(
    name: str,
    surfaces: Mapping[str, trimesh.Trimesh],
    block_text: str,
    snappy_text: str,
    cells: int,
    zones: str = '',
) -> FoamCase:
    """
    Return the case that creates a mesh.

    `surfaces`: bodies in tunnel axes. `cells`: expected number of cells. `zones`: topoSetDict of
    the cell zones, if any.
    """
    from lta_windtunnel.openfoam.numerics import (
        format_control_dict,
        format_fv_solution,
        format_steady_fv_schemes,
    )

    files: dict[str, str | bytes] = {
        f'{SURFACES}{each}.stl': _encode_stl(mesh) for each, mesh in surfaces.items()
    }
    files |= {
        'system/blockMeshDict': block_text,
        'system/snappyHexMeshDict': snappy_text,
        'system/controlDict': format_control_dict('snappyHexMesh', 0, 1, {}),
        # snappyHexMesh requires these files even though no flow is solved
        'system/fvSchemes': format_steady_fv_schemes(),
        'system/fvSolution': format_fv_solution(),
    }
    steps = [
        ProgramStep('block', ('blockMesh',)),
        ProgramStep('snappy', ('snappyHexMesh', '-overwrite'), rounds=60),
    ]
    if zones:
        files['system/topoSetDict'] = zones
        steps.append(ProgramStep('zones', ('topoSet',)))
    steps.append(ProgramStep('check', ('checkMesh',)))
    return FoamCase(name, files, steps, cells=cells)


def _refinement_shells(cube: float, level: int) -> list[Entry]:
    """
    Return the refinement distance around a body for each level.

    snappyHexMesh detects a surface only between the centres of two cells, so coarse cells would
    miss a thin plate or bar. Cells are therefore refined wherever their corner may touch it.
    """
    # Two cells of each level, from the finest down to level 3
    return [[2.0 * cube * 2.0**-each, each] for each in range(level, 2, -1)]


def list_solved_bodies(mesh: FoamCase, patches: Container[str]) -> list[str]:
    """Return the bodies of a mesh that reach into the solved part of the tunnel."""
    bodies = []
    for path, data in mesh.files.items():
        if not path.startswith(SURFACES):
            continue
        assert isinstance(data, bytes)
        _, high_y, high_z = trimesh.load_mesh(BytesIO(data), file_type='stl').bounds[1]
        # Of a tunnel that is cut, y > 0 and z > 0 is left.
        if not ('symmetryY' in patches and high_y <= 0.0) and not (
            'symmetryZ' in patches and high_z <= 0.0
        ):
            bodies.append(path.removeprefix(SURFACES).removesuffix('.stl'))
    return bodies


def _encode_stl(mesh: trimesh.Trimesh) -> bytes:
    """Return a surface as binary STL."""
    data = mesh.export(file_type='stl')
    assert isinstance(data, bytes)
    return data
