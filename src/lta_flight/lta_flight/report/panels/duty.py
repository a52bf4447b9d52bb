"""Plot the commanded duty of each rotor."""

from lta_flight.report.time_figure import create_time_figure
from lta_flight.report.view import FlightView
from lta_report.drawing import decimate_line
from lta_report.palette import FILL, INK, TRUTH
import numpy as np
from plotly.graph_objects import Figure, Scatter


def plot_duty(view: FlightView) -> Figure:
    """Return a figure of the commanded duties with a row per rotor."""
    time, names, values = view.duties
    figure = create_time_figure(view, len(names))
    # Show negative duties only if a rotor has reversed
    low = -1.05 if values.min() < 0.0 else -0.03
    for row, name in enumerate(names, start=1):
        x, y = decimate_line(time, values[:, row - 1])
        figure.add_trace(
            Scatter(
                x=x, y=y, name=name, fill='tozeroy', fillcolor=FILL, mode='lines',
                line={'color': TRUTH, 'width': 1, 'shape': 'hv'}, hovertemplate='%{y:.2f}',
            ),
            row=row, col=1,
        )  # fmt: skip
        figure.update_yaxes(range=[low, 1.05], tickvals=[0, 1], row=row)
        figure.add_annotation(
            x=1.0, xref='x domain', y=0.5, yref='y domain', xanchor='left', xshift=6,
            # A line per word, because the margin is narrow
            align='left', text=name.replace('_', '<br>'), font={'color': INK, 'size': 11},
            row=row, col=1,
        )  # fmt: skip
    figure.update_yaxes(title_text='duty [1]', row=int(np.ceil(len(names) / 2)))
    return figure
