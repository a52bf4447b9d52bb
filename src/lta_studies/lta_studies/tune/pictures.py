"""Plot a tuning: step responses of old and new gains, costs by loss, and the search."""

from collections.abc import Sequence
import math

from lta_report.charts import ChartAxis, Curve, draw_curves, Level
from lta_report.drawing import decimate_line, padded_range
from lta_report.palette import ESTIMATE, SETPOINT, TRUTH
from lta_studies.tune.compare import GainEvaluation
from lta_studies.tune.step_response import (
    Array,
    Channel,
    SETPOINT_STEPS,
    SetpointStep,
    StepResponse,
)
import numpy as np
from plotly.graph_objects import Figure

OLD, NEW = ESTIMATE, TRUTH
TITLES: dict[Channel, str] = {
    'altitude': 'altitude [m]',
    'heading': 'heading [\N{DEGREE SIGN}]',
    'speed': 'speed [m/s]',
    'course': 'course [\N{DEGREE SIGN}]',
}
TIME_BEFORE_STEP = 1.0  # s shown before a step


def plot_responses(
    channel: Channel,
    old: Sequence[tuple[float, StepResponse]],
    new: Sequence[tuple[float, StepResponse]],
) -> Figure:
    """Plot the step responses of one channel with old and new gains at each loss [kg]."""
    steps = [step for step in SETPOINT_STEPS if step.channel == channel]
    factor = 180.0 / math.pi if channel in ('heading', 'course') else 1.0
    begin, end = steps[0].start - TIME_BEFORE_STEP, steps[-1].end
    curves, limits = [], []
    for name, colour, traces in (('old', OLD, old), ('new', NEW, new)):
        for k, (loss, trace) in enumerate(traces):
            part = (trace.time >= begin) & (trace.time < end)
            values = factor * trace.select_channel(channel)[part]
            limits.append(values)
            # From 1 for the smallest loss to 0.4 for the largest
            pale = {'opacity': 1.0 - 0.6 * k / max(1, len(traces) - 1)}
            line = decimate_line(trace.time[part] - begin, values)
            words = f'{name}, {1e3 * loss:.1f} g lost'
            curves.append(Curve(words, *line, colour, '%{y:.3~f}', width=1.2, more=pale))
    time, values = setpoint_line(steps, begin, end)
    curves.append(
        Curve('setpoint', time, factor * values, SETPOINT, '%{y:.3~f}', 'lines', 'dot', 1.0)
    )
    span = padded_range(*limits, factor * values)
    figure = draw_curves(curves, ChartAxis('time [s]'), ChartAxis(TITLES[channel], range=span))
    figure.update_layout(hovermode='closest', margin={'r': 24}, showlegend=False)
    return name_colours(figure)


def setpoint_line(steps: Sequence[SetpointStep], begin: float, end: float) -> tuple[Array, Array]:
    """Return time and value of the setpoint as a stepped line."""
    time, values = [0.0], [steps[0].before]
    for step in steps:
        # Two points at the same time draw the vertical edge of the step.
        time += [step.start - begin, step.start - begin]
        values += [values[-1], step.after]
    return np.array([*time, end - begin]), np.array([*values, values[-1]])


def name_colours(figure: Figure) -> Figure:
    """Label the colours of old and new gains."""
    # In pixels: a share of a narrow figure is less than the first label
    for words, colour, shift in (('old gains', OLD, 0), ('new gains', NEW, 70)):
        figure.add_annotation(
            x=0.0, xshift=shift, y=1.0, xref='paper', yref='paper', xanchor='left',
            yanchor='bottom', text=words, font={'color': colour, 'size': 11},
        )  # fmt: skip
    return figure


def plot_costs(old: GainEvaluation, new: GainEvaluation) -> Figure:
    """Plot the cost of each comparison flight against its loss."""
    curves = [
        Curve(
            name, [1e3 * loss for loss in flights.losses],
            [report.cost for report in flights.reports], colour,
            f'{name} gains: cost %{{y:.3f}} at %{{x:.2f}} g lost<extra></extra>', 'markers',
            size=7, more={'marker_opacity': 0.8},
        )
        for name, colour, flights in (('old', OLD, old), ('new', NEW, new))
    ]  # fmt: skip
    figure = draw_curves(curves, ChartAxis('lift lost [g]'), ChartAxis('cost', zero=True))
    figure.update_layout(hovermode='closest', margin={'r': 24}, showlegend=False)
    return name_colours(figure)


def plot_search(history: Sequence[float], cases: int) -> Figure:
    """Plot the lowest cost against the number of flights."""
    flights = cases * np.arange(1.0, len(history) + 1.0)
    steps = Curve('best', flights, history, NEW, more={'line_shape': 'hv'})
    # Where nothing better is found, ticks would differ in the ninth digit
    low, high = min(history), max(history)
    room = max(0.1 * (high - low), 0.01 * abs(high))
    cost = ChartAxis(
        'lowest cost so far', range=(low - room, high + room), more={'tickformat': '.3~g'}
    )
    figure = draw_curves([steps], ChartAxis('flights'), cost, levels=[Level(history[0])])
    return figure.update_layout(margin={'r': 24})
