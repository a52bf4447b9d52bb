"""Plot the heading and the direction to the lamp."""

from lta_data.compare.sampling import wrap_angle
from lta_flight.report.time_figure import create_time_figure
from lta_flight.report.view import FlightView
from lta_report.curves import interpolate
from lta_report.drawing import build_line_trace, EndLabel, label_ends, padded_range
from lta_report.palette import ESTIMATE, LAMP, SETPOINT, TRUTH
import numpy as np
from plotly.graph_objects import Figure


def plot_heading(view: FlightView) -> Figure:
    """Return a figure of true, estimated and commanded heading and of the lamp's direction."""
    figure = create_time_figure(view)
    truth = view.truth
    heading = np.degrees(truth.yaw)
    labels = [EndLabel('truth', heading[-1], TRUTH)]
    curves = [heading]
    if view.goal.places:
        # The direction is in the body frame
        lamp = heading + np.degrees(view.goal.lamp_direction(truth))
        figure.add_trace(
            build_line_trace('to the lamp', truth.time, lamp, LAMP, unit='°', width=1.2)
        )
        labels.append(EndLabel('to the lamp', lamp[-1], LAMP))
        curves.append(lamp)
    if view.has_topics('odom', 'setpoint/pose'):
        time, setpoint = view.heading_setpoint
        estimate = interpolate(time, view.estimate.time, view.estimate.yaw)
        # Shift the set-point by full turns to the estimate, so that the lines stay together
        setpoint = np.degrees(estimate + wrap_angle(setpoint - estimate))
        figure.add_trace(
            build_line_trace(
                'set-point', time, setpoint, SETPOINT, unit='°', width=1.2, dash='dot', steps=True
            )
        )
        labels.append(EndLabel('set-point', setpoint[-1], SETPOINT))
        curves.append(setpoint)
    if view.has_topics('odom'):
        own = np.degrees(view.estimate.yaw)
        figure.add_trace(build_line_trace('estimate', view.estimate.time, own, ESTIMATE, unit='°'))
        labels.append(EndLabel('estimate', own[-1], ESTIMATE))
        curves.append(own)
    figure.add_trace(build_line_trace('truth', truth.time, heading, TRUTH, unit='°'))
    figure.update_yaxes(title_text='heading [°]')
    label_ends(figure, labels, padded_range(*curves))
    return figure
