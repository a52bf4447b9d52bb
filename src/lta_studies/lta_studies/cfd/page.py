"""The page of a sweep: what the air does to the vehicle, and what its rotors do to the air."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.pieces import section, tile_html
from lta_sim.cfd.plan import MIDDLE, SLOW
from lta_sim.cfd.refit import ABOUT, ALONG, fits_of, processor_time, solved, warnings_of
from lta_sim.cfd.slices import Slice
from lta_sim.cfd.sweep_table import Axis, Sweep
from lta_sim.cfd.tunnel import MODELLED
from lta_studies.cfd.pictures import drag_picture, slice_picture
from lta_studies.cfd.tables import coefficients, patterns
from lta_studies.energy.tables import table_html

INTRODUCTION: Final = (
    'Drag along and about six axes, and what each rotor pushes with the hull in its jet, from the '
    'shape alone: no flight.'
)
DRAWN: Final = (
    'Points: what the flow solver gave, with the spread of the window that is averaged. Lines: '
    'the fit that flies. Dotted: the estimate by hand, which should be within a factor of two.'
)
METHOD: Final = (
    'One mesh a direction, the air at 1 m/s, the viscosity divided by the speed that is meant. '
    'preview: steady k-omega SST with transition, half or a quarter of the air where the vehicle '
    f'mirrors. reference: transient at {MIDDLE:g} m/s, the whole tunnel, implicit large eddies, '
    f'detached ones beyond a Reynolds number of {MODELLED:,.0f}; steady at {SLOW:g} m/s.',
    'Rotors are momentum sources in their disks, without swirl. Turning is steady, in a frame '
    'that turns along: the damping of small fast swings is under-predicted.',
    'A number is refused where a disk has under 30 cells, where the force still swings by over '
    '15 %, or where over 10 % of it is not in the momentum of the air. Nothing here is '
    'grid-converged.',
)


def write_page(
    sweep: Sweep, slices: Sequence[Slice], commands: Mapping[str, str], out: Path
) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(sweep, slices, commands), out)


def page(sweep: Sweep, slices: Sequence[Slice], commands: Mapping[str, str]) -> str:
    """Return the whole page."""
    pictures = [section('about', 'Turning', DRAWN, drag_picture(sweep, turning=True))]
    pictures += [
        section(f'slice-{each.about}', heading(each), CAPTION, slice_picture(each))
        for each in slices
    ]
    tables = table_html(coefficients(sweep))
    if sweep.blows:
        tables += table_html(patterns(sweep))
    warned = [f'Take care: {each}.' for each in warnings_of(sweep)]
    notes = ''.join(f'<p class="note">{escape(each)}</p>' for each in [*warned, *METHOD])
    return framed(
        'energy.html',
        title=escape(title(sweep)),
        kicker=escape(f'cfd run · {sweep.name}'),
        about=INTRODUCTION,
        tiles='\n'.join(tile_html(*each) for each in tiles(sweep)),
        first=section('along', 'Moving', DRAWN, drag_picture(sweep, turning=False)),
        pictures='\n'.join(pictures),
        tables=tables,
        method=notes,
        facts={
            'engine': sweep.engine, 'fidelity': sweep.fidelity, 'geometry': sweep.geometry,
            'processor time': f'{processor_time(sweep) / 60.0:.1f} min, without meshes',
            'commit': commit(),
        },
        commands=commands,
    )  # fmt: skip


CAPTION: Final = 'Speed of the air in the plane through the middle; grey is solid.'


def heading(found: Slice) -> str:
    """Return what a slice shows."""
    return f'{found.about.replace("_", " ").capitalize()}: the air in the middle plane'


def title(sweep: Sweep) -> str:
    """Return what came out, in a sentence."""
    fits = fits_of(sweep)
    return (
        f'{sweep.name} brakes with {fits["surge"].at(1.0):.3f} N edge-on and '
        f'{fits["heave"].at(1.0):.3f} N broadside at 1 m/s ({sweep.fidelity}).'
    )


def tiles(sweep: Sweep) -> list[Tile]:
    """Return the drag of each axis at 1 m/s or 1 rad/s, and the lift of all rotors."""
    fits = fits_of(sweep)
    made = [
        Tile(axis, f'{1e3 * fits[axis].at(1.0):.0f}', 'mN', f'at 1 m/s, {_found(sweep, axis)}')
        for axis in ALONG
    ]  # fmt: skip
    made += [
        Tile(axis, f'{1e3 * fits[axis].at(1.0):.2f}', 'mN m', f'at 1 rad/s, {_found(sweep, axis)}')
        for axis in ABOUT
    ]  # fmt: skip
    if (blown := sweep.blows.get('all')) is not None:
        made.append(Tile('all rotors on', f'{blown.force[2]:.3f}', 'N', 'net, upwards'))
    return made


def _found(sweep: Sweep, axis: Axis) -> str:
    return 'solved' if solved(sweep, axis) else 'by hand'
