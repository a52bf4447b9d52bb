"""Write the break-even map as one self-contained HTML page."""

from collections.abc import Mapping
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_energy.break_even_illuminance import LAMPS
from lta_report.drawing import create_figure
from lta_report.formatting import Tile
from lta_report.html_elements import render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_report.palette import ESTIMATE, GOOD, LAMP, TRUTH, WALL
from lta_studies.energy.break_even.study import BreakEvenMap, build_illuminance_table, format_klux
from lta_studies.energy.tables import render_text_table
from plotly.graph_objects import Figure, Scatter

COLOURS: Final = (TRUTH, ESTIMATE, LAMP, GOOD)
ABOUT: Final = (
    'Power of the solar array and its charger, from 300 lx in a warehouse to full sun, '
    'compared with the power that each task needs.'
)
OWN: Final = (
    "Charger output with the vehicle's own array, for each kind of light. Dotted: power "
    'that each task needs. In weak light the charger is off, because it would use more '
    'power than it delivers.'
)
METHOD: Final = (
    'Each panel is a single-diode model, with one string per panel and cells warmed by the '
    'light. The charger is that of the vehicle file. An array has as many panels as the '
    'mass budget allows, at least one.',
    'Luminous efficacy: 300 lm/W for white LED light, 110 lm/W for sunlight. Each cell is '
    'assumed to respond to all light as it does to sunlight; under a white LED a silicon '
    'cell would give slightly more.',
    'The powers for hovering and flying are those of the paper (Huang et al. 2025); '
    '"lta energy budget" computes them from simulated flights.',
)


def write_page(result: BreakEvenMap, commands: Mapping[str, str], out: Path) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(result, commands), out)


def render_page(result: BreakEvenMap, commands: Mapping[str, str]) -> str:
    """Return the HTML of the page."""
    return assemble_page(
        'energy.html',
        title=escape(format_headline(result)),
        kicker=escape(f'energy breakeven · {result.vehicle}'),
        about=ABOUT,
        tiles='\n'.join(render_tile(*each) for each in build_tiles(result)),
        first=render_section('income', 'Power from the light', OWN, plot_charger_output(result)),
        pictures='',
        tables=render_text_table(build_illuminance_table(result)),
        method=''.join(f'<p class="note">{escape(each)}</p>' for each in METHOD),
        facts={'vehicle': result.vehicle, 'commit': read_commit()},
        commands=commands,
    )


def format_headline(result: BreakEvenMap) -> str:
    """Return the headline."""
    lux = [result.break_even_lux(result.arrays[0], lamp, result.loads['idle']) for lamp in LAMPS]
    return (
        f'{result.vehicle} can idle indefinitely at {format_klux(lux[0])} klx of steady '
        f'white LED light, {format_klux(lux[1])} klx of flickering white LED light, or '
        f'{format_klux(lux[2])} klx of sunlight.'
    )


def build_tiles(result: BreakEvenMap) -> list[Tile]:
    """Return tiles with the break-even illuminance in the sun."""
    made = []
    for task, load in result.loads.items():
        lux = result.break_even_lux(result.arrays[0], 'sun', load)
        made.append(
            Tile(
                task,
                format_klux(lux),
                'klx',
                f'of sunlight give the {1e3 * load:.0f} mW that it needs',
            )
        )
    return made


def plot_charger_output(result: BreakEvenMap) -> Figure:
    """Plot the charger output against illuminance, with the power of the tasks."""
    figure = create_figure()
    for colour, lamp in zip(COLOURS, LAMPS, strict=False):
        lux, watts = result.sample_charger_output(result.arrays[0], lamp)
        figure.add_trace(
            Scatter(
                # A logarithmic axis cannot show zero; None leaves a gap.
                x=lux, y=[1e3 * each if each > 0.0 else None for each in watts], name=lamp,
                mode='lines', line={'color': colour, 'width': 1.6}, showlegend=True,
                hovertemplate='%{y:.0f} mW',
            )
        )  # fmt: skip
    for task, load in result.loads.items():
        figure.add_shape(
            type='line', x0=0.0, x1=1.0, xref='paper', y0=1e3 * load, y1=1e3 * load,
            layer='below', line={'color': WALL, 'width': 1, 'dash': '2px,3px'},
        )  # fmt: skip
        figure.add_annotation(
            # On a logarithmic axis annotations take the exponent, while shapes take the value.
            x=1.0, xref='paper', y=math.log10(1e3 * load), text=task, xanchor='right',
            # The lower of two close lines is labelled below, the upper one above.
            yanchor='top' if task.startswith(('idle', 'hovering')) else 'bottom',
        )  # fmt: skip
    ticks = [300, 1000, 3000, 10_000, 30_000, 100_000]
    figure.update_xaxes(
        type='log', title_text='illuminance on the level panel', tickvals=ticks,
        ticktext=['300 lx', '1 klx', '3 klx', '10 klx', '30 klx', '100 klx'],
    )  # fmt: skip
    figure.update_yaxes(type='log', title_text='charger output [mW]', dtick=1)
    figure.update_layout(showlegend=True, legend={'orientation': 'h', 'y': 1.1})
    return figure
