"""Write the layout as one self-contained HTML page."""

from collections.abc import Sequence
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_report.formatting import MISSING, Tile
from lta_report.html_elements import render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_studies.light.plan.gaps import CoverageGap, find_gaps
from lta_studies.light.plan.handover import LampHandover
from lta_studies.light.plan.joint_snr import PURE
from lta_studies.light.plan.layout import LampLayout
from lta_studies.light.plan.pictures import plot_coverage, plot_handovers

PAPER: Final = 150.0  # m2 per lamp, seed paper
MOST_GAPS: Final = 12
HEIGHTS: Final = (360.0, 900.0)  # px of a picture
WIDTH: Final = 1100.0  # px, typical width of a plot on a desktop
COVERED: Final = (
    'Colour: SNR of the best received lamp in each cell, at the worst heading of the drone. '
    'Grey: obstacles. White: the hull does not fit. Hatched: fewer lamps are received than '
    'required.'
)
HANDED: Final = (
    'Rings: where a flight to a lamp ends, the nearest cell that receives it. Thin lines: '
    'hand-overs, where the next lamp is received at that point and the straight path to the '
    'end of its flight is free. Thick: the longest of the shortest routes between two lamps.'
)
METHOD: Final = (
    'A lamp is received in a cell if two conditions hold at every heading with all other '
    'lamps on: its SNR on its best diode is at least {needed:g} ({margin:g} times the '
    'threshold of the demodulator), and in its search window it is {pure:g} times as strong '
    'as the crosstalk of the others. Light, diodes, noise and demodulation are those of the '
    "simulator. Walls, obstacles and the drone's own hull block the light. Neglected are "
    'reflections, which is conservative, tilt, and details smaller than a cell of '
    '{cell:g} m.'
)


def write_page(
    layout: LampLayout, handover: LampHandover, again: str, scene: str, next_step: str, out: Path
) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(layout, handover, again, scene, next_step), out)


def render_page(
    layout: LampLayout, handover: LampHandover, again: str, scene: str, next_step: str
) -> str:
    """Return the HTML of the page; `again` and `next_step` are commands, `scene` is a file."""
    plan, gaps = layout.plan, find_gaps(layout)
    return assemble_page(
        'light_plan.html',
        title=escape(format_headline(layout)),
        kicker=escape(f'light plan · {plan.name}'),
        about=escape(plan.about),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(layout, handover)),
        height=f'{picture_height(layout):.0f}',
        pictures=render_section(
            'coverage', 'Coverage at flight altitude', COVERED, plot_coverage(layout),
        )
        + render_section(
            'handover', 'Hand-overs and a route', HANDED, plot_handovers(layout, handover),
        ),
        lamps=render_lamps(layout, handover),
        law=escape(describe_separation(layout)),
        gaps=render_gaps(gaps),
        method=escape(
            METHOD.format(
                needed=layout.ear.required_snr, margin=layout.ear.margin, pure=PURE,
                cell=layout.floor.cell,
            )
        ),
        facts=build_provenance_table(layout),
        commands={'Repeat the plan': again, 'Fly in it': next_step},
        files={'The scenario file': scene},
    )  # fmt: skip


def format_headline(layout: LampLayout) -> str:
    """Return the headline."""
    count, where = len(layout.lamps), layout.plan.name.replace('_', ' ')
    number = 'at least one' if layout.overlap == 1 else f'at least {layout.overlap}'
    return (
        f'{count} lamp{"s" if count > 1 else ""}: at any heading, a drone receives {number} '
        f'over {format_percent(layout.coverage)} % of the floor of {where}.'
    )


def format_percent(share: float) -> str:
    """Format a share in percent, rounded down so that 100 means complete."""
    return '100' if share == 1.0 else f'{math.floor(1000.0 * share) / 10.0:g}'


def build_tiles(layout: LampLayout, handover: LampHandover) -> list[Tile]:
    """Return the tiles of the layout."""
    count, floor = len(layout.lamps), layout.floor
    wanted = float(floor.wanted.sum()) * floor.cell**2
    # The best lamp in each cell, then the worst cell
    weakest = float(layout.snr.max(axis=0).min())
    two = format_percent(float((layout.received_count >= 2).mean()))
    tones = [lamp.frequency for lamp in layout.lamps]
    steps = len(handover.route)
    return [
        Tile('covered', format_percent(layout.coverage), '%', f'of {wanted:.0f} m² where the hull '
        f'fits'),
        Tile('lamps', str(count), '', f'at least {layout.bound} for full coverage'),
        Tile(
            'lamps by area', f'{100.0 * count / floor.area:.2f}', 'per 100 m²',
            f'one for {floor.area / max(count, 1):.0f} m²; paper: one for {PAPER:g} m²',
        ),
        Tile('two lamps received', two, '%', 'of the same area, which allows a hand-over'),
        Tile(
            'weakest spot', f'{weakest:.0f}', 'SNR',
            f'{layout.ear.required_snr:g} is required',
        ),
        Tile(
            'frequencies', f'{min(tones):g} to {max(tones):g}', 'Hz',
            f'{len(handover.edges)} hand-overs; the route passes {steps} lamps',
        ),
    ]  # fmt: skip


def picture_height(layout: LampLayout) -> float:
    """Return the height of a plot of the floor on a desktop. [px]"""
    corners = layout.plan.outline.corners
    across, up = corners.max(axis=0) - corners.min(axis=0)
    # 60 px for the axis below the plot
    return min(max(float(up / across) * WIDTH + 60.0, HEIGHTS[0]), HEIGHTS[1])


def render_lamps(layout: LampLayout, handover: LampHandover) -> str:
    """Return the table of the lamps."""
    heads = ('x [m]', 'y [m]', 'z [m]', 'frequency [Hz]', 'received over [m²]')
    names = [lamp.name for lamp in layout.lamps]
    lines = []
    for k, lamp in enumerate(layout.lamps):
        area = float(layout.is_received[k].sum()) * layout.floor.cell**2
        numbers = [*(f'{part:.1f}' for part in lamp.mount.position), f'{lamp.frequency:g}']
        cells = ''.join(f'<td>{cell}</td>' for cell in (*numbers, f'{area:.0f}'))
        # Lamps are numbered from 1, as in the plots.
        others = [str(j + 1) for i, j in handover.edges if i == k]
        to = ', '.join(others) or MISSING
        there = ', existing' if lamp.mount.name else ''
        words = (format_facing(lamp.mount.axis) + there, to)
        cells += ''.join(f'<td class="text">{escape(word)}</td>' for word in words)
        lines.append(f'<tr><th scope="row"><b>{k + 1}</b> {escape(names[k])}</th>{cells}</tr>')
    own = ''.join(f'<th scope="col">{head}</th>' for head in ('lamp', *heads))
    own += ''.join(f'<th scope="col" class="text">{w}</th>' for w in ('faces', 'hands over to'))
    return (
        '<table class="lamps"><caption class="hidden">The lamps</caption>'
        f'<thead><tr>{own}</tr></thead><tbody>{"".join(lines)}</tbody></table>'
    )


def format_facing(axis: tuple[float, float, float]) -> str:
    """Format the direction of a lamp."""
    if abs(axis[2]) > 0.9:
        return 'down' if axis[2] < 0.0 else 'up'
    return f'{math.degrees(math.atan2(axis[1], axis[0])) % 360.0:.0f}°'


def describe_separation(layout: LampLayout) -> str:
    """Describe the separation of the frequencies."""
    ear = layout.ear
    width = ear.light.sample_rate.si / ear.light.samples
    half = ear.demodulation.window * width
    return (
        'Directions are anticlockwise from x. Every frequency is at the centre of a bin of '
        f'{width:g} Hz, more than {2 * half:g} Hz from every other and more than {half:g} Hz '
        f'from every multiple of {layout.plan.ambient.mains_frequency.si:g} Hz (mains). No '
        f'harmonic of a lamp up to the {layout.order}th, aliased by the '
        f'{ear.light.sample_rate.si:g} samples/s, is in the search window of another lamp.'
    )


def render_gaps(gaps: Sequence[CoverageGap]) -> str:
    """Return the table of the gaps, or a note that there are none."""
    if not gaps:
        return '<p class="note">None: the whole floor where the hull fits is covered.</p>'
    heads = ''.join(f'<th scope="col">{h}</th>' for h in ('gap', 'area [m²]', 'x [m]', 'y [m]'))
    lines = ''.join(
        f'<tr><th scope="row">{k}</th><td>{gap.area:.2f}</td>'
        f'<td>{gap.west:.1f} to {gap.east:.1f}</td><td>{gap.south:.1f} to {gap.north:.1f}</td>'
        f'<td class="text">{escape(gap.why)}</td></tr>'
        for k, gap in enumerate(gaps[:MOST_GAPS], start=1)
    )
    more = len(gaps) - MOST_GAPS
    rest = f'<p class="note">and {more} smaller ones, in plan.json.</p>' if more > 0 else ''
    return (
        '<table class="lamps"><caption class="hidden">The gaps</caption><thead><tr>'
        f'{heads}<th scope="col" class="text">why</th></tr></thead><tbody>{lines}</tbody></table>'
        + rest
    )


def build_provenance_table(layout: LampLayout) -> dict[str, str]:
    """Return the provenance table of the page."""
    plan, lamp = layout.plan, layout.plan.lamp
    angle = math.degrees(lamp.half_power.si)
    return {
        'vehicle': f'{layout.ear.vehicle.file.name}, hull centre at {plan.altitude.si:g} m',
        'lamps': f'{lamp.flux.si:g} lm, half-power angle {angle:g}°, at {lamp.height.si:g} m, '
        f'facing {lamp.facing}; {layout.places} candidate positions',
        'ambient light': f'{plan.ambient.steady.si:g} lx steady, mains flicker of '
        f'{plan.ambient.mains_amplitude.si:g} lx at {plan.ambient.mains_frequency.si:g} Hz',
        'light needed': f'{layout.least:.2g} lx on the diode, from a single lamp',
        'cells': f'{layout.floor.cell:g} m',
        'commit': read_commit(),
    }
