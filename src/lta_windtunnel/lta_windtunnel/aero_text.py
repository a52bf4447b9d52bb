# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Format the aero file of a raw sweep."""

from collections.abc import Callable, Sequence
import math
from typing import Any

from lta_windtunnel.aero_fit import (
    ALONG,
    collect_warnings,
    describe_side_loads,
    DragFit,
    fit_drag_by_axis,
    hull_share,
    mesh_share,
    ratio_to_estimate,
    select_fit_points,
    select_solved_points,
    TURN_AXIS,
)
from lta_windtunnel.sweep_table import AXES, Axis, round_digits, TunnelSweep
from lta_windtunnel.thrust_allocation import (
    AllocationColumn,
    compute_jet_coupling,
    find_rotor_column,
)
import yaml

NO_COEFFICIENT = 1e-9  # any coefficient below is zero by symmetry, except for rounding


def _round_to_four_digits(number: float) -> float:
    """Round to four digits; values that are zero by symmetry become exactly zero."""
    return round_digits(number, 4) if abs(number) > NO_COEFFICIENT else 0.0


def format_quantity(value: float | Sequence[float], unit: str, source: str) -> dict[str, Any]:
    """Return a quantity for YAML, with four digits."""
    numbers = (
        [_round_to_four_digits(each) for each in value] if isinstance(value, Sequence) else value
    )
    return {'value': numbers, 'unit': unit, 'source': source}


def _describe_source(sweep: TunnelSweep, axes: Sequence[Axis]) -> str:
    """Return the source of the coefficients of three axes."""
    solved = [axis for axis in axes if select_solved_points(sweep, axis)]
    rest = [axis for axis in axes if axis not in solved]
    sources = [f'{sweep.engine}, {sweep.fidelity}: {", ".join(solved)}'] if solved else []
    return '; '.join(sources + ([f'analytic estimate: {", ".join(rest)}'] if rest else []))


def _format_drag(
    sweep: TunnelSweep, fits: dict[Axis, DragFit], term: Callable[[DragFit], float], square: str
) -> dict[str, Any]:
    along, about = tuple(ALONG), tuple(TURN_AXIS)
    unit = {'': ('N s/m', 'N m s'), '2': ('N s2/m2', 'N m s2')}[square]
    return {
        'force': format_quantity(
            [term(fits[a]) for a in along], unit[0], _describe_source(sweep, along)
        ),
        'moment': format_quantity(
            [term(fits[a]) for a in about], unit[1], _describe_source(sweep, about)
        ),
    }


def _format_wrench(column: AllocationColumn, engine: str) -> dict[str, Any]:
    source = f'{engine}, {column.source}'
    return {
        'force': format_quantity(column.wrench[:3].tolist(), 'N/N', source),
        'moment': format_quantity(column.wrench[3:].tolist(), 'm', source),
    }


def _format_columns(sweep: TunnelSweep) -> dict[str, Any]:
    columns: dict[str, Any] = {}
    for name in sweep.rotors:
        if (column := find_rotor_column(sweep, name)) is None:
            continue
        columns[name] = _format_wrench(column, sweep.engine)
        # A reversed rotor blows the other way over the hull, so it has its own column
        if (back := find_rotor_column(sweep, name, backward=True)) is not None:
            columns[name]['reverse'] = _format_wrench(back, sweep.engine)
    return columns


def build_aero_content(sweep: TunnelSweep) -> dict[str, Any]:
    """Return the content of the aero file of a sweep, for YAML."""
    fits = fit_drag_by_axis(sweep)
    aero: dict[str, Any] = {
        'linear_drag': _format_drag(sweep, fits, lambda fit: fit.linear, ''),
        'quadratic_drag': _format_drag(sweep, fits, lambda fit: fit.quadratic, '2'),
    }
    if columns := _format_columns(sweep):
        aero['thrust_allocation'] = columns
    if (coupled := compute_jet_coupling(sweep)) is not None:
        aero['coupling'] = {
            'rotors': list(coupled.rotors),
            **_format_wrench(
                AllocationColumn(
                    coupled.wrench, 'all rotors on, minus the columns of the single rotors'
                ),
                sweep.engine,
            ),
        }
    return {
        'schema': 1,
        'name': sweep.name,
        'vehicle': sweep.vehicle,
        'evidence': {
            'engine': sweep.engine,
            'fidelity': sweep.fidelity,
            'geometry': sweep.geometry,
            'density': format_quantity(sweep.density, 'kg/m3', 'as solved'),
            'axes': {axis: _format_fit(sweep, axis, fits[axis]) for axis in AXES},
            'beside': describe_side_loads(sweep),
            'warnings': collect_warnings(sweep),
        },
        'aero': aero,
    }


def _format_fit(sweep: TunnelSweep, axis: Axis, fit: DragFit) -> dict[str, Any]:
    points = select_fit_points(sweep, axis)
    entries: dict[str, Any] = {
        'points': len(points),
        # A fit through two points is exact except for rounding
        'error': round_digits(round(fit.error, 9), 3),
        **({} if math.isnan(fit.exponent) else {'exponent': round_digits(fit.exponent, 4)}),
        'spread': max(point.evidence.spread for point in points),
        'cells': max(point.evidence.cells for point in points),
        'by_hand': round_digits(ratio_to_estimate(sweep, axis), 3),
    }
    # Missing evidence is omitted rather than written as null
    for name, share in (('mesh', mesh_share(sweep, axis)), ('hull', hull_share(sweep, axis))):
        if share is not None:
            entries[name] = round_digits(share, 3)
    return entries


def format_aero_file(sweep: TunnelSweep) -> str:
    """Return the aero file of a sweep."""
    head = (
        f'# Aerodynamic data of {sweep.name} from the simulated wind tunnel. Do not edit: '
        f'lta cfd refit generates this file from {sweep.name}.sweep.json.\n'
    )
    return head + yaml.dump(
        build_aero_content(sweep),
        sort_keys=False,
        default_flow_style=None,
        width=150,
        allow_unicode=True,
    )
