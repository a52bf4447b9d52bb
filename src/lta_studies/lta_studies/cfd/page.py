"""Write the page of a wind-tunnel sweep: drag of the vehicle, and its rotors' net wrenches."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_report.formatting import Tile
from lta_report.html_elements import render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_sim.cfd.aero_fit import (
    ABOUT,
    ALONG,
    collect_warnings,
    fit_drag_by_axis,
    select_solved_points,
    sum_processor_time,
)
from lta_sim.cfd.flow_plan import MIDDLE, SLOW
from lta_sim.cfd.slices import FlowSlice
from lta_sim.cfd.sweep_table import Axis, TunnelSweep
from lta_sim.cfd.tunnel import MODELLED
from lta_studies.cfd.pictures import draw_drag, draw_slice
from lta_studies.cfd.tables import build_drag_table, build_rotor_table
from lta_studies.energy.tables import render_text_table

INTRODUCTION: Final = (
    'Drag along and about six axes, and the net force of each rotor with the hull in its jet, '
    'computed from the shape without flights.'
)
DRAWN: Final = (
    'Points: results of the flow solver, with the spread of the averaging window. Lines: '
    'the fit used in flight. Dotted: estimate by hand, which should agree within a factor of two.'
)
METHOD: Final = (
    'One mesh per direction; air at 1 m/s, with the viscosity divided by the intended speed. '
    'preview: steady k-omega SST with transition, half or a quarter of the domain where the '
    f'vehicle is symmetric. reference: transient at {MIDDLE:g} m/s, whole tunnel, implicit LES, '
    f'DES beyond a Reynolds number of {MODELLED:,.0f}; steady at {SLOW:g} m/s.',
    'Rotors are momentum sources in their disks, without swirl. Turning is steady in a rotating '
    'frame: the damping of small fast swings is under-predicted.',
    'A number is rejected if a disk has under 30 cells, the force still varies by over '
    '15 %, or over 10 % of it is missing in the momentum of the air. Nothing here is '
    'grid-converged.',
)


def write_page(
    sweep: TunnelSweep, slices: Sequence[FlowSlice], commands: Mapping[str, str], out: Path
) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(sweep, slices, commands), out)


def render_page(
    sweep: TunnelSweep, slices: Sequence[FlowSlice], commands: Mapping[str, str]
) -> str:
    """Return the HTML of the page."""
    pictures = [render_section('about', 'Turning', DRAWN, draw_drag(sweep, turning=True))]
    pictures += [
        render_section(
            f'slice-{each.about}', format_slice_heading(each), CAPTION, draw_slice(each)
        )
        for each in slices
    ]
    tables = render_text_table(build_drag_table(sweep))
    if sweep.blows:
        tables += render_text_table(build_rotor_table(sweep))
    warned = [f'Warning: {each}.' for each in collect_warnings(sweep)]
    notes = ''.join(f'<p class="note">{escape(each)}</p>' for each in [*warned, *METHOD])
    return assemble_page(
        'energy.html',
        title=escape(format_headline(sweep)),
        kicker=escape(f'cfd run · {sweep.name}'),
        about=INTRODUCTION,
        tiles='\n'.join(render_tile(*each) for each in build_tiles(sweep)),
        first=render_section('along', 'Moving', DRAWN, draw_drag(sweep, turning=False)),
        pictures='\n'.join(pictures),
        tables=tables,
        method=notes,
        facts={
            'engine': sweep.engine, 'fidelity': sweep.fidelity, 'geometry': sweep.geometry,
            'processor time': f'{sum_processor_time(sweep) / 60.0:.1f} min, without meshes',
            'commit': read_commit(),
        },
        commands=commands,
    )  # fmt: skip


CAPTION: Final = 'Airspeed in the middle plane; grey is solid.'


def format_slice_heading(plane: FlowSlice) -> str:
    """Return the heading of a slice."""
    return f'{plane.about.replace("_", " ").capitalize()}: the air in the middle plane'


def format_headline(sweep: TunnelSweep) -> str:
    """Return the headline."""
    fits = fit_drag_by_axis(sweep)
    return (
        f'{sweep.name} has a drag of {fits["surge"].drag_at(1.0):.3f} N edge-on and '
        f'{fits["heave"].drag_at(1.0):.3f} N broadside at 1 m/s ({sweep.fidelity}).'
    )


def build_tiles(sweep: TunnelSweep) -> list[Tile]:
    """Return tiles with the drag of each axis at 1 m/s or 1 rad/s, and the lift of all rotors."""
    fits = fit_drag_by_axis(sweep)
    made = [
        Tile(axis, f'{1e3 * fits[axis].drag_at(1.0):.0f}', 'mN', f'at 1 m/s, '
        f'{_describe_source(sweep, axis)}')
        for axis in ALONG
    ]  # fmt: skip
    made += [
        Tile(axis, f'{1e3 * fits[axis].drag_at(1.0):.2f}', 'mN m', f'at 1 rad/s, '
        f'{_describe_source(sweep, axis)}')
        for axis in ABOUT
    ]  # fmt: skip
    # A vehicle without rotors has no such flow.
    if (blown := sweep.blows.get('all')) is not None:
        made.append(Tile('all rotors on', f'{blown.force[2]:.3f}', 'N', 'net, upwards'))
    return made


def _describe_source(sweep: TunnelSweep, axis: Axis) -> str:
    return 'solved' if select_solved_points(sweep, axis) else 'by hand'
