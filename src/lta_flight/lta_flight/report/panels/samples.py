"""Plot raw samples of the light."""

from lta_flight.report.sample_blocks import select_sample_blocks
from lta_flight.report.view import FlightView
from lta_report.drawing import create_figure, EndLabel, label_ends, padded_range
import numpy as np
from plotly.graph_objects import Figure, Scatter


def plot_samples(view: FlightView) -> Figure:
    """Return a figure of the brightest diode's samples in two blocks."""
    figure = create_figure(2)
    for row, moment in enumerate(select_sample_blocks(view), start=1):
        figure.add_trace(
            Scatter(
                x=(1e3 * moment.time).astype(np.float32),
                # ADC counts fit into 16 bits, which keeps the page small
                y=moment.samples.astype(np.uint16),
                mode='lines',
                line={'color': moment.colour, 'width': 1},
                name=moment.where,
                hovertemplate='%{y} counts',
            ),
            row=row,
            col=1,
        )
        label = EndLabel(moment.where, float(moment.samples.mean()), moment.colour)
        label_ends(figure, [label], padded_range(moment.samples), row)
        figure.update_yaxes(title_text='light [counts]', row=row)
    figure.update_xaxes(title_text='time since the start of the block [ms]', row=2)
    figure.update_xaxes(hoverformat='.1f', unifiedhovertitle_text='%{x} ms')
    return figure
