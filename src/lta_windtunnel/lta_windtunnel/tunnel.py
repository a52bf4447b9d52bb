# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build the cases of the wind tunnel: air along the tunnel's x, the vehicle rotated into it.

The air speed is always 1 m/s, and the viscosity is divided by the intended speed (Reynolds
similarity): one mesh then serves all speeds, and each starts from the previous flow. Forces are
those at 1 m/s and 1 kg/m3, and scale with rho U^2.

For a mirror-symmetric vehicle, half or a quarter of the domain is solved. This also helps the
steady solver, because an unconstrained steady wake does not settle.
"""

from collections.abc import Mapping, Sequence
import math
from typing import Final

from lta_windtunnel.openfoam.case import FoamCase, ProgramStep
from lta_windtunnel.openfoam.input_files import (
    build_flow_records,
    DETACHED,
    Entry,
    format_air,
    format_control,
    format_files,
    format_steady_settings,
    format_time,
    format_transient_settings,
    format_tunnel_fields,
    TRANSITION,
)
from lta_windtunnel.openfoam.mesh import build_mesh_case, MeshFineness, Region
from lta_windtunnel.tunnel_model import TunnelModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SPEEDS: Final = (0.2, 0.5, 1.0, 1.5, 2.0)
# Until a flow has settled, from nothing and from another speed
FIRST_ITERATIONS, NEXT_ITERATIONS = 300, 120
SETTLING_ITERATIONS: Final = 60  # steady iterations before a transient
# Lengths of flow over which a transient begins, and its Courant numbers then and later: eddies
# that a steady flow has not shed yet come all at once.
FIRST_COURANT_LENGTHS: Final = 0.25
FIRST_COURANT: Final = 1.0
COURANT: Final = 4.0
OUTER_PATCHES: Final = ('inlet', 'outlet', 'sides')

# Body axes to tunnel axes for a vehicle that moves along its x, y or z: the air then comes along
# minus that axis. Columns are where body x, y, z point in the tunnel.
TUNNEL_TURNS: Final = {
    'surge': np.array([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]),
    'sway': np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    'heave': np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
}
INCIDENCES: Final = {f'incidence_{angle}': float(angle) for angle in (10, 20, 30, 40)}  # deg


def rotate_into_tunnel(direction: str) -> Array:
    """
    Return the rotation from body axes to tunnel axes of a key of `TUNNEL_TURNS` or an incidence.

    At an incidence the air comes from ahead and below: the nose is up by that angle.
    """
    if direction in TUNNEL_TURNS:
        return TUNNEL_TURNS[direction]
    angle = math.radians(INCIDENCES[direction])
    c, s = math.cos(angle), math.sin(angle)
    # The vehicle moves along (c, 0, -s), from which the air comes
    rows: Array = np.array([[-c, 0.0, s], [0.0, -1.0, 0.0], [s, 0.0, c]])
    return rows


PREVIEW: Final = MeshFineness()
COARSE_MESH: Final = MeshFineness(hull=3, parts=4, cells=100_000)
REFERENCE: Final = MeshFineness(shell=0.15, layers=5, expansion=1.4, cells=189_000)
ROUGH_MESH: Final = MeshFineness(
    hull=3, parts=4, shell=0.15, layers=5, expansion=1.4, cells=100_000
)
FAST_MESH: Final = MeshFineness(trail=3, shell=0.15, layers=8, expansion=1.4, cells=346_000)
# Reynolds number of the hull up to which a transient needs no model. Beyond, a sphere's drag fell
# as that of real ones does at twice the speed; a model of detached eddies keeps the layer along it
# laminar, and gives 0.53 at half that speed, over all that was measured.
MAX_LAMINAR_REYNOLDS: Final = 1e5


def needs_eddy_model(model: TunnelModel, viscosity: float, speed: float) -> bool:
    """Return whether a transient needs a model of eddies; viscosity in m2/s, speed in m/s."""
    return speed * model.length / viscosity > MAX_LAMINAR_REYNOLDS


def choose_mesh_fineness(model: TunnelModel, viscosity: float, speed: float) -> MeshFineness:
    """Return the mesh fineness of a transient; viscosity in m2/s, speed in m/s."""
    return FAST_MESH if needs_eddy_model(model, viscosity, speed) else REFERENCE


def has_symmetry_planes(model: TunnelModel, axis: str) -> tuple[bool, bool]:
    """Return whether the tunnel's planes y = 0 and z = 0 are planes of symmetry."""
    if axis in INCIDENCES:
        return bool(model.is_mirror_symmetric(1)), False
    turn = TUNNEL_TURNS[axis]
    planes = [bool(model.is_mirror_symmetric(int(np.argmax(np.abs(turn[k]))))) for k in (1, 2)]
    return planes[0], planes[1]


def build_tunnel_mesh(
    model: TunnelModel, axis: str, fine: MeshFineness, planes: tuple[bool, bool]
) -> FoamCase:
    """
    Return the mesh of a tunnel.

    `axis`: direction of motion: 'surge', 'sway', 'heave', or an incidence such as 'incidence_20'.
    `planes`: whether only y > 0 and only z > 0 are solved.
    """
    size = model.length
    turn = np.eye(4)
    turn[:3, :3] = rotate_into_tunnel(axis)
    surfaces = {name: mesh.copy() for name, mesh in model.bodies.items()}
    for mesh in surfaces.values():
        mesh.apply_transform(turn)
    # Four lengths of air ahead and to the sides, eight for the wake
    low = np.array([-4.0, 0.0 if planes[0] else -4.0, 0.0 if planes[1] else -4.0])
    halves = _name_symmetry_planes(planes)
    sides = [face for face in ('y-', 'y+', 'z-', 'z+') if f'symmetry{face[0].upper()}' not in
             halves or face[1] == '+']  # fmt: skip
    patches = {'inlet': ['x-'], 'outlet': ['x+'], 'sides': sides}
    patches |= {name: [f'{name[-1].lower()}-'] for name in halves}

    def refine(begin: float, end: float, half: float, level: int) -> Region:
        """Return a refined box around the tunnel's axis, in lengths of the hull."""
        corner = half * size
        return {
            'type': 'searchableBox',
            'min': [begin * size, -corner, -corner], 'max': [end * size, corner, corner],
        }, level  # fmt: skip

    regions = {
        'wake': refine(-1.0, 3.0, 1.0, fine.trail - 1),
        'near': refine(-0.75, 1.5, 0.75, 2),
    }
    if fine.trail > PREVIEW.trail:
        regions['trail'] = refine(0.0, 1.5, 0.75, fine.trail)
    return build_mesh_case(
        f'{axis} mesh', surfaces, size, fine, (low, np.array([8.0, 4.0, 4.0])), patches, regions,
        [-2.913, 1.137, 1.071],
    )  # fmt: skip


def _name_symmetry_planes(planes: tuple[bool, bool]) -> list[str]:
    return [f'symmetry{name}' for name, is_one in zip('YZ', planes, strict=True) if is_one]


def format_absent(*names: str) -> dict[str, str]:
    """Return the files that the solvers require even if they are empty."""
    return format_files({f'constant/{name}': {} for name in names})


def build_steady_steps(
    values: Sequence[float], viscosity: float, functions: Mapping[str, Entry],
    rounds: tuple[int, int],
) -> list[ProgramStep]:  # fmt: skip
    """
    Return steps of the steady solver at several speeds [m/s] or rates [rad/s], one after another.

    Each is solved at 1 m/s or 1 rad/s with the kinematic viscosity [m2/s] divided by its value.
    `rounds`: iterations until the first flow has settled, and each later one.
    """
    steps, begin = [], 0
    for value in values:
        count = rounds[1] if begin else rounds[0]
        files = {
            **format_control('simpleFoam', begin, begin + count, functions),
            **format_air(viscosity / value),
        }
        steps.append(ProgramStep(f'{value:g}', ('simpleFoam',), files, count, str(begin)))
        begin += count
    return steps


def build_steady_wind_case(
    model: TunnelModel,
    axis: str,
    viscosity: float,
    fine: MeshFineness,
    speeds: Sequence[float] = SPEEDS,
) -> FoamCase:
    """
    Return the steady flow around a vehicle at several speeds [m/s], in the order given.

    The viscosity is kinematic. [m2/s] Other parameters as for `build_tunnel_mesh`.
    """
    planes = has_symmetry_planes(model, axis)
    mesh = build_tunnel_mesh(model, axis, fine, planes)
    functions = build_flow_records(model.bodies, model.length, OUTER_PATCHES)
    files = {
        **format_tunnel_fields(TRANSITION, tuple(model.bodies), _name_symmetry_planes(planes)),
        **format_absent('fvOptions', 'MRFProperties'),
        **format_steady_settings('kOmegaSSTLM'),
    }
    steps = build_steady_steps(speeds, viscosity, functions, (FIRST_ITERATIONS, NEXT_ITERATIONS))
    return FoamCase(axis, files, steps, mesh, mesh.cells)


def build_transient_wind_case(
    model: TunnelModel,
    axis: str,
    viscosity: float,
    fine: MeshFineness,
    speed: float,
    lengths: float,
) -> FoamCase:
    """
    Return the transient flow around a vehicle at one speed [m/s], in the whole tunnel.

    `lengths` is the simulated flow in hull lengths. Other parameters as for
    `build_steady_wind_case`.
    """
    mesh = build_tunnel_mesh(model, axis, fine, (False, False))
    functions = build_flow_records(model.bodies, model.length)
    begin = SETTLING_ITERATIONS + round(FIRST_COURANT_LENGTHS * model.length, 4)
    end = SETTLING_ITERATIONS + lengths * model.length
    # [s] At 1 m/s; twice as long for each coarser level of the hull
    longest = 0.03 * model.length * 2.0 ** (4 - fine.hull)
    eddies = format_transient_settings(needs_eddy_model(model, viscosity, speed))
    steps = [
        ProgramStep('settle', ('simpleFoam',), {
            **format_air(viscosity / speed),
            **format_steady_settings('SpalartAllmaras'),
            **format_control('simpleFoam', 0, SETTLING_ITERATIONS, {}),
        }, SETTLING_ITERATIONS),
        ProgramStep('begin', ('pimpleFoam',), {
            **eddies,
            # The steady solver counted iterations: reset the time step for the transient one
            **format_time(SETTLING_ITERATIONS, 0.05 * longest),
            **format_control(
                'pimpleFoam', SETTLING_ITERATIONS, begin, {}, (longest, FIRST_COURANT)
            ),
        }, int(6.0 * (begin - SETTLING_ITERATIONS) / longest), str(SETTLING_ITERATIONS)),
        ProgramStep(f'{speed:g}', ('pimpleFoam',), {
            **eddies,
            **format_control('pimpleFoam', begin, end, functions, (longest, COURANT)),
        }, int(1.5 * lengths * model.length / longest), f'{begin:.8g}'),
    ]  # fmt: skip
    files = {
        **format_tunnel_fields(DETACHED, tuple(model.bodies), (), viscosity / speed),
        **format_absent('fvOptions', 'MRFProperties'),
    }
    return FoamCase(f'{axis} {speed:g} m/s', files, steps, mesh, mesh.cells)
