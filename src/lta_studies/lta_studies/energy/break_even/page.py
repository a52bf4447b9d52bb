"""The break-even map as one self-contained page."""

from collections.abc import Mapping
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_energy.break_even import LAMPS
from lta_report.drawing import create_figure
from lta_report.formatting import Tile
from lta_report.page_frame import assemble_page, write_file
from lta_report.page_parts import render_section, render_tile
from lta_report.palette import ESTIMATE, GOOD, LAMP, TRUTH, WALL
from lta_studies.energy.break_even.study import BreakEvenMap, build_table, format_klux
from lta_studies.energy.tables import render_text_table
from plotly.graph_objects import Figure, Scatter

COLOURS: Final = (TRUTH, ESTIMATE, LAMP, GOOD)
ABOUT: Final = 'From a warehouse of 300 lx to the sun: what array and charger give, and to whom.'
OWN: Final = (
    'What the charger gives from the array as it is, by kind of light. Dotted: what the tasks '
    'draw. Below some light the charger costs more than it brings, and is off.'
)
METHOD: Final = (
    'Single-diode model of each panel, one string a panel, cells warmed by the light; charger as '
    'in the vehicle file. An array has as many panels as the weight budget carries, at least one.',
    'Lumens a radiant watt: white LED 300, sun 110. The spectral answer of a cell is taken as '
    "that to sunlight: in a white LED's light a silicon cell would do a little better.",
    'Hover and flight are what the paper measured; lta energy budget has what flights here draw.',
)


def write_page(result: BreakEvenMap, commands: Mapping[str, str], out: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return write_file(render_page(result, commands), out)


def render_page(result: BreakEvenMap, commands: Mapping[str, str]) -> str:
    """Return the whole page."""
    return assemble_page(
        'energy.html',
        title=escape(format_title(result)),
        kicker=escape(f'energy breakeven · {result.vehicle}'),
        about=ABOUT,
        tiles='\n'.join(render_tile(*each) for each in build_tiles(result)),
        first=render_section('income', 'What the light brings', OWN, draw_income(result)),
        pictures='',
        tables=render_text_table(build_table(result)),
        method=''.join(f'<p class="note">{escape(each)}</p>' for each in METHOD),
        facts={'vehicle': result.vehicle, 'commit': read_commit()},
        commands=commands,
    )


def format_title(result: BreakEvenMap) -> str:
    """Return what came out, in a sentence."""
    lux = [result.break_even_lux(result.arrays[0], lamp, result.loads['idle']) for lamp in LAMPS]
    return (
        f'{result.vehicle} idles for ever at {format_klux(lux[0])} klx of white LED, '
        f'{format_klux(lux[1])} klx of a flickering one, {format_klux(lux[2])} klx of sun.'
    )


def build_tiles(result: BreakEvenMap) -> list[Tile]:
    """Return where the vehicle as it is breaks even in the sun."""
    made = []
    for task, load in result.loads.items():
        lux = result.break_even_lux(result.arrays[0], 'sun', load)
        made.append(Tile(task, format_klux(lux), 'klx', f'of sun for {1e3 * load:.0f} mW'))
    return made


def draw_income(result: BreakEvenMap) -> Figure:
    """Return income against illuminance, with the tasks."""
    figure = create_figure()
    for colour, lamp in zip(COLOURS, LAMPS, strict=False):
        lux, watts = result.sample_income(result.arrays[0], lamp)
        figure.add_trace(
            Scatter(
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
            x=1.0, xref='paper', y=math.log10(1e3 * load), text=task, xanchor='right',
            yanchor='top' if task.startswith(('idle', 'hovering')) else 'bottom',
        )  # fmt: skip
    ticks = [300, 1000, 3000, 10_000, 30_000, 100_000]
    figure.update_xaxes(
        type='log', title_text='illuminance of the level panel', tickvals=ticks,
        ticktext=['300 lx', '1 klx', '3 klx', '10 klx', '30 klx', '100 klx'],
    )  # fmt: skip
    figure.update_yaxes(type='log', title_text='behind the charger [mW]', dtick=1)
    figure.update_layout(showlegend=True, legend={'orientation': 'h', 'y': 1.1})
    return figure
