"""Altitude of the hull centre."""

from lta_flight.report.over_time import over_time
from lta_flight.report.results import phases_of
from lta_flight.report.view import View
from lta_report.curves import held
from lta_report.drawing import dots, extent, Label, label_ends, line
from lta_report.palette import ESTIMATE, RAW, SETPOINT, TRUTH
from plotly.graph_objects import Figure


def picture(view: View) -> Figure:
    """Return truth, estimate, set-point and the raw range."""
    figure = over_time(view)
    truth = view.truth
    labels = [Label('truth', truth.z[-1], TRUTH)]
    shown = [truth.z]
    if view.has('range'):
        measured = view.range
        figure.add_trace(dots('range', *measured, RAW, unit='m'))
    if view.has('setpoint/pose'):
        asked = view.altitude_setpoint
        figure.add_trace(
            line('set-point', *asked, SETPOINT, unit='m', width=1.2, dash='dot', steps=True)
        )
        labels.append(Label('set-point', asked.value[-1], SETPOINT))
        shown.append(held(truth.time[truth.time >= phases_of(view).lift_off], asked))
    if view.has('odom'):
        estimate = view.estimate
        figure.add_trace(line('estimate', estimate.time, estimate.z, ESTIMATE, unit='m'))
        labels.append(Label('estimate', estimate.z[-1], ESTIMATE))
        shown.append(estimate.z)
    figure.add_trace(line('truth', truth.time, truth.z, TRUTH, unit='m'))
    figure.update_yaxes(title_text='altitude [m]')
    label_ends(figure, labels, extent(*shown, pad=0.15))
    return figure
