"""Write the link budget as one self-contained HTML page."""

from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_config.command_line import format_lta_command
from lta_report.drawing import create_figure
from lta_report.formatting import Tile
from lta_report.html_elements import render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, SOFT, TRUTH, WALL
from lta_studies.light.link.link_budget import LampLink, LinkPoint
from plotly.graph_objects import Figure, Scatter

COLOURS: Final = (TRUTH, ESTIMATE, GOOD, LAMP, SETPOINT)
PAPER_DISTANCE: Final = 7.0  # m
PAPER_LUX: Final = (20.0, 90.0)  # range read from "several tens of lux"
NEEDED: Final = 10.0  # required SNR at that distance
LUX: Final = (
    'Solid: light measured by the brightest diode while the lamp is on, including its '
    'angular response and reflections. Dotted: direct light on a plane that faces the lamp. '
    'Grey bar: the "several tens of lux" at 7 m of the paper (Huang et al. 2025).'
)
SNR: Final = (
    'SNR of the best diode after demodulation: median of several blocks of samples with '
    'different gains, noise and heading. Dotted: an SNR of 10.'
)
METHOD: Final = (
    'The drone is level and faces the lamp within 22.5 degrees. The light falls with the '
    'square of the distance, the surfaces of the scene reflect it, and the hull shades the '
    'diodes below it.'
)


def write_page(links: Sequence[LampLink], again: str, vehicle: str, out: Path) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(links, again, vehicle), out)


def render_page(links: Sequence[LampLink], again: str, vehicle: str) -> str:
    """Return the HTML of the page; `again` is the command that repeats it."""
    first = links[0].scenario
    return assemble_page(
        'light_link.html',
        title=escape(format_headline(links)),
        kicker=escape(f'light link · {vehicle}'),
        about='Illuminance and signal-to-noise ratio of a lamp against the distance from it.',
        tiles='\n'.join(render_tile(*each) for each in build_tiles(links)),
        lux=render_section('lux', 'Light on the diodes', LUX, plot_lux(links)),
        snr=render_section('snr', 'Signal-to-noise ratio', SNR, plot_snr(links)),
        table=''.join(render_link_table(each) for each in links),
        method=escape(METHOD),
        facts={'vehicle': vehicle, 'commit': read_commit()},
        commands={
            'Repeat the study': again,
            'Fly in the first scenario': format_lta_command('simulate', '--scenario', first),
        },
    )  # fmt: skip


def find_reference_point(link: LampLink) -> LinkPoint:
    """Return the point nearest to the paper's distance."""
    return min(link.at, key=lambda at: abs(at.distance - PAPER_DISTANCE))


def format_headline(links: Sequence[LampLink]) -> str:
    """Return the headline."""
    values = [f'{find_reference_point(each).snr:.0f} in {each.scenario}' for each in links]
    distances = {f'{find_reference_point(each).distance:g}' for each in links}
    return f'At {"/".join(sorted(distances))} m the SNR is {", ".join(values)}.'


def build_tiles(links: Sequence[LampLink]) -> list[Tile]:
    """Return tiles with light and SNR of each scene at the paper's distance."""
    made = []
    for each in links:
        at = find_reference_point(each)
        note = f'direct light at {at.distance:g} m; paper: several tens of lx'
        made.append(Tile(each.scenario, f'{at.lux:.0f}', 'lx', note))
        made.append(Tile(each.scenario, f'{at.snr:.0f}', '', f'SNR at {at.distance:g} m'))
    return made


def plot_lux(links: Sequence[LampLink]) -> Figure:
    """Plot light against distance."""
    figure = plot_links(links, lambda at: at.read, '%{y:.3g} lx')
    for k, link in enumerate(links):
        figure.add_trace(
            Scatter(
                x=[at.distance for at in link.at], y=[at.lux for at in link.at], mode='lines',
                name=f'{link.scenario}, direct', hovertemplate='%{y:.3g} lx direct',
                line={'color': COLOURS[k % len(COLOURS)], 'width': 1.2, 'dash': 'dot'},
            )
        )  # fmt: skip
    figure.add_shape(
        type='line', x0=PAPER_DISTANCE, x1=PAPER_DISTANCE, y0=PAPER_LUX[0], y1=PAPER_LUX[1],
        line={'color': WALL, 'width': 8}, layer='below',
    )  # fmt: skip
    figure.update_yaxes(title_text='light [lx]')
    return figure


def plot_snr(links: Sequence[LampLink]) -> Figure:
    """Plot SNR against distance."""
    figure = plot_links(links, lambda at: at.snr, 'SNR %{y:.3g}')
    figure.add_shape(
        type='line', x0=0.0, x1=1.0, xref='paper', y0=NEEDED, y1=NEEDED, layer='below',
        line={'color': SOFT, 'width': 1, 'dash': '2px,3px'},
    )  # fmt: skip
    figure.update_yaxes(title_text='SNR')
    return figure


def plot_links(
    links: Sequence[LampLink], figure_of: Callable[[LinkPoint], float], words: str
) -> Figure:
    """Plot one line per scene on logarithmic axes."""
    figure = create_figure()
    for k, link in enumerate(links):
        figure.add_trace(
            Scatter(
                x=[at.distance for at in link.at], y=[figure_of(at) for at in link.at],
                mode='lines+markers', name=link.scenario, hovertemplate=words,
                line={'color': COLOURS[k % len(COLOURS)], 'width': 1.6}, showlegend=True,
            )
        )  # fmt: skip
    # A small scene has fewer distances; take the ticks from the one with the most.
    ticks = [at.distance for at in max(links, key=lambda link: len(link.at)).at]
    figure.update_xaxes(
        type='log', title_text='distance from the lamp [m]', tickvals=ticks,
        ticktext=[f'{each:g}' for each in ticks],
    )  # fmt: skip
    figure.update_yaxes(type='log', dtick=1)
    figure.update_layout(showlegend=True, legend={'orientation': 'h', 'y': 1.08})
    return figure


HEADS: Final = ('distance [m]', 'direct [lx]', 'read [lx]', 'echo [lx]', 'steady [lx]', 'SNR')


def format_link_row(at: LinkPoint) -> list[str]:
    """Format one row of the table."""
    snr = f'{at.snr:.1f}' + (' clipped' if at.clipped else '')
    numbers = (at.lux, at.read, at.echo, at.steady)
    return [f'{at.distance:g}', *(f'{number:.1f}' for number in numbers), snr]


def render_link_table(link: LampLink) -> str:
    """Return the HTML table of one scene."""
    head = ''.join(f'<th scope="col">{each}</th>' for each in HEADS)
    rows = []
    for at in link.at:
        first, *rest = format_link_row(at)
        own = ''.join(f'<td>{escape(cell)}</td>' for cell in rest)
        rows.append(f'<tr><th scope="row">{escape(first)}</th>{own}</tr>')
    caption = f'{link.scenario}, feedback resistor of {link.feedback / 1e3:g} kohm'
    return (
        f'<h3>{escape(caption)}</h3><p class="note">{escape(link.about)}</p><table>'
        f'<caption class="hidden">{escape(caption)}</caption>'
        f'<thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table>'
    )
