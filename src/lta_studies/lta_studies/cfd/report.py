"""Build the report of a wind-tunnel sweep: drag of the vehicle, and its rotors' net wrenches."""

from collections.abc import Sequence
import json
from typing import Final

from lta_report.formatting import Tile
from lta_report.report import Picture, Report, TextSection
from lta_studies.cfd.pictures import draw_drag, draw_slice
from lta_studies.cfd.tables import build_drag_table, build_incidence_table, build_rotor_table
from lta_windtunnel.aero_fit import (
    ABOUT,
    ALONG,
    collect_warnings,
    fit_drag_by_axis,
    select_solved_points,
    sum_processor_time,
)
from lta_windtunnel.aero_text import format_aero_file
from lta_windtunnel.flow_fields import FlowSlice
from lta_windtunnel.flow_plan import MIDDLE_SPEED, SLOW_SPEED
from lta_windtunnel.sweep_table import Axis, drop_pressure_maps, format_sweep, TunnelSweep
from lta_windtunnel.tunnel import MAX_LAMINAR_REYNOLDS

INTRODUCTION: Final = (
    'Drag of the vehicle along and about its three axes, and the net force of each rotor '
    'including its jet on the hull. A flow solver computes both from the shape, without '
    'flights.'
)
DRAWN: Final = (
    'Points: drag from the flow solver, with its variation over the averaging window. '
    'Lines: the fit that flight simulations use. Dotted: analytic estimate, which should '
    'agree within a factor of two.'
)
METHOD: Final = (
    'Each direction has one mesh. The air always moves at 1 m/s; to get the Reynolds number '
    'of another speed, the viscosity is divided by that speed. Fidelity preview: steady '
    'k-omega SST with transition, on a half or a quarter of the domain where the vehicle is '
    f'symmetric. Fidelity reference: transient at {MIDDLE_SPEED:g} m/s in the whole tunnel, with '
    f'implicit LES, or DES above a Reynolds number of {MAX_LAMINAR_REYNOLDS:,.0f}; steady at '
    f'{SLOW_SPEED:g} m/s.',
    'Each rotor is a momentum source in its disk, without swirl. Rotation of the vehicle is '
    'computed as steady, in a rotating frame: the damping of small fast oscillations is '
    'underestimated.',
    'A result is rejected if a rotor disk has fewer than 30 cells, if the force still '
    'varies by more than 15 %, or if the momentum of the air differs from the force by more '
    'than 10 %. The results are not grid-converged.',
)
CAPTION: Final = 'Airspeed in the middle plane. Grey: solid parts.'


def build_report(sweep: TunnelSweep, slices: Sequence[FlowSlice]) -> Report:
    """Return the report of a sweep."""
    warnings = [f'Warning: {each}.' for each in collect_warnings(sweep)]
    # Pressure maps are large; only the blown file contains them
    small = format_sweep(drop_pressure_maps(sweep))
    outputs = {f'{sweep.name}.aero.yaml': format_aero_file(sweep)}
    if sweep.blows:
        outputs[f'{sweep.name}.blown.json'] = format_sweep(sweep)
    return Report(
        command='cfd run',
        subject=sweep.name,
        headline=format_headline(sweep),
        introduction=INTRODUCTION,
        tiles=build_tiles(sweep),
        blocks=(
            Picture('along', 'Moving', DRAWN, draw_drag(sweep, turning=False)),
            Picture('about', 'Turning', DRAWN, draw_drag(sweep, turning=True)),
            *(
                Picture(
                    f'slice-{each.about}', format_slice_heading(each), CAPTION, draw_slice(each)
                )
                for each in slices
            ),
            build_drag_table(sweep),
            *([build_incidence_table(sweep)] if sweep.inclined else []),
            *([build_rotor_table(sweep)] if sweep.blows else []),
            TextSection('Meaning and method', (*warnings, *METHOD)),
        ),
        data=json.loads(small),
        facts={
            'engine': sweep.engine, 'fidelity': sweep.fidelity, 'geometry': sweep.geometry,
            'processor time': f'{sum_processor_time(sweep) / 60.0:.1f} min, without meshing',
        },
        json_name=f'{sweep.name}.sweep.json',
        outputs=outputs,
        # Without any solved flow, the files still contain the analytic part
        status=1 if sweep.refused and not (sweep.axes or sweep.inclined or sweep.blows) else 0,
    )  # fmt: skip


def format_slice_heading(plane: FlowSlice) -> str:
    """Return the heading of a slice."""
    return f'{plane.about.replace("_", " ").capitalize()}: airspeed in the middle plane'


def format_headline(sweep: TunnelSweep) -> str:
    """Return the headline."""
    fits = fit_drag_by_axis(sweep)
    failed = len(sweep.refused)
    count = failed + len(sweep.blows) + len(sweep.coarse) + len(sweep.inclined)
    count += sum(map(len, sweep.axes.values()))
    lost = f', {failed} of {count} results failed' if failed else ''
    return (
        f'{sweep.name} has a drag of {fits["surge"].drag_at(1.0):.3f} N in forward flight '
        f'and {fits["heave"].drag_at(1.0):.3f} N in vertical flight at 1 m/s '
        f'({sweep.fidelity}{lost}).'
    )


def build_tiles(sweep: TunnelSweep) -> list[Tile]:
    """Return tiles with the drag of each axis at 1 m/s or 1 rad/s, and the lift of all rotors."""
    fits = fit_drag_by_axis(sweep)
    tiles = [
        Tile(axis, f'{1e3 * fits[axis].drag_at(1.0):.0f}', 'mN',
             f'drag at 1 m/s, {_describe_source(sweep, axis)}')
        for axis in ALONG
    ]  # fmt: skip
    tiles += [
        Tile(axis, f'{1e3 * fits[axis].drag_at(1.0):.2f}', 'mN m',
             f'drag at 1 rad/s, {_describe_source(sweep, axis)}')
        for axis in ABOUT
    ]  # fmt: skip
    # A vehicle without rotors has no such flow.
    if (blown := sweep.blows.get('all')) is not None:
        tiles.append(Tile('all rotors on', f'{blown.force[2]:.3f}', 'N', 'net, upwards'))
    return tiles


def _describe_source(sweep: TunnelSweep, axis: Axis) -> str:
    return 'from the flow solver' if select_solved_points(sweep, axis) else 'analytic estimate'
