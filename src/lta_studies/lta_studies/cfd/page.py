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
    'Drag of the vehicle along and about its three axes, and the net force of each rotor '
    'including its jet on the hull. A flow solver computes both from the shape, without '
    'flights.'
)
DRAWN: Final = (
    'Points: drag from the flow solver, with its variation over the averaging window. '
    'Lines: the fit that flight simulations use. Dotted: analytical estimate, which should '
    'agree within a factor of two.'
)
METHOD: Final = (
    'Each direction has one mesh. The air always moves at 1 m/s; to get the Reynolds number '
    'of another speed, the viscosity is divided by that speed. Fidelity preview: steady '
    'k-omega SST with transition, on a half or a quarter of the domain where the vehicle is '
    f'symmetric. Fidelity reference: transient at {MIDDLE:g} m/s in the whole tunnel, with '
    f'implicit LES, or DES above a Reynolds number of {MODELLED:,.0f}; steady at {SLOW:g} '
    'm/s.',
    'Each rotor is a momentum source in its disk, without swirl. Rotation of the vehicle is '
    'computed as steady, in a rotating frame: the damping of small fast oscillations is '
    'underestimated.',
    'A result is rejected if a rotor disk has fewer than 30 cells, if the force still '
    'varies by more than 15 %, or if the momentum of the air differs from the force by more '
    'than 10 %. The results are not grid-converged.',
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
            'processor time': f'{sum_processor_time(sweep) / 60.0:.1f} min, without meshing',
            'commit': read_commit(),
        },
        commands=commands,
    )  # fmt: skip


CAPTION: Final = 'Airspeed in the middle plane. Grey: solid parts.'


def format_slice_heading(plane: FlowSlice) -> str:
    """Return the heading of a slice."""
    return f'{plane.about.replace("_", " ").capitalize()}: airspeed in the middle plane'


def format_headline(sweep: TunnelSweep) -> str:
    """Return the headline."""
    fits = fit_drag_by_axis(sweep)
    return (
        f'{sweep.name} has a drag of {fits["surge"].drag_at(1.0):.3f} N in forward flight '
        f'and {fits["heave"].drag_at(1.0):.3f} N in vertical flight at 1 m/s '
        f'({sweep.fidelity}).'
    )


def build_tiles(sweep: TunnelSweep) -> list[Tile]:
    """Return tiles with the drag of each axis at 1 m/s or 1 rad/s, and the lift of all rotors."""
    fits = fit_drag_by_axis(sweep)
    made = [
        Tile(axis, f'{1e3 * fits[axis].drag_at(1.0):.0f}', 'mN',
             f'drag at 1 m/s, {_describe_source(sweep, axis)}')
        for axis in ALONG
    ]  # fmt: skip
    made += [
        Tile(axis, f'{1e3 * fits[axis].drag_at(1.0):.2f}', 'mN m',
             f'drag at 1 rad/s, {_describe_source(sweep, axis)}')
        for axis in ABOUT
    ]  # fmt: skip
    # A vehicle without rotors has no such flow.
    if (blown := sweep.blows.get('all')) is not None:
        made.append(Tile('all rotors on', f'{blown.force[2]:.3f}', 'N', 'net, upwards'))
    return made


def _describe_source(sweep: TunnelSweep, axis: Axis) -> str:
    return 'from the flow solver' if select_solved_points(sweep, axis) else 'analytical estimate'
