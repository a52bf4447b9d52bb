"""
Write schemes, solvers and control files, with settings proven on round bodies.

Steady: SIMPLEC with a bounded second-order scheme. Transient: implicit large-eddy simulation, with
only the dissipation of the LUST scheme; where that predicts the drag crisis too early
(`tunnel.MODELLED`), detached eddies (Spalart's DDES). The inflow has no eddies, so the boundary
layer on the hull is laminar until it separates.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from lta_windtunnel.openfoam.dictionary import Entry, format_dictionary

TURBULENT: Final = ('k', 'omega', 'ReThetat', 'gammaInt')
EDDY_VISCOSITY: Final = ('nuTilda',)
LIMITED: Final = ('k', 'omega', 'nuTilda')  # gradients

_COMMON: Final[Mapping[str, Entry]] = {
    'interpolationSchemes': {'default': 'linear'},
    # Limits the non-orthogonal correction, for stability on distorted cells
    'laplacianSchemes': {'default': 'Gauss linear limited corrected 0.5'},
    'snGradSchemes': {'default': 'limited corrected 0.5'},
    'wallDist': {'method': 'meshWave'},
}


def format_steady_fv_schemes(carried: Sequence[str] = TURBULENT) -> str:
    """Return fvSchemes of simpleFoam, for a turbulence model with these transported fields."""
    limited: Entry = 'cellLimited Gauss linear 1'
    return format_dictionary('fvSchemes', {
        'ddtSchemes': {'default': 'steadyState'},
        'gradSchemes': {
            'default': 'Gauss linear', 'grad(U)': limited,
            **{f'grad({each})': limited for each in carried if each in LIMITED},
        },
        'divSchemes': {
            'default': 'none',
            # Second order for the velocity; turbulence first order, which stays positive
            'div(phi,U)': 'bounded Gauss linearUpwindV grad(U)',
            **{f'div(phi,{each})': 'bounded Gauss upwind' for each in carried},
            'div((nuEff*dev2(T(grad(U)))))': 'Gauss linear',
        },
        **_COMMON,
    })  # fmt: skip


def format_transient_fv_schemes() -> str:
    """Return fvSchemes of pimpleFoam."""
    return format_dictionary('fvSchemes', {
        'ddtSchemes': {'default': 'backward'},
        'gradSchemes': {'default': 'Gauss linear'},
        'divSchemes': {
            'default': 'none',
            **{f'div(phi,{each})': 'Gauss limitedLinear 1' for each in EDDY_VISCOSITY},
            'div(phi,U)': 'Gauss LUST grad(U)',
            'div((nuEff*dev2(T(grad(U)))))': 'Gauss linear',
        },
        **_COMMON,
    })  # fmt: skip


def format_fv_solution(
    velocity: float = 0.8, turbulence: float = 0.7, carried: Sequence[str] = TURBULENT
) -> str:
    """
    Return fvSolution for both solvers.

    `velocity` and `turbulence` are relaxation factors of the steady solver [1], `carried` the
    transported fields of the turbulence model.
    """
    model = '|'.join(carried)
    pressure: dict[str, Entry] = {
        'solver': 'GAMG',
        'smoother': 'GaussSeidel',
        'tolerance': 1e-8,
        'relTol': 0.05,
    }
    others: dict[str, Entry] = {
        'solver': 'smoothSolver',
        'smoother': 'symGaussSeidel',
        'tolerance': 1e-10,
    }
    return format_dictionary('fvSolution', {
        'solvers': {
            'p': pressure,
            'pFinal': {**pressure, 'tolerance': 1e-7, 'relTol': 0.01},
            'Phi': pressure,
            f'"(U|{model})"': {**others, 'relTol': 0.1},
            'UFinal': {**others, 'relTol': 0.01},
        },
        # 'consistent' selects SIMPLEC, which needs no relaxation of the pressure
        'SIMPLE': {'consistent': 'yes', 'nNonOrthogonalCorrectors': 0, 'pRefCell': 0,
                   'pRefValue': 0},
        'PIMPLE': {'nOuterCorrectors': 1, 'nCorrectors': 2, 'nNonOrthogonalCorrectors': 0},
        'relaxationFactors': {
            'fields': {'p': 1.0},
            'equations': {'U': velocity, f'"({model})"': turbulence},
        },
    })  # fmt: skip


def format_transient_fv_solution() -> str:
    """
    Return fvSolution of pimpleFoam.

    At large time steps the undamped convection matrix does not converge with Gauss-Seidel sweeps,
    so the velocity uses a Krylov solver.
    """
    pressure: dict[str, Entry] = {'solver': 'GAMG', 'smoother': 'GaussSeidel'}
    return format_dictionary('fvSolution', {
        'solvers': {
            'p': {**pressure, 'tolerance': 1e-8, 'relTol': 0.05},
            'pFinal': {**pressure, 'tolerance': 1e-7, 'relTol': 0.01},
            f'"(U|{"|".join(EDDY_VISCOSITY)})Final"': {
                'solver': 'PBiCGStab', 'preconditioner': 'DILU', 'tolerance': 1e-10,
                'relTol': 0.01,
            },
        },
        'PIMPLE': {'nOuterCorrectors': 1, 'nCorrectors': 2, 'nNonOrthogonalCorrectors': 0,
                   'pRefCell': 0, 'pRefValue': 0},
    })  # fmt: skip


def format_control_dict(
    program: str,
    begin: float,
    end: float,
    functions: Mapping[str, Entry],
    largest_step: float | None = None,
    courant: float = 3.0,
) -> str:
    """
    Return controlDict.

    Parameters
    ----------
    program : str
        The solver.
    begin, end : float
        Iterations of a steady solver, seconds of a transient one.
    functions : mapping
        Function objects.
    largest_step : float, optional
        Maximum time step of a transient solver. [s]
    courant : float
        Maximum Courant number of a transient solver. [1]

    """
    entries: dict[str, Entry] = {
        'application': program,
        'startFrom': 'startTime', 'startTime': begin, 'stopAt': 'endTime', 'endTime': end,
        # A steady solver counts iterations as time steps of 1
        'deltaT': 1 if largest_step is None else largest_step / 20.0,
        'writeControl': 'runTime' if largest_step is None else 'adjustableRunTime',
        # Write fields at the end only
        'writeInterval': end - begin,
        'purgeWrite': 0, 'writeFormat': 'binary', 'writePrecision': 8, 'timePrecision': 8,
        'runTimeModifiable': False,
    }  # fmt: skip
    if largest_step is not None:
        entries |= {'adjustTimeStep': True, 'maxCo': courant, 'maxDeltaT': largest_step}
    return format_dictionary('controlDict', {**entries, 'functions': functions})


def format_time_file(now: int, step: float) -> str:
    """
    Return the file with a solver's time, so that it does not inherit another solver's step of 1.

    `now` counts iterations so far, which become seconds; `step` is the new time step. [s]
    """
    return format_dictionary(
        'time',
        {'value': now, 'name': f'"{now}"', 'index': now, 'deltaT': step, 'deltaT0': step},
    )


def build_force_functions(patches: Mapping[str, str]) -> dict[str, Entry]:
    """
    Return function objects that record forces at every iteration, moments about the origin.

    `patches` maps the name of each record to a patch or a pattern of patches.
    """
    return {
        f'forces_{name}': {
            'type': 'forces', 'libs': ['forces'], 'patches': [patch], 'rho': 'rhoInf',
            'rhoInf': 1, 'CofR': [0, 0, 0], 'log': False, 'writeControl': 'timeStep',
            'writeInterval': 1,
        }
        for name, patch in patches.items()
    }  # fmt: skip


def build_momentum_functions(patches: tuple[str, ...]) -> dict[str, Entry]:
    """Return function objects that record the momentum flux through patches."""
    return {
        f'momentum_{patch}': {
            'type': 'surfaceFieldValue', 'libs': ['fieldFunctionObjects'], 'regionType': 'patch',
            'name': patch, 'operation': 'weightedSum', 'weightField': 'phi', 'fields': ['U'],
            'writeFields': False, 'log': False, 'writeControl': 'timeStep', 'writeInterval': 1,
        }
        for patch in patches
    }  # fmt: skip


def build_slice_function(normal: tuple[int, int, int], size: float) -> dict[str, Entry]:
    """Return a function object that writes the velocity in a central plane at the end."""
    # [m] Slightly off the plane, because a plane of symmetry contains no cells
    aside = [0.002 * size * each for each in normal]
    return {
        'slice': {
            'type': 'surfaces', 'libs': ['sampling'], 'writeControl': 'writeTime',
            'surfaceFormat': 'raw', 'interpolationScheme': 'cellPoint', 'fields': ['U'],
            'surfaces': {
                'plane': {
                    'type': 'cuttingPlane', 'planeType': 'pointAndNormal',
                    'pointAndNormalDict': {'point': aside, 'normal': list(normal)},
                    'interpolate': True,
                },
            },
        },
    }  # fmt: skip


def build_pressure_function(patches: Iterable[str]) -> dict[str, Entry]:
    """Return a function object that writes the pressure on the faces of patches at the end."""
    return {
        'pressure': {
            'type': 'surfaces', 'libs': ['sampling'], 'writeControl': 'writeTime',
            'surfaceFormat': 'raw', 'interpolationScheme': 'cell', 'fields': ['p'],
            'surfaces': {name: {'type': 'patch', 'patches': [name]} for name in patches},
        },
    }  # fmt: skip
