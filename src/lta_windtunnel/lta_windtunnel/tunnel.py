"""
Build the cases of the wind tunnel: air along the tunnel's x, the vehicle rotated into it.

The air speed is always 1 m/s, and the viscosity is divided by the intended speed (Reynolds
similarity): one mesh then serves all speeds, and each starts from the previous flow. Forces are
those at 1 m/s and 1 kg/m3, and scale with rho U^2.

For a mirror-symmetric vehicle, half or a quarter of the domain is solved. This also helps the
steady solver, because an unconstrained steady wake does not settle.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Final, final

from lta_windtunnel.openfoam.case import FoamCase, ProgramStep
from lta_windtunnel.openfoam.dictionary import Entry, format_dictionary
from lta_windtunnel.openfoam.fields import DETACHED, format_tunnel_fields, TRANSITION
from lta_windtunnel.openfoam.mesh import (
    BASE,
    build_mesh_case,
    format_block_mesh,
    format_snappy_mesh,
)
from lta_windtunnel.openfoam.numerics import (
    build_force_functions,
    build_momentum_functions,
    build_slice_function,
    EDDY_VISCOSITY,
    format_control_dict,
    format_fv_solution,
    format_steady_fv_schemes,
    format_time_file,
    format_transient_fv_schemes,
    format_transient_fv_solution,
)
from lta_windtunnel.tunnel_model import HULL, TunnelModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SPEEDS: Final = (0.2, 0.5, 1.0, 1.5, 2.0)
FIRST, NEXT = 300, 120  # iterations until a flow has settled, from nothing and from another speed
SETTLING: Final = 60  # steady iterations before a transient
# Lengths of flow over which a transient begins, and its Courant numbers then and later: eddies
# that a steady flow has not shed yet come all at once.
BEGINNING: Final = 0.25
CAREFUL: Final = 1.0
BOLD: Final = 4.0
OUTER: Final = ('inlet', 'outlet', 'sides')

# Body axes to tunnel axes for a vehicle that moves along its x, y or z: the air then comes along
# minus that axis. Columns are where body x, y, z point in the tunnel.
TURNS: Final = {
    'surge': np.array([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]),
    'sway': np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    'heave': np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
}
INCIDENCES: Final = {f'incidence_{angle}': float(angle) for angle in (10, 20, 30, 40)}  # deg


def rotate_into_tunnel(direction: str) -> Array:
    """
    Return the rotation from body axes to tunnel axes for an axis of `TURNS` or an incidence.

    At an incidence the air comes from ahead and below: the nose is up by that angle.
    """
    if direction in TURNS:
        return TURNS[direction]
    angle = math.radians(INCIDENCES[direction])
    c, s = math.cos(angle), math.sin(angle)
    # The vehicle moves along (c, 0, -s), from which the air comes
    rows: Array = np.array([[-c, 0.0, s], [0.0, -1.0, 0.0], [s, 0.0, c]])
    return rows


@final
@dataclass(frozen=True, slots=True)
class MeshFineness:
    """Resolution of a tunnel mesh."""

    # Levels on the hull and on other bodies
    hull: int = 4
    parts: int = 5
    trail: int = 2  # level behind the hull, up to 1.5 lengths; one less up to 3
    shell: float = 0.12  # distance around the hull that is refined to level 3 [lengths]
    layers: int = 6  # number of prism layers on the hull
    expansion: float = 1.3  # thickness ratio of successive layers [1]
    # Expected and maximum number of cells of the whole domain
    cells: int = 185_000
    most: int = 3_000_000


PREVIEW: Final = MeshFineness()
COARSE: Final = MeshFineness(hull=3, parts=4, cells=100_000)
REFERENCE: Final = MeshFineness(shell=0.15, layers=5, expansion=1.4, cells=189_000)
ROUGH: Final = MeshFineness(hull=3, parts=4, shell=0.15, layers=5, expansion=1.4, cells=100_000)
FAST: Final = MeshFineness(trail=3, shell=0.15, layers=8, expansion=1.4, cells=346_000)
# Reynolds number of the hull up to which a transient needs no model. Beyond, a sphere's drag fell
# as that of real ones does at twice the speed; a model of detached eddies keeps the layer along it
# laminar, and gives 0.53 at half that speed, over all that was measured.
MODELLED: Final = 1e5


def needs_eddy_model(model: TunnelModel, viscosity: float, speed: float) -> bool:
    """Return whether a transient needs a model of eddies; viscosity in m2/s, speed in m/s."""
    return speed * model.length / viscosity > MODELLED


def choose_mesh_fineness(model: TunnelModel, viscosity: float, speed: float) -> MeshFineness:
    """Return the mesh fineness of a transient; viscosity in m2/s, speed in m/s."""
    return FAST if needs_eddy_model(model, viscosity, speed) else REFERENCE


def has_symmetry_planes(model: TunnelModel, axis: str) -> tuple[bool, bool]:
    """Return whether the tunnel's planes y = 0 and z = 0 are planes of symmetry."""
    if axis in INCIDENCES:
        return bool(model.is_mirror_symmetric(1)), False
    turn = TURNS[axis]
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
    low = size * np.array([-4.0, 0.0 if planes[0] else -4.0, 0.0 if planes[1] else -4.0])
    high = size * np.array([8.0, 4.0, 4.0])
    halves = [f'symmetry{name}' for name, is_one in zip('YZ', planes, strict=True) if is_one]
    sides = [face for face in ('y-', 'y+', 'z-', 'z+') if f'symmetry{face[0].upper()}' not in
             halves or face[1] == '+']  # fmt: skip
    patches = {'inlet': ['x-'], 'outlet': ['x+'], 'sides': sides}
    patches |= {name: [f'{name[-1].lower()}-'] for name in halves}
    wide, near = 1.0 * size, 0.75 * size
    regions = {
        'wake': (_refinement_box((-wide, -wide, -wide), (3.0 * size, wide, wide)), fine.trail - 1),
        'near': (_refinement_box((-near, -near, -near), (1.5 * size, near, near)), 2),
    }
    if fine.trail > PREVIEW.trail:
        regions['trail'] = (
            _refinement_box((0.0, -near, -near), (1.5 * size, near, near)),
            fine.trail,
        )
    text = format_snappy_mesh(
        {name: fine.hull if name == HULL else fine.parts for name in surfaces},
        BASE * size,
        regions,
        # A point in the air that lies on no cell face
        [-2.913 * size, 1.137 * size, 1.071 * size],
        (fine.shell * size, 3),
        fine.layers,
        fine.expansion,
        fine.most,
    )
    share = 2 ** -sum(planes)
    return build_mesh_case(
        f'{axis} mesh',
        surfaces,
        format_block_mesh(low, high, BASE * size, patches),
        text,
        int(fine.cells * share),
    )


def _refinement_box(low: Sequence[float], high: Sequence[float]) -> Mapping[str, Entry]:
    return {'type': 'searchableBox', 'min': list(low), 'max': list(high)}


def format_transport_properties(viscosity: float) -> str:
    """Return transportProperties; kinematic viscosity in m2/s."""
    return format_dictionary(
        'transportProperties', {'transportModel': 'Newtonian', 'nu': viscosity}
    )


def format_turbulence_properties(model: str | None) -> str:
    """Return turbulenceProperties of a RANS model, or of a laminar flow."""
    if model is None:
        return format_dictionary('turbulenceProperties', {'simulationType': 'laminar'})
    return format_dictionary('turbulenceProperties', {
        'simulationType': 'RAS',
        'RAS': {'RASModel': model, 'turbulence': True, 'printCoeffs': False},
    })  # fmt: skip


def format_detached_eddies() -> str:
    """Return turbulenceProperties of DDES, which resolves eddies larger than its cells."""
    return format_dictionary('turbulenceProperties', {
        'simulationType': 'LES',
        'LES': {
            'LESModel': 'SpalartAllmarasDDES', 'turbulence': True, 'printCoeffs': False,
            'delta': 'maxDeltaxyz', 'maxDeltaxyzCoeffs': {},
        },
    })  # fmt: skip


def empty_files() -> dict[str, str]:
    """Return the files that the solvers require even if they are empty."""
    return {
        f'constant/{name}': format_dictionary(name, {}) for name in ('fvOptions', 'MRFProperties')
    }  # the solvers look for both


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
    walls = tuple(model.bodies)
    halves = [f'symmetry{name}' for name, is_one in zip('YZ', planes, strict=True) if is_one]
    functions = {
        **build_force_functions(
            {name: name for name in walls} | {'outer': '"(inlet|outlet|sides)"'}
        ),
        **build_momentum_functions(OUTER),
        **build_slice_function((0, 1, 0), model.length),
    }
    steps, begin = [], 0
    for speed in speeds:
        end = begin + (NEXT if begin else FIRST)
        files = {
            'system/controlDict': format_control_dict('simpleFoam', begin, end, functions),
            'constant/transportProperties': format_transport_properties(viscosity / speed),
        }
        steps.append(ProgramStep(f'{speed:g}', ('simpleFoam',), files, end - begin, str(begin)))
        begin = end
    files = {
        **format_tunnel_fields(TRANSITION, walls, halves),
        **empty_files(),
        'constant/turbulenceProperties': format_turbulence_properties('kOmegaSSTLM'),
        'system/fvSchemes': format_steady_fv_schemes(),
        'system/fvSolution': format_fv_solution(),
    }
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
    walls = tuple(model.bodies)
    functions = build_force_functions({name: name for name in walls})
    functions |= build_slice_function((0, 1, 0), model.length)
    air = {'constant/transportProperties': format_transport_properties(viscosity / speed)}
    begin = SETTLING + round(BEGINNING * model.length, 4)
    end = SETTLING + lengths * model.length
    modelled = needs_eddy_model(model, viscosity, speed)
    # [s] At 1 m/s; twice as long for each coarser level of the hull
    longest = 0.03 * model.length * 2.0 ** (4 - fine.hull)
    eddies = {
        'constant/turbulenceProperties': (
            format_detached_eddies() if modelled else format_turbulence_properties(None)
        ),
        'system/fvSchemes': format_transient_fv_schemes(),
        'system/fvSolution': format_transient_fv_solution(),
    }
    steps = [
        ProgramStep('settle', ('simpleFoam',), {
            **air,
            'constant/turbulenceProperties': format_turbulence_properties('SpalartAllmaras'),
            'system/fvSchemes': format_steady_fv_schemes(EDDY_VISCOSITY),
            'system/fvSolution': format_fv_solution(carried=EDDY_VISCOSITY),
            'system/controlDict': format_control_dict('simpleFoam', 0, SETTLING, {}),
        }, SETTLING),
        ProgramStep('begin', ('pimpleFoam',), {
            **eddies,
            # The steady solver counted iterations: reset the time step for the transient one
            f'{SETTLING}/uniform/time': format_time_file(SETTLING, 0.05 * longest),
            'system/controlDict': format_control_dict(
                'pimpleFoam', SETTLING, begin, {}, longest, CAREFUL
            ),
        }, int(6.0 * (begin - SETTLING) / longest), str(SETTLING)),
        ProgramStep(f'{speed:g}', ('pimpleFoam',), {
            **eddies,
            'system/controlDict': format_control_dict(
                'pimpleFoam', begin, end, functions, longest, BOLD
            ),
        }, int(1.5 * lengths * model.length / longest), f'{begin:.8g}'),
    ]  # fmt: skip
    files = {**format_tunnel_fields(DETACHED, walls, (), viscosity / speed), **empty_files()}
    return FoamCase(f'{axis} {speed:g} m/s', files, steps, mesh, mesh.cells)
