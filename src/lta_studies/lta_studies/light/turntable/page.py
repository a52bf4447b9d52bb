"""The polar study of a real board as one self-contained page, in the look of the simulated one."""

from collections.abc import Mapping
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_report.drawing import blank
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.palette import ESTIMATE, GRID, SETPOINT, SOFT, TIME, TRUTH
from lta_report.pieces import section, tile_html
from lta_studies.light.bearing.page import degrees, table_html
from lta_studies.light.bearing.study import CLAIMS, counted, DIRECTIONS, directions, Studied
from lta_studies.light.bearing.study_page import median, rows
from lta_studies.light.turntable.response import Response
from lta_studies.light.turntable.turntable import Readings
from lta_vlc.diodes import Diodes
import numpy as np
from plotly.graph_objects import Figure, Scatter, Scatterpolar

POLAR: Final = (
    'Direction: where the lamp truly was, counter-clockwise from the nose. Radius: the median '
    "error there. Blue is the fit, orange the paper's weighted mean."
)
CURVE: Final = (
    'Each dot is one diode in one direction: what it read, over its gain and the strength of the '
    'lamp. The line is the response that fits best; the vehicle file takes its exponent.'
)
METHOD: Final = (
    'A real board on a turntable. The truth is the angle of the table, the zero of which is where '
    'the nose pointed at the lamp: an error of that zero is the same in all directions, and is '
    'told apart. Each reading is one light block of 100 ms. Response and gains are fitted over '
    'all directions, their deviations by leaving out one direction after the other.'
)
POINTS: Final = 91


def write_page(
    found: Studied,
    readings: Readings,
    fitted: Response,
    diodes: Diodes,
    facts: Mapping[str, str],
    again: str,
    out: Path,
) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(
        framed(
            'study.html',
            title=escape(
                f'On the turntable the fit finds the lamp to {degrees(median(found.ours))}°, '
                f"the paper's weighted mean to {degrees(median(found.paper))}°."
            ),
            kicker='hardware · light board on a turntable',
            about=escape(
                f'{found.count} diodes, {DIRECTIONS} directions, {len(readings.direction)} light '
                'blocks.'
            ),
            tiles='\n'.join(tile_html(*each) for each in tiles(found, fitted)),
            table=table_html(rows([found])) + table_html(gain_rows(fitted)),
            claims=table_html(claims(found)),
            notes=f'<p class="note">{escape(METHOD)}</p>',
            pictures='\n'.join([
                section('polar', 'Error by direction', POLAR, polar(found)),
                section('curve', 'What a diode makes of the angle', CURVE,
                        curve(readings, fitted, diodes)),
            ]),
            facts=facts,
            commands={'Find it again': again},
        ),
        out,
    )  # fmt: skip


def claims(found: Studied) -> list[tuple[str, ...]]:
    """Return what the paper says of a ring of so many diodes, counted; its first row the head."""
    told: list[tuple[str, ...]] = [('the paper, indoors', 'its estimator', 'the fit')]
    told += [counted(claim, found) for claim in CLAIMS if claim.count == found.count]
    return told


def gain_rows(fitted: Response) -> list[tuple[str, ...]]:
    """Return the gain of each diode as text, its first row the head."""
    told: list[tuple[str, ...]] = [('diode', 'gain', 'standard deviation')]
    told += [
        (str(k), f'{gain:.3f}', f'{deviation:.3f}')
        for k, (gain, deviation) in enumerate(
            zip(fitted.gains, fitted.gain_deviations, strict=True), start=1
        )
    ]
    return told


def tiles(found: Studied, fitted: Response) -> list[Tile]:
    """Return the figures that matter most."""
    return [
        Tile('fit', degrees(median(found.ours)), '°', f'worst {degrees(max(found.ours))}°'),
        Tile('paper', degrees(median(found.paper)), '°', f'worst {degrees(max(found.paper))}°'),
        Tile('SNR', f'{found.snr:.0f}', '', 'of the best diode, median'),
        Tile('exponent', f'{fitted.exponent:.2f}', '',
             f'of the cosine, \N{PLUS-MINUS SIGN} {fitted.exponent_deviation:.1g}'),
        Tile('gains', f'{1e2 * fitted.spread:.1f}', '%', 'spread among the diodes'),
        Tile('pedestal', f'{1e2 * fitted.pedestal:.1f}', '%', 'of what faces the lamp: echo'),
    ]  # fmt: skip


def polar(found: Studied) -> Figure:
    """Return the error around the board, the first direction again at the end."""
    figure = blank()
    around = [*np.degrees(directions()), 360.0]
    for name, errors, colour in (('paper', found.paper, ESTIMATE), ('fit', found.ours, TRUTH)):
        figure.add_trace(
            Scatterpolar(
                theta=around, r=np.degrees([*errors, errors[0]]), mode='lines+markers', name=name,
                line={'color': colour, 'width': 1.6}, marker={'size': 6, 'color': colour},
                hovertemplate='%{theta}°: %{r:.2f}°',
            )
        )  # fmt: skip
    look = {'gridcolor': GRID, 'linecolor': GRID, 'tickfont': {'color': SOFT, 'size': 11}}
    return figure.update_layout(
        polar={
            'bgcolor': 'rgba(0,0,0,0)',
            'angularaxis': {**look, 'dtick': 45, 'rotation': 90},  # the nose up, as on a map
            'radialaxis': {**look, 'ticksuffix': '°', 'angle': 22.5, 'rangemode': 'tozero'},
        },
        xaxis={'visible': False}, yaxis={'visible': False}, margin={'t': 40, 'b': 30},
        showlegend=True, legend={'orientation': 'h', 'y': 1.12}, hovermode='closest',
    )  # fmt: skip


def curve(readings: Readings, fitted: Response, diodes: Diodes) -> Figure:
    """Return what each diode read against the angle between its axis and the lamp."""
    figure = blank()
    axes = np.array(diodes.axes)
    azimuth = np.arctan2(axes[:, 1], axes[:, 0])
    apart = np.degrees(np.abs(
        (readings.direction[:, None] - azimuth + math.pi) % math.tau - math.pi
    ))  # fmt: skip
    read = readings.amplitude / (np.array(fitted.gains) * fitted.strength)
    for k in range(len(azimuth)):
        figure.add_trace(
            Scatter(
                x=apart[:, k], y=read[:, k], mode='markers', name=f'diode {k + 1}',
                marker={'size': 4, 'color': TIME[k % len(TIME)]}, hovertemplate='%{y:.3f}',
            )
        )  # fmt: skip
    angle = np.linspace(0.0, 180.0, POINTS)
    cosine = np.maximum(np.cos(np.radians(angle)), 0.0)
    figure.add_trace(
        Scatter(
            x=angle, y=cosine**fitted.exponent + fitted.pedestal, mode='lines', name='fit',
            line={'color': SETPOINT, 'width': 1.4}, hovertemplate='%{y:.3f}',
        )
    )  # fmt: skip
    figure.update_xaxes(title_text="from the diode's axis to the lamp [°]", dtick=30)
    figure.update_yaxes(title_text='reading, facing the lamp 1', rangemode='tozero')
    return figure.update_layout(hovermode='closest')
