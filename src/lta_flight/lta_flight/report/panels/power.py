"""Plot power and energy."""

from lta_flight.report.time_figure import create_time_figure
from lta_flight.report.view import FlightView
from lta_report.drawing import build_line_trace, EndLabel, label_ends, padded_range
from lta_report.palette import ESTIMATE, GOOD
import numpy as np
from plotly.graph_objects import Figure


def plot_power(view: FlightView) -> Figure:
    """Return a figure of battery power, panel power, and energy drawn from the battery."""
    figure = create_time_figure(view, 2)
    time, voltage, current = view.battery
    power = -voltage * current
    figure.add_trace(build_line_trace('cell', time, power, ESTIMATE, unit='W'), row=1, col=1)
    labels = [EndLabel('out of cell', power[-1], ESTIMATE)]
    # The axis always includes zero
    curves = [power, np.zeros(1)]
    if view.has_topics('panel'):
        when, volts, amperes = view.panel
        figure.add_trace(
            build_line_trace('panel', when, volts * amperes, GOOD, unit='W'), row=1, col=1
        )
        labels.append(EndLabel('from panel', float(volts[-1] * amperes[-1]), GOOD))
        curves.append(volts * amperes)
    # By the trapezoidal rule, from 0 J; scipy would take a tenth of a second to import
    steps = np.diff(time) * (power[1:] + power[:-1]) / 2.0
    energy = np.concatenate([[0.0], np.cumsum(steps)])
    figure.add_trace(build_line_trace('energy', time, energy, ESTIMATE, unit='J'), row=2, col=1)
    figure.update_yaxes(title_text='power [W]', row=1)
    figure.update_yaxes(title_text='energy [J]', row=2)
    label_ends(figure, labels, padded_range(*curves))
    label_ends(
        figure,
        [EndLabel(f'{energy[-1]:.1f} J in all', energy[-1], ESTIMATE)],
        padded_range(energy),
        2,
    )
    return figure
