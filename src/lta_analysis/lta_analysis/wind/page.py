"""The flyable wind as one self-contained page: a table, and the limit against the roughness."""

from collections.abc import Sequence
from html import escape
from importlib.resources import files
import math
from pathlib import Path
from string import Template

from lta_analysis.report.drawing import blank, Label, label_ends
from lta_analysis.report.page import embedded, embedded_text
from lta_analysis.report.palette import (
    DARK,
    ESTIMATE,
    GOOD,
    LAMP,
    SETPOINT,
    SOFT,
    TIME,
    TRUTH,
    WALL,
)
from lta_analysis.wind.limits import Asked, Limits
from lta_config.errors import BadInput
from lta_sim import wind_limits
from lta_sim.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure, Scatter
from plotly.offline import get_plotlyjs

COLOURS = (TRUTH, ESTIMATE, GOOD, LAMP, SETPOINT, TIME[0], TIME[2], TIME[3])
PAPER_WINDS = ((8.0, 'paper: BAG converges'), (14.0, 'paper: all fail'))
ROUGHNESS = np.geomspace(1e-3, 0.45, 60)
CAPTION = (
    'Lines: the reference wind that thrust and balance allow at the hull, by the log law, '
    'averaged over the hull. Dots: flown in the closed loop. Between the elements of the '
    'roughness, towards the right, the log law is a surrogate only.'
)


def write_page(found: Sequence[Limits], asked: Asked, rows: list[list[str]], out: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    assets = files('lta_analysis.report') / 'assets'
    text = {
        n: (assets / n).read_text(encoding='utf-8') for n in ('wind.html', 'page.css', 'page.js')
    }
    page = Template(text['wind.html']).substitute(
        title='The wind that each platform can fly in',
        kicker=escape(f'wind · {asked.scenario} · hull at {asked.height:g} m'),
        table=table_html(rows),
        notes=''.join(
            f'<p class="note">{escape(f"{v.name}: {v.note}")}</p>' for v in found if v.note
        ),
        figure=embedded_text('figure-wind', picture(found, asked).to_json()),
        caption=escape(CAPTION),
        css=text['page.css'],
        dark=embedded('dark', DARK),
        plotly=get_plotlyjs(),
        js=text['page.js'],
    )
    try:
        out.write_text(page, encoding='utf-8')
    except OSError as error:
        raise BadInput(f"The page '{out}' cannot be written ({error.strerror}).") from error
    return out


def table_html(rows: list[list[str]]) -> str:
    """Return the table, its first row as head."""
    head, *body = rows
    cells = ''.join(f'<th scope="col">{escape(cell)}</th>' for cell in head)
    lines = ''.join(f'<tr>{"".join(f"<td>{escape(c)}</td>" for c in row)}</tr>' for row in body)
    return f'<table class="flights"><thead><tr>{cells}</tr></thead><tbody>{lines}</tbody></table>'


def picture(found: Sequence[Limits], asked: Asked) -> Figure:
    """Return the limit as reference wind against the roughness of the ground."""
    figure = blank()
    labels = []
    for limit, colour in zip(found, COLOURS, strict=False):
        if not 0.0 < limit.static < math.inf:
            continue
        wind = curve(limit, asked)
        labels.append(Label(limit.name, float(np.nan_to_num(wind[-1], nan=20.0)), colour))
        figure.add_trace(
            Scatter(
                x=ROUGHNESS, y=wind, mode='lines', name=limit.name,
                line={'color': colour, 'width': 1.6}, hovertemplate='%{y:.1f} m/s',
            )
        )  # fmt: skip
        flown = [(over.roughness, over.flown.wind) for over in limit.over if over.flown]
        if flown:
            figure.add_trace(
                Scatter(
                    x=[z for z, _ in flown], y=[wind for _, wind in flown], mode='markers',
                    name=f'{limit.name}, flown', marker={'color': colour, 'size': 8},
                    hovertemplate='%{y:.1f} m/s flown',
                )
            )  # fmt: skip
    for speed, text in PAPER_WINDS:
        figure.add_shape(
            type='line', x0=0.0, x1=1.0, xref='paper', y0=speed, y1=speed, layer='below',
            line={'color': WALL, 'width': 1, 'dash': '2px,3px'},
        )  # fmt: skip
        figure.add_annotation(
            x=0.0, xref='paper', y=speed, yanchor='bottom', xanchor='left',
            text=f'{speed:g} m/s, {text}', font={'size': 10, 'color': SOFT},
        )  # fmt: skip
    figure.update_xaxes(type='log', title_text='roughness of the ground [m]')
    figure.update_yaxes(title_text=f'wind at {asked.reference:g} m [m/s]')
    label_ends(figure, labels, (0.0, 20.0))
    return figure


def curve(limit: Limits, asked: Asked) -> NDArray[np.float64]:
    """Return the reference wind that a platform can stand against over each roughness. [m/s]"""
    vehicle = load_vehicle(limit.name)
    shares = [
        wind_limits.share_at_hull(vehicle, limit.height, asked.reference, float(z))
        for z in ROUGHNESS
    ]
    # Where the roughness reaches over the hull, the log law leaves no wind to speak of.
    return np.array([limit.static / share if share > 0.0 else math.nan for share in shares])
