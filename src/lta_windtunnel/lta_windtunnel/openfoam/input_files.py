# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write OpenFOAM's input files: the settings of config/openfoam, and the fields of the folder 0.

The settings are proven on round bodies. The inflow of a transient has no eddies, so the boundary
layer on the hull is laminar until it separates; where that predicts the drag crisis too early
(`tunnel.MAX_LAMINAR_REYNOLDS`), detached eddies are modelled.
"""

from collections.abc import Iterable, Mapping, Sequence
import math
from string import Template
from typing import Final, final

from lta_config.files import share_folder

Entry = str | bool | int | float | Sequence['Entry'] | Mapping[str, 'Entry']

HEADER: Final = """FoamFile
{{
    version     2.0;
    format      ascii;
    class       {kind};
    object      {name};
}}
"""
EVERY_STEP: Final[Mapping[str, Entry]] = {
    'log': False,
    'writeControl': 'timeStep',
    'writeInterval': 1,
}
AT_END: Final[Mapping[str, Entry]] = {
    'type': 'surfaces', 'libs': ['sampling'], 'writeControl': 'writeTime', 'surfaceFormat': 'raw',
}  # fmt: skip


@final
class FoamTemplate(Template):
    """A file of OpenFOAM with names such as @model, as `$model` is a macro there."""

    delimiter = '@'


def fill_settings(name: str, **values: Entry) -> str:
    """Return a file of config/openfoam with its names replaced by values."""
    text = (share_folder() / 'openfoam' / name).read_text(encoding='utf-8')
    words = {}
    for key, value in values.items():
        lines = _format_block(value, '') if isinstance(value, Mapping) else [_format_entry(value)]
        words[key] = '\n'.join(lines)
    return FoamTemplate(text).substitute(words)


def _format_entry(entry: Entry) -> str:
    """Format an entry on one line."""
    # Before int, because bool is a subclass of int
    if isinstance(entry, bool):
        return 'true' if entry else 'false'
    if isinstance(entry, str):
        return entry
    if isinstance(entry, int | float):
        return f'{entry:.10g}'
    if isinstance(entry, Mapping):
        return '{ ' + ' '.join(_format_entries(entry, '')) + ' }'
    return f'({" ".join(_format_entry(each) for each in entry)})'


def _format_block(entries: Mapping[str, Entry], indent: str) -> list[str]:
    return [f'{indent}{{', *_format_entries(entries, indent + '    '), f'{indent}}}']


def _format_entries(entries: Mapping[str, Entry], indent: str) -> list[str]:
    text = []
    for key, entry in entries.items():
        if isinstance(entry, Mapping):
            text += [f'{indent}{key}', *_format_block(entry, indent)]
        else:
            text.append(f'{indent}{key} {_format_entry(entry)};')
    return text


def format_files(
    contents: Mapping[str, Mapping[str, Entry]], kind: str = 'dictionary'
) -> dict[str, str]:
    """
    Format files from their entries, by path; strings are written unquoted.

    `kind` is the class of the objects: 'dictionary', 'volScalarField', ...
    """
    files = {}
    for path, entries in contents.items():
        head = HEADER.format(kind=kind, name=path.rpartition('/')[2])
        files[path] = '\n'.join([head, *_format_entries(entries, ''), ''])
    return files


def format_air(viscosity: float) -> dict[str, str]:
    """Return the file with the kinematic viscosity [m2/s]."""
    entries: dict[str, Entry] = {'transportModel': 'Newtonian', 'nu': viscosity}
    return format_files({'constant/transportProperties': entries})


def format_steady_settings(
    model: str, relaxation: tuple[float, float] = (0.8, 0.7)
) -> dict[str, str]:
    """
    Return turbulence model, schemes and solvers of simpleFoam.

    `relaxation` holds the factors of the velocity and of the turbulence. [1]
    """
    velocity, turbulence = relaxation
    return {
        'constant/turbulenceProperties': fill_settings('steady.turbulenceProperties', model=model),
        'system/fvSchemes': fill_settings('steady.fvSchemes'),
        'system/fvSolution': fill_settings(
            'steady.fvSolution', velocity=velocity, turbulence=turbulence
        ),
    }


def format_transient_settings(modelled: bool) -> dict[str, str]:
    """
    Return eddy model, schemes and solvers of pimpleFoam.

    `modelled`: whether DDES models the eddies smaller than the cells.
    """
    model = 'eddies' if modelled else 'laminar'
    return {
        'constant/turbulenceProperties': fill_settings(f'{model}.turbulenceProperties'),
        'system/fvSchemes': fill_settings('transient.fvSchemes'),
        'system/fvSolution': fill_settings('transient.fvSolution'),
    }


def format_control(
    program: str, begin: float, end: float, functions: Mapping[str, Entry],
    steps: tuple[float, float] | None = None,
) -> dict[str, str]:  # fmt: skip
    """
    Return the file that controls a solver from `begin` to `end`, with its function objects.

    Both are iterations of a steady solver, or seconds of a transient one, whose `steps` are the
    largest time step [s] and Courant number [1].
    """
    entries: dict[str, Entry] = {
        'application': program,
        'startFrom': 'startTime', 'startTime': begin, 'stopAt': 'endTime', 'endTime': end,
        # A steady solver counts iterations as time steps of 1
        'deltaT': steps[0] / 20.0 if steps else 1,
        'writeControl': 'adjustableRunTime' if steps else 'runTime',
        # Write fields at the end only
        'writeInterval': end - begin,
        'purgeWrite': 0, 'writeFormat': 'binary', 'writePrecision': 8, 'timePrecision': 8,
        'runTimeModifiable': False,
    }  # fmt: skip
    if steps:
        entries |= {'adjustTimeStep': True, 'maxCo': steps[1], 'maxDeltaT': steps[0]}
    return format_files({'system/controlDict': {**entries, 'functions': functions}})


def format_time(now: int, step: float) -> dict[str, str]:
    """
    Return the file with a solver's time, so that it does not inherit another solver's step of 1.

    `now` counts iterations so far, which become seconds; `step` is the new time step. [s]
    """
    return format_files({
        f'{now}/uniform/time': {
            'value': now, 'name': f'"{now}"', 'index': now, 'deltaT': step, 'deltaT0': step,
        }
    })  # fmt: skip


def build_flow_records(
    walls: Iterable[str], length: float, outer: Sequence[str] = (),
    normal: tuple[int, int, int] = (0, 1, 0),
) -> dict[str, Entry]:  # fmt: skip
    """
    Return the function objects that record a flow, at 1 kg/m3 and about the origin.

    At each iteration the force on each wall and on all `outer` patches, and the momentum flux
    through each of these; at the end the velocity in the central plane with this normal. `length`
    is that of the hull. [m]
    """
    patches = {name: name for name in walls}
    if outer:
        patches['outer'] = outer[0] if len(outer) == 1 else f'"({"|".join(outer)})"'
    # [m] Slightly off the plane, because a plane of symmetry contains no cells
    aside = [0.002 * length * each for each in normal]
    plane: dict[str, Entry] = {
        'type': 'cuttingPlane', 'planeType': 'pointAndNormal',
        'pointAndNormalDict': {'point': aside, 'normal': list(normal)}, 'interpolate': True,
    }  # fmt: skip
    return {
        **{
            f'forces_{name}': {
                'type': 'forces', 'libs': ['forces'], 'patches': [patch], 'rho': 'rhoInf',
                'rhoInf': 1, 'CofR': [0, 0, 0], **EVERY_STEP,
            }
            for name, patch in patches.items()
        },
        **{
            f'momentum_{patch}': {
                'type': 'surfaceFieldValue', 'libs': ['fieldFunctionObjects'],
                'regionType': 'patch', 'name': patch, 'operation': 'weightedSum',
                'weightField': 'phi', 'fields': ['U'], 'writeFields': False, **EVERY_STEP,
            }
            for patch in outer
        },
        'slice': {
            **AT_END, 'interpolationScheme': 'cellPoint', 'fields': ['U'],
            'surfaces': {'plane': plane},
        },
    }  # fmt: skip


def build_pressure_record(walls: Iterable[str]) -> dict[str, Entry]:
    """Return the function object that writes the pressure on the faces of walls at the end."""
    return {
        'pressure': {
            **AT_END, 'interpolationScheme': 'cell', 'fields': ['p'],
            'surfaces': {name: {'type': 'patch', 'patches': [name]} for name in walls},
        },
    }  # fmt: skip


INTENSITY, EDDY = 0.005, 0.05  # turbulence of the oncoming air, and the size of its eddies [m]
# Isotropic turbulence; omega from k and the eddy size with C_mu = 0.09
K: Final = 1.5 * INTENSITY**2  # at 1 m/s [m2/s2]
OMEGA: Final = math.sqrt(K) / (0.09**0.25 * EDDY)  # [1/s]
# Langtry and Menter 2009, for an intensity of 0.5 %.
THETA: Final = 1173.51 - 589.428 * 0.5 + 0.2196 / 0.25
# Where eddies are resolved, the inflow has none: the boundary layer stays laminar until it
# separates, as on real hulls below the drag crisis ("tripless", Travin et al. 2000). The initial
# air has an eddy viscosity of a few times the viscosity, which seeds the wake.
CLEAN_INFLOW: Final = 'uniform 1e-12'
SEED_VISCOSITIES: Final = 5.0

ZERO_GRADIENT: Final = {'type': 'zeroGradient'}
INITIAL: Final = {'value': '$internalField'}
CALCULATED: Final = {'type': 'calculated', **INITIAL}
# Of each field: exponents of kg, m, s, K, mol, A, cd; value inside; condition at walls
FLOW_FIELDS: Final[Mapping[str, tuple[str, str, Mapping[str, Entry]]]] = {
    'U': ('0 1 -1 0 0 0 0', 'uniform (1 0 0)', {'type': 'noSlip'}),
    'p': ('0 2 -2 0 0 0 0', 'uniform 0', ZERO_GRADIENT),
    'k': ('0 2 -2 0 0 0 0', f'uniform {K:.8g}', {'type': 'kLowReWallFunction', **INITIAL}),
    'omega': (
        '0 0 -1 0 0 0 0', f'uniform {OMEGA:.8g}',
        {'type': 'omegaWallFunction', 'blended': True, **INITIAL},
    ),
    'nut': ('0 2 -1 0 0 0 0', 'uniform 0', {'type': 'nutUSpaldingWallFunction', **INITIAL}),
    'ReThetat': ('0 0 0 0 0 0 0', f'uniform {THETA:.6g}', ZERO_GRADIENT),
    'gammaInt': ('0 0 0 0 0 0 0', 'uniform 1', ZERO_GRADIENT),
    'nuTilda': ('0 2 -1 0 0 0 0', '', {'type': 'fixedValue', 'value': 'uniform 0'}),
}  # fmt: skip
STEADY_FIELDS: Final = ('U', 'p', 'k', 'omega', 'nut')
TRANSITION: Final = (*STEADY_FIELDS, 'ReThetat', 'gammaInt')
DETACHED: Final = ('U', 'p', 'nut', 'nuTilda')


def _open_boundary(name: str) -> Mapping[str, Entry]:
    """Return a boundary with free outflow, and far-field values for inflow."""
    return {'type': 'inletOutlet', 'inletValue': _inflow_value(name), **INITIAL}


def _inflow_value(name: str) -> str:
    return CLEAN_INFLOW if name == 'nuTilda' else '$internalField'


def _format_field(
    name: str, inside: str, outer: Mapping[str, Mapping[str, Entry]], walls: Sequence[str]
) -> dict[str, str]:
    dimensions, _, wall = FLOW_FIELDS[name]
    kind = 'volVectorField' if name == 'U' else 'volScalarField'
    content: dict[str, Entry] = {
        'dimensions': f'[{dimensions}]', 'internalField': inside,
        'boundaryField': {**outer, **dict.fromkeys(walls, wall)},
    }  # fmt: skip
    return format_files({f'0/{name}': content}, kind)


def format_tunnel_fields(
    names: Sequence[str], walls: Sequence[str], planes: Sequence[str], viscosity: float = 0.0
) -> dict[str, str]:
    """
    Return the fields of a wind tunnel with air along x at 1 m/s.

    `names`: fields that the solver needs. `walls`, `planes`: patches of bodies and of symmetry
    planes. `viscosity`: kinematic, from which the initial `nuTilda` is set. [m2/s]
    """
    files: dict[str, str] = {}
    for name in names:
        inlet: Mapping[str, Entry] = {'type': 'fixedValue', 'value': _inflow_value(name)}
        outlet = _open_boundary(name)
        # Pressure is fixed at the outlet only; elsewhere the velocity is
        if name == 'p':
            inlet, outlet = ZERO_GRADIENT, {'type': 'fixedValue', 'value': 'uniform 0'}
        elif name == 'nut':
            inlet = outlet = CALCULATED
        outer = {
            'inlet': inlet,
            'outlet': outlet,
            # Frictionless, so that the tunnel's walls have no boundary layer
            'sides': {'type': 'slip'},
            **{plane: {'type': 'symmetryPlane'} for plane in planes},
        }
        files |= _format_field(
            name,
            FLOW_FIELDS[name][1] or f'uniform {SEED_VISCOSITIES * viscosity:.6g}',
            outer,
            walls,
        )
    return files


def format_still_air_fields(walls: Sequence[str]) -> dict[str, str]:
    """Return the fields of an open box of still air around bodies with these patches."""
    far: dict[str, Mapping[str, Entry]] = {
        'U': {'type': 'pressureInletOutletVelocity', 'value': 'uniform (0 0 0)'},
        # Entrained air enters from rest: its total pressure is the ambient one
        'p': {'type': 'totalPressure', 'p0': 'uniform 0', 'value': 'uniform 0'},
        'nut': CALCULATED,
    }
    files: dict[str, str] = {}
    for name in STEADY_FIELDS:
        inside = 'uniform (0 0 0)' if name == 'U' else FLOW_FIELDS[name][1]
        files |= _format_field(name, inside, {'far': far.get(name, _open_boundary(name))}, walls)
    return files
