"""Build the report of the link budget."""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Final

from lta_config.command_line import format_lta_command
from lta_report.drawing import add_legend, create_figure
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, SOFT, TRUTH, WALL
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_studies.light.link.link_budget import LampLink, LinkPoint
from plotly.graph_objects import Figure, Scatter

HEADS: Final = ('distance [m]', 'direct [lx]', 'read [lx]', 'echo [lx]', 'steady [lx]', 'SNR')
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
PAPER: Final = (
    'For comparison: the seed paper reports several tens of lux at 7 m from the lamp, and a high '
    'SNR.'
)


def build_report(links: Sequence[LampLink], vehicle: str, altitude: float) -> Report:
    """Return the report of a link budget."""
    return Report(
        command='light link',
        subject=vehicle,
        headline=format_headline(links),
        introduction='Illuminance and signal-to-noise ratio of a lamp against the distance from '
        'it.',
        tiles=build_tiles(links),
        blocks=(
            Picture('lux', 'Light on the diodes', LUX, plot_lux(links)),
            Picture('snr', 'Signal-to-noise ratio', SNR, plot_snr(links)),
            *map(build_link_table, links),
            TextSection('Method', (METHOD,)),
        ),
        data={
            'vehicle': vehicle, 'altitude': altitude, 'links': [asdict(each) for each in links],
        },
        facts={'vehicle': vehicle},
        commands={
            'Fly in the first scenario': format_lta_command(
                'simulate', '--scenario', links[0].scenario
            ),
        },
        closing=(PAPER,),
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
    tiles = []
    for each in links:
        at = find_reference_point(each)
        note = f'direct light at {at.distance:g} m; paper: several tens of lx'
        tiles.append(Tile(each.scenario, f'{at.lux:.0f}', 'lx', note))
        tiles.append(Tile(each.scenario, f'{at.snr:.0f}', '', f'SNR at {at.distance:g} m'))
    return tiles


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
    add_legend(figure)
    return figure


def build_link_table(link: LampLink) -> TextTable:
    """Return the table of one scene by distance."""
    rows = [
        [
            f'{at.distance:g}',
            *(f'{number:.1f}' for number in (at.lux, at.read, at.echo, at.steady)),
            f'{at.snr:.1f}' + (' clipped' if at.clipped else ''),
        ]
        for at in link.at
    ]
    heading = f'{link.scenario}, feedback resistor of {link.feedback / 1e3:g} kohm'
    return TextTable(heading, HEADS, rows, link.about)
