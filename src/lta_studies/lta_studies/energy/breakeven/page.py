"""The break-even map as one self-contained page."""

from collections.abc import Mapping
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_energy.breakeven import LAMPS
from lta_report.drawing import blank
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.palette import ESTIMATE, GOOD, LAMP, TRUTH, WALL
from lta_report.pieces import section, tile_html
from lta_studies.energy.breakeven.study import Map, table, told
from lta_studies.energy.tables import table_html
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


def write_page(found: Map, commands: Mapping[str, str], out: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(found, commands), out)


def page(found: Map, commands: Mapping[str, str]) -> str:
    """Return the whole page."""
    return framed(
        'energy.html',
        title=escape(title(found)),
        kicker=escape(f'energy breakeven · {found.vehicle}'),
        about=ABOUT,
        tiles='\n'.join(tile_html(*each) for each in tiles(found)),
        first=section('income', 'What the light brings', OWN, picture(found)),
        pictures='',
        tables=table_html(table(found)),
        method=''.join(f'<p class="note">{escape(each)}</p>' for each in METHOD),
        facts={'vehicle': found.vehicle, 'commit': commit()},
        commands=commands,
    )


def title(found: Map) -> str:
    """Return what came out, in a sentence."""
    lux = [found.lux(found.arrays[0], lamp, found.loads['idle']) for lamp in LAMPS]
    return (
        f'{found.vehicle} idles for ever at {told(lux[0])} klx of white LED, '
        f'{told(lux[1])} klx of a flickering one, {told(lux[2])} klx of sun.'
    )


def tiles(found: Map) -> list[Tile]:
    """Return where the vehicle as it is breaks even in the sun."""
    made = []
    for task, load in found.loads.items():
        lux = found.lux(found.arrays[0], 'sun', load)
        made.append(Tile(task, told(lux), 'klx', f'of sun for {1e3 * load:.0f} mW'))
    return made


def picture(found: Map) -> Figure:
    """Return income against illuminance, with the tasks."""
    figure = blank()
    for colour, lamp in zip(COLOURS, LAMPS, strict=False):
        lux, watts = found.incomes(found.arrays[0], lamp)
        figure.add_trace(
            Scatter(
                x=lux, y=[1e3 * each if each > 0.0 else None for each in watts], name=lamp,
                mode='lines', line={'color': colour, 'width': 1.6}, showlegend=True,
                hovertemplate='%{y:.0f} mW',
            )
        )  # fmt: skip
    for task, load in found.loads.items():
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
