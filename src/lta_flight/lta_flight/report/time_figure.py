"""Figures over the time of a flight, with marks at its phases."""

from collections.abc import Sequence

from lta_flight.report.results import find_phases
from lta_flight.report.view import FlightView
from lta_report.drawing import create_figure
from lta_report.palette import SOFT, WALL
from plotly.graph_objects import Figure


def create_time_figure(
    view: FlightView, rows: int = 1, heights: Sequence[float] | None = None
) -> Figure:
    """Return an empty figure over the time of the flight, with its phases marked."""
    figure = create_figure(rows, heights)
    figure.update_xaxes(range=list(view.span), hoverformat='.2f', unifiedhovertitle_text='%{x} s')
    figure.update_xaxes(title_text='time [s]', row=rows)
    phases = find_phases(view)
    marks = (
        (phases.lift_off, 'lift-off', 'right'),
        (phases.search, 'search', 'left'),
        (phases.end, 'at the lamp', 'right'),
    )
    # False for NaN, a phase that never began
    visible = [mark for mark in marks if view.span[0] < mark[0] < view.span[1]]
    # All at once: to add one, plotly copies those that are there
    return figure.update_layout(
        shapes=[
            {
                'type': 'line', 'x0': time, 'x1': time, 'y0': 0.0, 'y1': 1.0,
                'yref': 'paper', 'layer': 'below',
                'line': {'color': WALL, 'width': 1, 'dash': '2px,3px'},
            }
            for time, _, _ in visible
        ],
        annotations=[
            {
                'x': time, 'y': 1.0, 'yref': 'paper', 'yanchor': 'bottom', 'text': text,
                'xanchor': side, 'font': {'size': 10, 'color': SOFT},
            }
            for time, text, side in visible
        ],
    )  # fmt: skip
