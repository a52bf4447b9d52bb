"""Write the initial and boundary conditions: the files of the folder 0."""

from collections.abc import Mapping, Sequence
import math
from typing import Final

from lta_windtunnel.openfoam.input_files import EDDY_VISCOSITY, Entry, format_files

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
DETACHED: Final = ('U', 'p', 'nut', *EDDY_VISCOSITY)


def _open_boundary(name: str) -> Mapping[str, Entry]:
    """Return a boundary with free outflow, and far-field values for inflow."""
    return {'type': 'inletOutlet', 'inletValue': _inflow_value(name), **INITIAL}


def _inflow_value(name: str) -> str:
    return CLEAN_INFLOW if name in EDDY_VISCOSITY else '$internalField'


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
