"""What the flight costs."""

from lta_flight.report.over_time import over_time
from lta_flight.report.view import View
from lta_report.drawing import extent, Label, label_ends, line
from lta_report.palette import ESTIMATE, GOOD
import numpy as np
from plotly.graph_objects import Figure
from scipy.integrate import cumulative_trapezoid


def picture(view: View) -> Figure:
    """Return power out of the cell and from the panel, and the energy taken out so far."""
    figure = over_time(view, 2)
    time, voltage, current = view.battery
    power = -voltage * current
    figure.add_trace(line('cell', time, power, ESTIMATE, unit='W'), row=1, col=1)
    labels = [Label('out of cell', power[-1], ESTIMATE)]
    shown = [power, np.zeros(1)]
    if view.has('panel'):
        when, volts, amperes = view.panel
        figure.add_trace(line('panel', when, volts * amperes, GOOD, unit='W'), row=1, col=1)
        labels.append(Label('from panel', float(volts[-1] * amperes[-1]), GOOD))
        shown.append(volts * amperes)
    energy = cumulative_trapezoid(power, time, initial=0)
    figure.add_trace(line('energy', time, energy, ESTIMATE, unit='J'), row=2, col=1)
    figure.update_yaxes(title_text='power [W]', row=1)
    figure.update_yaxes(title_text='energy [J]', row=2)
    label_ends(figure, labels, extent(*shown))
    label_ends(
        figure, [Label(f'{energy[-1]:.1f} J in all', energy[-1], ESTIMATE)], extent(energy), 2
    )
    return figure
