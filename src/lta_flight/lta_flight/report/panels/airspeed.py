"""Forward speed through the air."""

from lta_flight.report.over_time import over_time
from lta_flight.report.view import View
from lta_report.drawing import extent, Label, label_ends, line
from lta_report.palette import ESTIMATE, SETPOINT, TRUTH
from plotly.graph_objects import Figure


def picture(view: View) -> Figure:
    """Return true, estimated and asked-for forward airspeed."""
    figure = over_time(view)
    truth = view.truth
    labels = [Label('truth', truth.speed[-1], TRUTH)]
    shown = [truth.speed]
    if view.has('setpoint/velocity'):
        asked = view.speed_setpoint
        figure.add_trace(
            line('set-point', *asked, SETPOINT, unit='m/s', width=1.2, dash='dot', steps=True)
        )
        labels.append(Label('set-point', asked.value[-1], SETPOINT))
        shown.append(asked.value)
    if view.has('odom'):
        estimate = view.estimate
        figure.add_trace(line('estimate', estimate.time, estimate.speed, ESTIMATE, unit='m/s'))
        labels.append(Label('estimate', estimate.speed[-1], ESTIMATE))
        shown.append(estimate.speed)
    figure.add_trace(line('truth', truth.time, truth.speed, TRUTH, unit='m/s'))
    figure.update_yaxes(title_text='forward airspeed [m/s]')
    label_ends(figure, labels, extent(*shown))
    return figure
