"""Write the initial and boundary conditions: the files of the folder 0."""

from collections.abc import Mapping, Sequence
import math
from typing import Final

from lta_windtunnel.openfoam.dictionary import Entry, format_dictionary
from lta_windtunnel.openfoam.numerics import EDDY_VISCOSITY

INTENSITY, EDDY = 0.005, 0.05  # turbulence of the oncoming air, and the size of its eddies [m]
# Isotropic turbulence; omega from k and the eddy size with C_mu = 0.09
K: Final = 1.5 * INTENSITY**2  # at 1 m/s [m2/s2]
OMEGA: Final = math.sqrt(K) / (0.09**0.25 * EDDY)  # [1/s]
# Langtry and Menter 2009, for an intensity of 0.5 %.
THETA: Final = 1173.51 - 589.428 * 0.5 + 0.2196 / 0.25
# Where eddies are resolved, the inflow has none: the boundary layer stays laminar until it
# separates, as on real hulls below the drag crisis ("tripless", Travin et al. 2000). The initial
# air has an eddy viscosity of a few times the viscosity, which seeds the wake.
CLEAN: Final = 'uniform 1e-12'
SEED: Final = 5.0

# Exponents of kg, m, s, K, mol, A, cd
DIMENSIONS: Final = {
    'U': '[0 1 -1 0 0 0 0]', 'p': '[0 2 -2 0 0 0 0]', 'k': '[0 2 -2 0 0 0 0]',
    'omega': '[0 0 -1 0 0 0 0]', 'nut': '[0 2 -1 0 0 0 0]', 'ReThetat': '[0 0 0 0 0 0 0]',
    'gammaInt': '[0 0 0 0 0 0 0]', 'nuTilda': '[0 2 -1 0 0 0 0]',
}  # fmt: skip
INSIDE: Final[Mapping[str, str]] = {
    'U': 'uniform (1 0 0)', 'p': 'uniform 0', 'k': f'uniform {K:.8g}',
    'omega': f'uniform {OMEGA:.8g}', 'nut': 'uniform 0', 'ReThetat': f'uniform {THETA:.6g}',
    'gammaInt': 'uniform 1',
}  # fmt: skip
ZERO: Final = {'type': 'zeroGradient'}
WALL: Final[Mapping[str, Mapping[str, Entry]]] = {
    'U': {'type': 'noSlip'},
    'p': ZERO,
    'k': {'type': 'kLowReWallFunction', 'value': '$internalField'},
    'omega': {'type': 'omegaWallFunction', 'blended': True, 'value': '$internalField'},
    'nut': {'type': 'nutUSpaldingWallFunction', 'value': '$internalField'},
    'ReThetat': ZERO,
    'gammaInt': ZERO,
    'nuTilda': {'type': 'fixedValue', 'value': 'uniform 0'},
}

STEADY: Final = ('U', 'p', 'k', 'omega', 'nut')
TRANSITION: Final = (*STEADY, 'ReThetat', 'gammaInt')
DETACHED: Final = ('U', 'p', 'nut', *EDDY_VISCOSITY)


def _open_boundary(name: str) -> Mapping[str, Entry]:
    """Return a boundary with free outflow, and far-field values for inflow."""
    return {'type': 'inletOutlet', 'inletValue': _inflow_value(name), 'value': '$internalField'}


def _inflow_value(name: str) -> str:
    return CLEAN if name in EDDY_VISCOSITY else '$internalField'


def _calculated_boundary(name: str) -> Mapping[str, Entry]:
    return {'type': 'calculated', 'value': '$internalField'}


def _format_field(name: str, inside: str, boundary: Mapping[str, Mapping[str, Entry]]) -> str:
    kind = 'volVectorField' if name == 'U' else 'volScalarField'
    return format_dictionary(
        name,
        {'dimensions': DIMENSIONS[name], 'internalField': inside, 'boundaryField': boundary},
        kind,
    )


def format_tunnel_fields(
    names: Sequence[str], walls: Sequence[str], planes: Sequence[str], viscosity: float = 0.0
) -> dict[str, str]:
    """
    Return the fields of a wind tunnel with air along x at 1 m/s.

    Parameters
    ----------
    names : sequence of str
        Fields that the solver needs.
    walls : sequence of str
        Patches of the bodies.
    planes : sequence of str
        Patches of symmetry planes.
    viscosity : float
        Kinematic viscosity, from which the initial `nuTilda` is set. [m2/s]

    """
    files = {}
    for name in names:
        inlet: Mapping[str, Entry] = {'type': 'fixedValue', 'value': _inflow_value(name)}
        outlet = _open_boundary(name)
        # Pressure is fixed at the outlet only; elsewhere the velocity is
        if name == 'p':
            inlet, outlet = ZERO, {'type': 'fixedValue', 'value': 'uniform 0'}
        elif name == 'nut':
            inlet = outlet = _calculated_boundary(name)
        inside = f'uniform {SEED * viscosity:.6g}' if name in EDDY_VISCOSITY else INSIDE[name]
        files[f'0/{name}'] = _format_field(name, inside, {
            'inlet': inlet,
            'outlet': outlet,
            # Frictionless, so that the tunnel's walls have no boundary layer
            'sides': {'type': 'slip'},
            **{plane: {'type': 'symmetryPlane'} for plane in planes},
            **dict.fromkeys(walls, WALL[name]),
        })  # fmt: skip
    return files


def format_still_air_fields(names: Sequence[str], walls: Sequence[str]) -> dict[str, str]:
    """Return the fields of an open box of still air; parameters as `format_tunnel_fields`."""
    files = {}
    for name in names:
        far = _open_boundary(name)
        if name == 'U':
            far = {'type': 'pressureInletOutletVelocity', 'value': 'uniform (0 0 0)'}
        elif name == 'p':
            # Entrained air enters from rest: its total pressure is the ambient one
            far = {'type': 'totalPressure', 'p0': 'uniform 0', 'value': 'uniform 0'}
        elif name == 'nut':
            far = _calculated_boundary(name)
        inside = 'uniform (0 0 0)' if name == 'U' else INSIDE[name]
        boundary = {'far': far, **dict.fromkeys(walls, WALL[name])}
        files[f'0/{name}'] = _format_field(name, inside, boundary)
    return files
