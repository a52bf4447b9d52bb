"""Where the nose points, and where the lamp is."""

from lta_flight.report.goal import wrapped
from lta_flight.report.over_time import over_time
from lta_flight.report.view import View
from lta_report.curves import sampled
from lta_report.drawing import extent, Label, label_ends, line
from lta_report.palette import ESTIMATE, LAMP, SETPOINT, TRUTH
import numpy as np
from plotly.graph_objects import Figure


def picture(view: View) -> Figure:
    """Return true, estimated and asked-for heading beside the direction to the lamp."""
    figure = over_time(view)
    truth = view.truth
    heading = np.degrees(truth.yaw)
    labels = [Label('truth', heading[-1], TRUTH)]
    shown = [heading]
    if view.goal.places:
        lamp = heading + np.degrees(view.goal.direction(truth))
        figure.add_trace(line('to the lamp', truth.time, lamp, LAMP, unit='°', width=1.2))
        labels.append(Label('to the lamp', lamp[-1], LAMP))
        shown.append(lamp)
    if view.has('odom', 'setpoint/pose'):
        time, asked = view.heading_setpoint
        estimate = sampled(time, view.estimate.time, view.estimate.yaw)
        asked = np.degrees(estimate + wrapped(asked - estimate))
        figure.add_trace(
            line('set-point', time, asked, SETPOINT, unit='°', width=1.2, dash='dot', steps=True)
        )
        labels.append(Label('set-point', asked[-1], SETPOINT))
        shown.append(asked)
    if view.has('odom'):
        own = np.degrees(view.estimate.yaw)
        figure.add_trace(line('estimate', view.estimate.time, own, ESTIMATE, unit='°'))
        labels.append(Label('estimate', own[-1], ESTIMATE))
        shown.append(own)
    figure.add_trace(line('truth', truth.time, heading, TRUTH, unit='°'))
    figure.update_yaxes(title_text='heading [°]')
    label_ends(figure, labels, extent(*shown))
    return figure
