# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
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
from lta_windtunnel.openfoam.input_files import (
    build_flow_records,
    build_pressure_record,
    Entry,
    format_air,
    format_control,
    format_files,
    format_steady_settings,
    format_still_air_fields,
)
from lta_windtunnel.openfoam.mesh import BASE_CUBE, build_mesh_case, MeshFineness, Region
from lta_windtunnel.tunnel import build_steady_steps, format_absent
from lta_windtunnel.tunnel_model import RotorDisk, TunnelModel
import numpy as np

TURN_RATES: Final = (0.3, 1.0, 3.0)  # rad/s
STILL_ITERATIONS: Final = 200
# Where more than two jets may meet: BEAVIS's lift still grows at 200
COLLIDING_ITERATIONS: Final = 400
NEXT_RATE_ITERATIONS: Final = 80
SPIN_AXES: Final = {'roll': (1, 0, 0), 'pitch': (0, 1, 0), 'yaw': (0, 0, 1)}
ROTATING_ZONE: Final = 'turning'
CELLS_ACROSS: Final = 6  # a rotor's disk
# Jets: radius and length in radii of the rotor, and how many levels coarser than the disk.
JETS: Final = ((1.34, 1.27, 0), (2.34, 12.8, 1), (5.1, 34.0, 2), (10.6, 76.6, 3))


def disk_refinement_level(model: TunnelModel, rotor: RotorDisk) -> int:
    """Return the level at which a rotor's disk has enough cells across."""
    return math.ceil(
        math.log2(BASE_CUBE * model.length * CELLS_ACROSS / (2.0 * rotor.radius)) - 1e-9
    )


def build_still_air_mesh(model: TunnelModel) -> FoamCase:
    """Return the mesh of the box, with cell zones for the rotors' disks and the rotating ball."""
    regions: dict[str, Region] = {}
    zones: list[Entry] = []
    finest = 4
    for name, rotor in model.rotors.items():
        level = disk_refinement_level(model, rotor)
        finest = max(finest, level)
        for k, (wide, long, coarser) in enumerate(JETS):
            # To both sides, as rotors may be reversed
            ends = _cylinder_ends(rotor, long * rotor.radius)
            shape: dict[str, Entry] = {
                'type': 'searchableCylinder', 'point1': ends[0], 'point2': ends[1],
                'radius': wide * rotor.radius,
            }  # fmt: skip
            regions[f'{name}_{k}'] = shape, max(level - coarser, 0)
        ends = _cylinder_ends(rotor, 0.5 * rotor.thickness)
        zones += _zone_actions(name, {
            'source': 'cylinderToCell', 'p1': ends[0], 'p2': ends[1], 'radius': rotor.radius,
        })  # fmt: skip
    zones += _zone_actions(ROTATING_ZONE, {
        # Encloses the hull, which extends half a length from the centre
        'source': 'sphereToCell', 'centre': [0, 0, 0], 'radius': 1.2 * model.length
    })  # fmt: skip
    return build_mesh_case(
        'still mesh', model.bodies, model.length,
        MeshFineness(hull=3, parts=min(finest, 5), cells=70_000),
        (np.full(3, -3.0), np.full(3, 3.0)), {'far': ['x-', 'x+', 'y-', 'y+', 'z-', 'z+']},
        regions, [-2.613, 2.137, 2.071], zones,
    )  # fmt: skip


def _cylinder_ends(rotor: RotorDisk, half: float) -> list[list[float]]:
    """Return the ends of a cylinder about a rotor's axis, from its half length [m]."""
    reach = half * np.array(rotor.axis)
    return [(np.array(rotor.place) + sign * reach).tolist() for sign in (-1.0, 1.0)]


def _zone_actions(name: str, source: Mapping[str, Entry]) -> list[Entry]:
    """Return the topoSet actions that create a cell zone."""
    return [
        {'name': f'{name}_set', 'type': 'cellSet', 'action': 'new', **source},
        {'name': name, 'type': 'cellZoneSet', 'action': 'new', 'source': 'setToCellZone',
         'set': f'{name}_set'},
    ]  # fmt: skip


def _format_common_files(model: TunnelModel) -> dict[str, str]:
    # Rotors and rotation converge with more relaxation than a wind
    return {
        **format_still_air_fields(tuple(model.bodies)),
        **format_steady_settings('kOmegaSST', (0.7, 0.6)),
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
        **_format_common_files(model),
        **format_absent('MRFProperties'),
        **format_files({'constant/fvOptions': sources}),
        **format_air(viscosity),
    }
    normal = (1, 0, 0) if along_y else (0, 1, 0)
    functions = {
        **build_flow_records(model.bodies, model.length, ('far',), normal),
        **build_pressure_record(model.bodies),
    }
    rounds = COLLIDING_ITERATIONS if len(shares) > 2 else STILL_ITERATIONS
    last = format_control('simpleFoam', 0, rounds, functions)
    return FoamCase(
        pattern, files, [ProgramStep('on', ('simpleFoam',), last, rounds)], mesh, mesh.cells
    )


def build_spinning_case(model: TunnelModel, about: str, viscosity: float) -> FoamCase:
    """
    Return the case of a vehicle that rotates about its hull centre, at several rates.

    `about` is 'roll', 'pitch' or 'yaw'; the viscosity is kinematic. [m2/s]
    """
    mesh = build_still_air_mesh(model)
    turning: Mapping[str, Entry] = {
        'cellZone': ROTATING_ZONE, 'active': True, 'nonRotatingPatches': [], 'origin': [0, 0, 0],
        'axis': list(SPIN_AXES[about]), 'omega': 1,
    }  # fmt: skip
    files = {
        **_format_common_files(model),
        **format_absent('fvOptions'),
        **format_files({'constant/MRFProperties': {'turning': turning}}),
    }
    functions = build_flow_records(model.bodies, model.length, ('far',))
    steps = build_steady_steps(
        TURN_RATES, viscosity, functions, (STILL_ITERATIONS, NEXT_RATE_ITERATIONS)
    )
    return FoamCase(about, files, steps, mesh, mesh.cells)
