"""Plot the altitude of the hull centre."""

from lta_flight.report.results import find_phases
from lta_flight.report.time_figure import create_time_figure
from lta_flight.report.view import FlightView
from lta_report.curves import hold_last
from lta_report.drawing import (
    build_dot_trace,
    build_line_trace,
    EndLabel,
    label_ends,
    padded_range,
)
from lta_report.palette import ESTIMATE, RAW, SETPOINT, TRUTH
from plotly.graph_objects import Figure


def plot_altitude(view: FlightView) -> Figure:
    """Return a figure of truth, estimate, set-point and raw range."""
    figure = create_time_figure(view)
    truth = view.truth
    labels = [EndLabel('truth', truth.z[-1], TRUTH)]
    curves = [truth.z]
    if view.has_topics('range'):
        measured = view.range_altitude
        # First, so that the lines are drawn over the dots
        figure.add_trace(build_dot_trace('range', *measured, RAW, unit='m'))
    if view.has_topics('setpoint/pose'):
        setpoint = view.altitude_setpoint
        figure.add_trace(
            build_line_trace(
                'set-point', *setpoint, SETPOINT, unit='m', width=1.2, dash='dot', steps=True
            )
        )
        labels.append(EndLabel('set-point', setpoint.value[-1], SETPOINT))
        # The set-point before lift-off must not widen the axis
        curves.append(hold_last(truth.time[truth.time >= find_phases(view).lift_off], setpoint))
    if view.has_topics('odom'):
        estimate = view.estimate
        figure.add_trace(
            build_line_trace('estimate', estimate.time, estimate.z, ESTIMATE, unit='m')
        )
        labels.append(EndLabel('estimate', estimate.z[-1], ESTIMATE))
        curves.append(estimate.z)
    figure.add_trace(build_line_trace('truth', truth.time, truth.z, TRUTH, unit='m'))
    figure.update_yaxes(title_text='altitude [m]')
    label_ends(figure, labels, padded_range(*curves, pad=0.15))
    return figure
