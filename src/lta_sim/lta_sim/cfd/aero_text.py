"""The aero file as text, from a raw sweep."""

from collections.abc import Callable, Sequence
import math
from typing import Any

from lta_sim.cfd.columns import Column, column, coupling
from lta_sim.cfd.fit import Fit
from lta_sim.cfd.refit import (
    ABOUT,
    ALONG,
    beside_of,
    fits_of,
    fitted_of,
    hull_share,
    mesh_share,
    ratio_by_hand,
    solved,
    warnings_of,
)
from lta_sim.cfd.sweep_table import AXES, Axis, Sweep
import yaml

NOTHING = 1e-9  # of any coefficient: symmetry cancels some but for rounding


def _four(number: float) -> float:
    """Return a number with four digits; what rounding leaves of nothing is nothing."""
    return float(f'{number:.4g}') if abs(number) > NOTHING else 0.0


def quantity(value: float | Sequence[float], unit: str, source: str) -> dict[str, Any]:
    """Return a quantity as YAML has it, with four digits."""
    numbers = [_four(each) for each in value] if isinstance(value, Sequence) else value
    return {'value': numbers, 'unit': unit, 'source': source}


def _source(sweep: Sweep, axes: Sequence[Axis]) -> str:
    """Return what the coefficients of three axes come from."""
    flown = [axis for axis in axes if solved(sweep, axis)]
    hand = [axis for axis in axes if axis not in flown]
    told = [f'{sweep.engine}, {sweep.fidelity}: {", ".join(flown)}'] if flown else []
    return '; '.join(told + ([f'by hand: {", ".join(hand)}'] if hand else []))


def _drag(
    sweep: Sweep, fits: dict[Axis, Fit], term: Callable[[Fit], float], square: str
) -> dict[str, Any]:
    along, about = tuple(ALONG), tuple(ABOUT)
    unit = {'': ('N s/m', 'N m s'), '2': ('N s2/m2', 'N m s2')}[square]
    return {
        'force': quantity([term(fits[a]) for a in along], unit[0], _source(sweep, along)),
        'moment': quantity([term(fits[a]) for a in about], unit[1], _source(sweep, about)),
    }


def _wrench(found: Column, engine: str) -> dict[str, Any]:
    source = f'{engine}, {found.found}'
    return {
        'force': quantity(found.wrench[:3].tolist(), 'N/N', source),
        'moment': quantity(found.wrench[3:].tolist(), 'm', source),
    }


def _columns(sweep: Sweep) -> dict[str, Any]:
    told: dict[str, Any] = {}
    for name in sweep.rotors:
        if (found := column(sweep, name)) is None:
            continue
        told[name] = _wrench(found, sweep.engine)
        if (back := column(sweep, name, backward=True)) is not None:
            told[name]['reverse'] = _wrench(back, sweep.engine)
    return told


def aero_of(sweep: Sweep) -> dict[str, Any]:
    """Return the content of the aero file of a sweep, as YAML has it."""
    fits = fits_of(sweep)
    aero: dict[str, Any] = {
        'linear_drag': _drag(sweep, fits, lambda fit: fit.linear, ''),
        'quadratic_drag': _drag(sweep, fits, lambda fit: fit.quadratic, '2'),
    }
    if columns := _columns(sweep):
        aero['thrust_allocation'] = columns
    if (coupled := coupling(sweep)) is not None:
        aero['coupling'] = {
            'rotors': list(coupled.rotors),
            **_wrench(Column(coupled.wrench, 'all on, less the columns'), sweep.engine),
        }
    return {
        'schema': 1,
        'name': sweep.name,
        'vehicle': sweep.vehicle,
        'evidence': {
            'engine': sweep.engine,
            'fidelity': sweep.fidelity,
            'geometry': sweep.geometry,
            'density': quantity(sweep.density, 'kg/m3', 'as solved'),
            'axes': {axis: _fitted(sweep, axis, fits[axis]) for axis in AXES},
            'beside': beside_of(sweep),
            'warnings': warnings_of(sweep),
        },
        'aero': aero,
    }


def _fitted(sweep: Sweep, axis: Axis, fit: Fit) -> dict[str, Any]:
    points = fitted_of(sweep, axis)
    told = {
        'points': len(points),
        'error': _three(round(fit.error, 9)),  # two points are met but for rounding
        'exponent': None if math.isnan(fit.exponent) else float(f'{fit.exponent:.4g}'),
        'spread': max(point.evidence.spread for point in points),
        'cells': max(point.evidence.cells for point in points),
        'by_hand': _three(ratio_by_hand(sweep, axis)),
        'mesh': _three(mesh_share(sweep, axis)),
        'hull': _three(hull_share(sweep, axis)),
    }
    return {name: each for name, each in told.items() if each is not None}


def _three(number: float | None) -> float | None:
    return None if number is None else float(f'{number:.3g}')


def aero_text(sweep: Sweep) -> str:
    """Return the aero file of a sweep."""
    head = (
        f'# What the wind tunnel gave of {sweep.name}. Not written by hand: lta cfd refit makes '
        f'it from {sweep.name}.sweep.json.\n'
    )
    return head + yaml.dump(
        aero_of(sweep), sort_keys=False, default_flow_style=None, width=150, allow_unicode=True
    )
