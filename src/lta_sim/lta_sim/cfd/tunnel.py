"""
The wind tunnel proper: the air comes along the tunnel's x, the vehicle is turned into it.

The air always comes with 1 m/s, and the viscosity is divided by the speed that is meant (Reynolds'
similarity): so one mesh serves all speeds, and each starts from the flow of the one before.
Forces are then those at 1 m/s and 1 kg/m3, and grow by rho U^2.

Where the vehicle mirrors onto itself, half or a quarter of the air is solved. That is not thrift
alone: whole steady wakes do not settle.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_sim.cfd.model import HULL, Model
from lta_sim.cfd.openfoam.case import Case, Step
from lta_sim.cfd.openfoam.dictionary import dictionary, Entry
from lta_sim.cfd.openfoam.fields import DETACHED, TRANSITION, tunnel_fields
from lta_sim.cfd.openfoam.mesh import BASE, block, mesh_case, snappy
from lta_sim.cfd.openfoam.numerics import (
    clock,
    control,
    EDDY_VISCOSITY,
    forces_on,
    momentum_through,
    slice_through,
    solution,
    steady_schemes,
    transient_schemes,
    transient_solution,
)
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


@final
@dataclass(frozen=True, slots=True)
class Fineness:
    """
    How finely a tunnel is meshed.

    Parameters
    ----------
    hull, parts : int
        Levels on the hull and on other bodies.
    trail : int
        Level behind the hull, to 1.5 lengths; one less on to 3.
    shell : float
        How far around the hull the air is refined to level 3. [lengths]
    layers, expansion : int, float
        Of prisms on the hull.
    cells : int
        Expected of the whole domain.
    most : int
        Cells that there may be.

    """

    hull: int = 4
    parts: int = 5
    trail: int = 2
    shell: float = 0.12
    layers: int = 6
    expansion: float = 1.3
    cells: int = 185_000
    most: int = 3_000_000


PREVIEW: Final = Fineness()
COARSE: Final = Fineness(hull=3, parts=4, cells=100_000)
REFERENCE: Final = Fineness(shell=0.15, layers=5, expansion=1.4, cells=189_000)
ROUGH: Final = Fineness(hull=3, parts=4, shell=0.15, layers=5, expansion=1.4, cells=100_000)
FAST: Final = Fineness(trail=3, shell=0.15, layers=8, expansion=1.4, cells=346_000)
# Reynolds number of the hull up to which a transient needs no model. Beyond, a sphere's drag fell
# as that of real ones does at twice the speed; a model of detached eddies keeps the layer along it
# laminar, and gives 0.53 at half that speed, over all that was measured.
MODELLED: Final = 1e5


def is_modelled(model: Model, viscosity: float, speed: float) -> bool:
    """Tell whether eddies are modelled in a transient: viscosity in m2/s, speed in m/s."""
    return speed * model.length / viscosity > MODELLED


def fineness(model: Model, viscosity: float, speed: float) -> Fineness:
    """Return how a transient is meshed: viscosity in m2/s, speed in m/s."""
    return FAST if is_modelled(model, viscosity, speed) else REFERENCE


def planes_of(model: Model, axis: str) -> tuple[bool, bool]:
    """Tell whether the tunnel's planes y = 0 and z = 0 are planes of symmetry."""
    turn = TURNS[axis]
    found = [bool(model.mirrored(int(np.argmax(np.abs(turn[k]))))) for k in (1, 2)]
    return found[0], found[1]


def tunnel_mesh(model: Model, axis: str, fine: Fineness, planes: tuple[bool, bool]) -> Case:
    """
    Return the mesh of a tunnel.

    Parameters
    ----------
    model : Model
        What stands in it.
    axis : str
        How the vehicle moves: 'surge', 'sway' or 'heave'.
    fine : Fineness
        How fine.
    planes : (bool, bool)
        Whether only y > 0 and only z > 0 are solved.

    """
    size = model.length
    turn = np.eye(4)
    turn[:3, :3] = TURNS[axis]
    surfaces = {name: mesh.copy() for name, mesh in model.bodies.items()}
    for mesh in surfaces.values():
        mesh.apply_transform(turn)
    low = size * np.array([-4.0, 0.0 if planes[0] else -4.0, 0.0 if planes[1] else -4.0])
    high = size * np.array([8.0, 4.0, 4.0])
    halves = [f'symmetry{name}' for name, is_one in zip('YZ', planes, strict=True) if is_one]
    sides = [face for face in ('y-', 'y+', 'z-', 'z+') if f'symmetry{face[0].upper()}' not in
             halves or face[1] == '+']  # fmt: skip
    patches = {'inlet': ['x-'], 'outlet': ['x+'], 'sides': sides}
    patches |= {name: [f'{name[-1].lower()}-'] for name in halves}
    wide, near = 1.0 * size, 0.75 * size
    regions = {
        'wake': (_box((-wide, -wide, -wide), (3.0 * size, wide, wide)), fine.trail - 1),
        'near': (_box((-near, -near, -near), (1.5 * size, near, near)), 2),
    }
    if fine.trail > PREVIEW.trail:
        regions['trail'] = (_box((0.0, -near, -near), (1.5 * size, near, near)), fine.trail)
    text = snappy(
        {name: fine.hull if name == HULL else fine.parts for name in surfaces},
        BASE * size,
        regions,
        [-2.913 * size, 1.137 * size, 1.071 * size],
        (fine.shell * size, 3),
        fine.layers,
        fine.expansion,
        fine.most,
    )
    share = 2 ** -sum(planes)
    return mesh_case(
        f'{axis} mesh',
        surfaces,
        block(low, high, BASE * size, patches),
        text,
        int(fine.cells * share),
    )


def _box(low: Sequence[float], high: Sequence[float]) -> Mapping[str, Entry]:
    return {'type': 'searchableBox', 'min': list(low), 'max': list(high)}


def transport(viscosity: float) -> str:
    """Return transportProperties. [m2/s]."""
    return dictionary('transportProperties', {'transportModel': 'Newtonian', 'nu': viscosity})


def turbulence(model: str | None) -> str:
    """Return turbulenceProperties of a RANS model, or of none."""
    if model is None:
        return dictionary('turbulenceProperties', {'simulationType': 'laminar'})
    return dictionary('turbulenceProperties', {
        'simulationType': 'RAS',
        'RAS': {'RASModel': model, 'turbulence': True, 'printCoeffs': False},
    })  # fmt: skip


def detached() -> str:
    """Return turbulenceProperties of DDES, which solves eddies as large as its cells."""
    return dictionary('turbulenceProperties', {
        'simulationType': 'LES',
        'LES': {
            'LESModel': 'SpalartAllmarasDDES', 'turbulence': True, 'printCoeffs': False,
            'delta': 'maxDeltaxyz', 'maxDeltaxyzCoeffs': {},
        },
    })  # fmt: skip


def empty() -> dict[str, str]:
    """Return the files that the solvers want, though nothing stands in them."""
    return {
        f'constant/{name}': dictionary(name, {}) for name in ('fvOptions', 'MRFProperties')
    }  # the solvers look for both


def steady_wind(
    model: Model, axis: str, viscosity: float, fine: Fineness, speeds: Sequence[float] = SPEEDS
) -> Case:
    """
    Return the steady flow around a vehicle at several speeds.

    Parameters
    ----------
    model, axis, fine
        As `tunnel_mesh`.
    viscosity : float
        Kinematic, of the air. [m2/s]
    speeds : sequence of float
        In the order in which they are solved. [m/s]

    """
    planes = planes_of(model, axis)
    mesh = tunnel_mesh(model, axis, fine, planes)
    walls = tuple(model.bodies)
    halves = [f'symmetry{name}' for name, is_one in zip('YZ', planes, strict=True) if is_one]
    functions = {
        **forces_on({name: name for name in walls} | {'outer': '"(inlet|outlet|sides)"'}),
        **momentum_through(OUTER),
        **slice_through((0, 1, 0), model.length),
    }
    steps, begin = [], 0
    for speed in speeds:
        end = begin + (NEXT if begin else FIRST)
        files = {
            'system/controlDict': control('simpleFoam', begin, end, functions),
            'constant/transportProperties': transport(viscosity / speed),
        }
        steps.append(Step(f'{speed:g}', ('simpleFoam',), files, end - begin, str(begin)))
        begin = end
    files = {
        **tunnel_fields(TRANSITION, walls, halves),
        **empty(),
        'constant/turbulenceProperties': turbulence('kOmegaSSTLM'),
        'system/fvSchemes': steady_schemes(),
        'system/fvSolution': solution(),
    }
    return Case(axis, files, steps, mesh, mesh.cells)


def transient_wind(
    model: Model, axis: str, viscosity: float, fine: Fineness, speed: float, lengths: float
) -> Case:
    """
    Return the transient flow around a vehicle at one speed, in the whole tunnel.

    Parameters
    ----------
    model, axis, viscosity, fine
        As `steady_wind`.
    speed : float
        That is meant. [m/s]
    lengths : float
        Of the hull, that the air goes past it. [1]

    """
    mesh = tunnel_mesh(model, axis, fine, (False, False))
    walls = tuple(model.bodies)
    functions = forces_on({name: name for name in walls})
    functions |= slice_through((0, 1, 0), model.length)
    air = {'constant/transportProperties': transport(viscosity / speed)}
    begin = SETTLING + round(BEGINNING * model.length, 4)
    end = SETTLING + lengths * model.length
    modelled = is_modelled(model, viscosity, speed)
    longest = 0.03 * model.length * 2.0 ** (4 - fine.hull)
    eddies = {
        'constant/turbulenceProperties': (detached() if modelled else turbulence(None)),
        'system/fvSchemes': transient_schemes(),
        'system/fvSolution': transient_solution(),
    }
    steps = [
        Step('settle', ('simpleFoam',), {
            **air,
            'constant/turbulenceProperties': turbulence('SpalartAllmaras'),
            'system/fvSchemes': steady_schemes(EDDY_VISCOSITY),
            'system/fvSolution': solution(carried=EDDY_VISCOSITY),
            'system/controlDict': control('simpleFoam', 0, SETTLING, {}),
        }, SETTLING),
        Step('begin', ('pimpleFoam',), {
            **eddies,
            f'{SETTLING}/uniform/time': clock(SETTLING, 0.05 * longest),
            'system/controlDict': control(
                'pimpleFoam', SETTLING, begin, {}, longest, CAREFUL
            ),
        }, int(6.0 * (begin - SETTLING) / longest), str(SETTLING)),
        Step(f'{speed:g}', ('pimpleFoam',), {
            **eddies,
            'system/controlDict': control(
                'pimpleFoam', begin, end, functions, longest, BOLD
            ),
        }, int(1.5 * lengths * model.length / longest), f'{begin:.8g}'),
    ]  # fmt: skip
    files = {**tunnel_fields(DETACHED, walls, (), viscosity / speed), **empty()}
    return Case(f'{axis} {speed:g} m/s', files, steps, mesh, mesh.cells)
