"""
Build cases in a box of still air: running rotors, and a rotating vehicle.

A rotor is a momentum source in its disk, without swirl. The body is loaded by its thrust, and by
the forces of the moving air on the walls. Rotation is solved in a ball with a rotating reference
frame (MRF), at 1 rad/s with the viscosity divided by the intended rate.
"""

from collections.abc import Mapping
import math
from typing import Final

from lta_windtunnel.openfoam.case import FoamCase, ProgramStep
from lta_windtunnel.openfoam.dictionary import Entry, format_dictionary
from lta_windtunnel.openfoam.fields import format_still_air_fields, STEADY
from lta_windtunnel.openfoam.mesh import (
    BASE,
    build_mesh_case,
    format_block_mesh,
    format_snappy_mesh,
)
from lta_windtunnel.openfoam.numerics import (
    build_force_functions,
    build_momentum_functions,
    build_pressure_function,
    build_slice_function,
    format_control_dict,
    format_fv_solution,
    format_steady_fv_schemes,
)
from lta_windtunnel.tunnel import (
    empty_files,
    format_transport_properties,
    format_turbulence_properties,
)
from lta_windtunnel.tunnel_model import HULL, RotorDisk, TunnelModel
import numpy as np

RATES: Final = (0.3, 1.0, 3.0)  # rad/s
ROUNDS: Final = 200
MEETING: Final = 400  # where more than two jets may meet: BEAVIS's lift still grows at 200
NEXT: Final = 80
AXES: Final = {'roll': (1, 0, 0), 'pitch': (0, 1, 0), 'yaw': (0, 0, 1)}
BALL: Final = 'turning'
CELLS_ACROSS: Final = 6  # a rotor's disk
# Jets: radius and length in radii of the rotor, and how many levels coarser than the disk.
JETS: Final = ((1.34, 1.27, 0), (2.34, 12.8, 1), (5.1, 34.0, 2), (10.6, 76.6, 3))


def disk_refinement_level(model: TunnelModel, rotor: RotorDisk) -> int:
    """Return the level at which a rotor's disk has enough cells across."""
    return math.ceil(math.log2(BASE * model.length * CELLS_ACROSS / (2.0 * rotor.radius)) - 1e-9)


def build_still_air_mesh(model: TunnelModel, most: int = 3_000_000) -> FoamCase:
    """Return the mesh of the box, with cell zones for the rotors' disks and the rotating ball."""
    size = model.length
    regions: dict[str, tuple[Mapping[str, Entry], int]] = {}
    finest = 4
    for name, rotor in model.rotors.items():
        level = disk_refinement_level(model, rotor)
        finest = max(finest, level)
        for k, (wide, long, coarser) in enumerate(JETS):
            regions[f'{name}_{k}'] = (_jet_region(rotor, wide, long), max(level - coarser, 0))
    text = format_snappy_mesh(
        {name: 3 if name == HULL else min(finest, 5) for name in model.bodies},
        BASE * size,
        regions,
        # A point in the air that lies on no cell face
        [-2.613 * size, 2.137 * size, 2.071 * size],
        (0.12 * size, 3),
        6,
        1.3,
        most,
    )
    actions: list[Entry] = []
    for name, rotor in model.rotors.items():
        half = 0.5 * rotor.thickness * np.array(rotor.axis)
        ends = [(np.array(rotor.place) + sign * half).tolist() for sign in (-1.0, 1.0)]
        actions += _zone_actions(name, {
            'source': 'cylinderToCell', 'p1': ends[0], 'p2': ends[1], 'radius': rotor.radius,
        })  # fmt: skip
    actions += _zone_actions(BALL, {
        # Encloses the hull, which extends half a length from the centre
        'source': 'sphereToCell', 'centre': [0, 0, 0], 'radius': 1.2 * size
    })  # fmt: skip
    return build_mesh_case(
        'still mesh',
        model.bodies,
        format_block_mesh(
            np.full(3, -3.0 * size), np.full(3, 3.0 * size), BASE * size,
            {'far': ['x-', 'x+', 'y-', 'y+', 'z-', 'z+']},
        ),
        text,
        70_000,
        format_dictionary('topoSetDict', {'actions': actions}),
    )  # fmt: skip


def _jet_region(rotor: RotorDisk, wide: float, long: float) -> dict[str, Entry]:
    """Return a cylinder around a rotor and its jet, to both sides as rotors may be reversed."""
    reach = long * rotor.radius * np.array(rotor.axis)
    ends = (np.array(rotor.place) - reach, np.array(rotor.place) + reach)
    return {
        'type': 'searchableCylinder',
        'point1': ends[0].tolist(),
        'point2': ends[1].tolist(),
        'radius': wide * rotor.radius,
    }


def _zone_actions(name: str, source: Mapping[str, Entry]) -> list[Entry]:
    """Return the topoSet actions that create a cell zone."""
    return [
        {'name': f'{name}_set', 'type': 'cellSet', 'action': 'new', **source},
        {'name': name, 'type': 'cellZoneSet', 'action': 'new', 'source': 'setToCellZone',
         'set': f'{name}_set'},
    ]  # fmt: skip


def _build_function_objects(model: TunnelModel, normal: tuple[int, int, int]) -> dict[str, Entry]:
    return {
        **build_force_functions({name: name for name in model.bodies} | {'outer': 'far'}),
        **build_momentum_functions(('far',)),
        **build_slice_function(normal, model.length),
    }


def build_blowing_case(
    model: TunnelModel, pattern: str, shares: Mapping[str, float], air: tuple[float, float]
) -> FoamCase:
    """
    Return the case of running rotors.

    `pattern`: name of the pattern. `shares`: thrust of the running rotors, relative to full
    thrust; negative is reversed [1]. `air`: density [kg/m3] and kinematic viscosity [m2/s].
    """
    density, viscosity = air
    sources: dict[str, Entry] = {}
    for name, share in shares.items():
        rotor = model.rotors[name]
        # The air is pushed opposite to the thrust; kinematic units (divided by the density)
        push = -share * rotor.thrust / density * np.array(rotor.axis)
        sources[name] = {
            'type': 'vectorSemiImplicitSource', 'active': True,
            'vectorSemiImplicitSourceCoeffs': {
                'selectionMode': 'cellZone', 'cellZone': name, 'volumeMode': 'absolute',
                'injectionRateSuSp': {'U': [push.tolist(), 0]},
            },
        }  # fmt: skip
    # The slice holds the first rotor's axis and the vertical.
    first = model.rotors[next(iter(shares))]
    along_y = abs(first.axis[1]) > abs(first.axis[0]) or (
        abs(first.axis[2]) > 0.7 and abs(first.place[1]) > abs(first.place[0])
    )
    mesh = build_still_air_mesh(model)
    files = {
        **format_still_air_fields(STEADY, tuple(model.bodies)),
        **empty_files(),
        'constant/fvOptions': format_dictionary('fvOptions', sources),
        'constant/transportProperties': format_transport_properties(viscosity),
        'constant/turbulenceProperties': format_turbulence_properties('kOmegaSST'),
        'system/fvSchemes': format_steady_fv_schemes(),
        'system/fvSolution': format_fv_solution(0.7, 0.6),
    }
    functions = {
        **_build_function_objects(model, (1, 0, 0) if along_y else (0, 1, 0)),
        **build_pressure_function(model.bodies),
    }  # fmt: skip
    rounds = MEETING if len(shares) > 2 else ROUNDS
    last = {'system/controlDict': format_control_dict('simpleFoam', 0, rounds, functions)}
    return FoamCase(
        pattern, files, [ProgramStep('on', ('simpleFoam',), last, rounds)], mesh, mesh.cells
    )


def build_spinning_case(model: TunnelModel, about: str, viscosity: float) -> FoamCase:
    """
    Return the case of a vehicle that rotates about its hull centre, at several rates.

    `about` is 'roll', 'pitch' or 'yaw'; the viscosity is kinematic. [m2/s]
    """
    mesh = build_still_air_mesh(model)
    steps, begin = [], 0
    for rate in RATES:
        end = begin + (NEXT if begin else ROUNDS)
        files = {
            'system/controlDict': format_control_dict(
                'simpleFoam', begin, end, _build_function_objects(model, (0, 1, 0))
            ),
            # Reynolds similarity: 1 rad/s at viscosity / rate equals `rate` at the real viscosity
            'constant/transportProperties': format_transport_properties(viscosity / rate),
        }  # fmt: skip
        steps.append(ProgramStep(f'{rate:g}', ('simpleFoam',), files, end - begin, str(begin)))
        begin = end
    turning: Mapping[str, Entry] = {
        'cellZone': BALL, 'active': True, 'nonRotatingPatches': [], 'origin': [0, 0, 0],
        'axis': list(AXES[about]), 'omega': 1,
    }  # fmt: skip
    files = {
        **format_still_air_fields(STEADY, tuple(model.bodies)),
        **empty_files(),
        'constant/MRFProperties': format_dictionary('MRFProperties', {'turning': turning}),
        'constant/turbulenceProperties': format_turbulence_properties('kOmegaSST'),
        'system/fvSchemes': format_steady_fv_schemes(),
        'system/fvSolution': format_fv_solution(0.7, 0.6),
    }
    return FoamCase(about, files, steps, mesh, mesh.cells)
