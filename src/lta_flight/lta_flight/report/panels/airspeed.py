"""Plot the forward airspeed."""

from lta_flight.report.time_figure import create_time_figure
from lta_flight.report.view import FlightView
from lta_report.drawing import build_line_trace, EndLabel, label_ends, padded_range
from lta_report.palette import ESTIMATE, SETPOINT, TRUTH
from plotly.graph_objects import Figure


def plot_airspeed(view: FlightView) -> Figure:
    """Return a figure of true, estimated and commanded forward airspeed."""
    figure = create_time_figure(view)
    truth = view.truth
    labels = [EndLabel('truth', truth.speed[-1], TRUTH)]
    curves = [truth.speed]
    if view.has_topics('setpoint/velocity'):
        setpoint = view.speed_setpoint
        figure.add_trace(
            build_line_trace(
                'set-point', *setpoint, SETPOINT, unit='m/s', width=1.2, dash='dot', steps=True
            )
        )
        labels.append(EndLabel('set-point', setpoint.value[-1], SETPOINT))
        curves.append(setpoint.value)
    if view.has_topics('odom'):
        estimate = view.estimate
        figure.add_trace(
            build_line_trace('estimate', estimate.time, estimate.speed, ESTIMATE, unit='m/s')
        )
        labels.append(EndLabel('estimate', estimate.speed[-1], ESTIMATE))
        curves.append(estimate.speed)
    figure.add_trace(build_line_trace('truth', truth.time, truth.speed, TRUTH, unit='m/s'))
    figure.update_yaxes(title_text='forward airspeed [m/s]')
    label_ends(figure, labels, padded_range(*curves))
    return figure
