# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a tuning."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
import math
from typing import Any, Final

from lta_config.command_line import format_lta_command, relative_path
from lta_report.charts import ChartAxis, Curve, draw_curves, Level
from lta_report.drawing import decimate_line, padded_range
from lta_report.formatting import format_number, Tile
from lta_report.json_value import replace_nonfinite
from lta_report.palette import ESTIMATE, SETPOINT, TRUTH
from lta_report.report import Grid, Picture, Report
from lta_report.result_table import format_share
from lta_studies.tune import report_tables
from lta_studies.tune.compare import compare_costs, GainEvaluation, STEP_NAMES
from lta_studies.tune.margins import to_decibels
from lta_studies.tune.run import GainSetResult, TuningResult, vehicle_name
from lta_studies.tune.step_response import (
    Array,
    Channel,
    SETPOINT_STEPS,
    SetpointStep,
    StepResponse,
)
import numpy as np
from plotly.graph_objects import Figure

TUNING_UNITS = {
    'loss': 'kg',
    'helium': 'g',
    'days': 'd',
    'phase': 'deg',
    'gain': 'dB',
    'delay': 's',
    'crossover': 'rad/s',
    'growth': '1/s',
    'swing': 'rad/s',
    'swing_angle': 'rad',
    'settle': 's',
    'overshoot': '1',
    'steady': '1',
}


def tuning_to_json(tuned: TuningResult) -> Any:
    """Return a tuning as JSON content, in the units that it lists."""
    gap = compare_costs(tuned.old.flights, tuned.new.flights)
    return replace_nonfinite(
        {
            'candidates': len(tuned.search.history),
            'flights': len(tuned.search.history) * len(tuned.losses),
            'stopped': tuned.search.stopped,
            'cost': {'old': tuned.search.first, 'new': tuned.search.cost},
            'fresh_difference': {'mean': gap.value, 'low': gap.low, 'high': gap.high},
            'gains': dict(tuned.search.numbers),
            'old': gain_set_to_json(tuned.old),
            'new': gain_set_to_json(tuned.new),
            'file': str(tuned.file),
            'units': TUNING_UNITS,
        }
    )


def gain_set_to_json(side: GainSetResult) -> dict[str, object]:
    """Return the results of one set of gains as JSON data."""
    steps = {
        name: {
            figure: asdict(side.flights.summarize_step(k, figure))
            for figure in ('settle', 'overshoot', 'steady')
        }
        for k, name in enumerate(STEP_NAMES)
    }
    # A margin is None if the loop never reaches the critical gain or phase
    margins = []
    for each in side.steadiness:
        numbers = each.margins
        row: dict[str, object] = {
            'loop': each.loop, 'speed': each.speed, 'loss': each.loss, 'stable': each.stable,
            'growth': each.growth, 'swing': each.swing,
        }  # fmt: skip
        if numbers is not None:
            # Gain in dB, phase in degrees, as in Bode plots
            row |= {
                'gain': None if numbers.gain is None else to_decibels(numbers.gain),
                'gain_down': None if numbers.gain_down is None else to_decibels(numbers.gain_down),
                'phase': None if numbers.phase is None else math.degrees(numbers.phase),
                # Seconds of additional delay at which the loop becomes unstable
                'delay': numbers.delay,
                'crossover': numbers.crossover,
            }
        margins.append(row)
    limit = side.limit
    return {
        'lost': side.flights.lost_share._asdict(),
        'reached': side.flights.reached_share._asdict(),
        'cost': asdict(side.flights.compute_metric_quartiles('cost')),
        'swing_angle': asdict(side.flights.compute_metric_quartiles('swing')),
        'steps': steps,
        'margins': margins,
        'helium': {**asdict(limit), 'days': list(limit.days)},
    }


RESPONSE_PANELS: Final[tuple[tuple[Channel, str, str], ...]] = (
    (
        'altitude',
        'Climb and descent',
        'If no rotor reverses, only the weight pulls the drone down.',
    ),
    ('heading', 'Turn', 'Without airspeed.'),
    ('speed', 'Forward speed', 'Some speed remains from the turn before.'),
    (
        'course',
        'Turn at speed',
        'Course: direction of motion through the air; the nose points against the drift.',
    ),
)
SEARCH_CAPTION: Final = (
    'Lowest cost so far: average of the mean and the worst cost of the test flights. '
    'Dotted: the old gains.'
)
STEP_CAPTION: Final = (
    'True values, one line for each loss of lift; the paler, the larger the loss. '
    'Dotted: setpoint.'
)
Traces = Sequence[tuple[float, StepResponse]]


def build_report(tuned: TuningResult, responses: tuple[Traces, Traces] | None) -> Report:
    """Return the report; `responses` of old and new gains are plotted, if there is a page."""
    order = tuned.order
    return Report(
        command='tune',
        subject=f'{vehicle_name(order)} · from {tuned.gains_name} · seed {order.seed}',
        headline=report_tables.typeset_signs(report_tables.format_headline(tuned)),
        introduction=describe_tuning(tuned),
        tiles=build_tiles(tuned),
        blocks=[
            *([Grid(list(draw_pictures(tuned, *responses)))] if responses else []),
            report_tables.build_comparison_table(tuned),
            report_tables.build_stability_margin_table(tuned),
            Grid([
                report_tables.build_parameter_table(tuned),
                report_tables.build_helium_limit_table(tuned.old.limit, tuned.new.limit),
            ]),
        ],
        data=tuning_to_json(tuned),
        facts=build_provenance_table(tuned),
        commands=suggest_commands(tuned),
        files={'Gains file': tuned.file.read_text(encoding='utf-8')},
        closing=[f'Gains {relative_path(tuned.file)}'],
    )  # fmt: skip


def describe_tuning(tuned: TuningResult) -> str:
    """Describe the flights of the tuning and the cost."""
    order = tuned.order
    return (
        f'{len(tuned.search.history)} candidate gain sets flew {len(tuned.losses)} test '
        f'flights each, with {1e3 * order.least:g} to {1e3 * order.most:g} g of lift lost, '
        'unknown to the drone. The comparison below uses new random flights. The cost '
        'combines settling, overshoot, steady error, swing, rotor activity and mission '
        'time; lower is better.'
    )


def build_tiles(tuned: TuningResult) -> list[Tile]:
    """Return the tiles with the key figures."""
    old, new = tuned.old, tuned.new
    median = f'median of {len(new.flights.reports)} flights'

    def both(name: str, words: str, unit: str, factor: float, digits: int) -> Tile:
        a, b = (side.flights.compute_metric_quartiles(name).median * factor for side in (old, new))
        return Tile(words, f'{b:.{digits}f}', unit, f'{median}; before {a:.{digits}f}')

    # Overshoot of one step with old and new gains [%]
    def over(step: int) -> tuple[float, float]:
        a, b = (100 * side.flights.summarize_step(step, 'overshoot').median for side in (old, new))
        return a, b

    # Step 0 is the climb.
    climb = over(0)
    held = new.limit.grams
    return [
        both('cost', 'Cost', '', 1.0, 3),
        Tile('Overshoot of a climb', f'{climb[1]:.0f}', '%', f'{median}; before {climb[0]:.0f}'),
        both('swing', 'Swing at the end', '\N{DEGREE SIGN}', 180.0 / math.pi, 2),
        Tile(
            'Missions at the goal',
            f'{100 * new.flights.reached_share.value:.0f}',
            '%',
            f'of {len(new.flights.reports)}; before {format_share(old.flights.reached_share)}',
        ),
        Tile(
            'Holds up to',
            format_number(held, 1),
            'g lost',
            f'after {new.limit.days[0]:.0f} to {new.limit.days[1]:.0f} days of leaking',
        ),
        Tile(
            'Flights',
            str(len(tuned.search.history) * len(tuned.losses)),
            '',
            # Each draw is flown with both sets of gains.
            f'in the search, and {2 * len(old.flights.reports)} in the comparison',
        ),
    ]


def draw_pictures(tuned: TuningResult, old: Traces, new: Traces) -> Iterator[Picture]:
    """Yield step responses, costs and search."""
    for channel, heading, caption in RESPONSE_PANELS:
        figure = plot_responses(channel, old, new)
        yield Picture(channel, heading, f'{caption} {STEP_CAPTION}', figure, height=300)
    yield Picture(
        'costs', 'Cost of each new random flight',
        'Each random flight is flown with both sets of gains.',
        plot_costs(tuned.old.flights, tuned.new.flights), height=270,
    )  # fmt: skip
    history = plot_search(tuned.search.history, len(tuned.losses))
    yield Picture('search', 'The search', SEARCH_CAPTION, history, height=270)


def build_provenance_table(tuned: TuningResult) -> dict[str, str]:
    """Return the provenance table of the page."""
    order = tuned.order
    return {
        'vehicle': order.vehicle,
        'gains before': tuned.gains_name,
        'losses in the search': ', '.join(f'{1e3 * loss:.2g} g' for loss in tuned.losses),
        # 1000 is `compare.FRESH`.
        'seeds': f'{order.seed} to {order.seed + len(tuned.losses) - 1} in the search, '
        'from 1000 in the comparison',
    }


def suggest_commands(tuned: TuningResult) -> dict[str, str]:
    """Return commands for the next steps."""
    file = str(relative_path(tuned.file))
    return {
        'Fly with the new gains': format_lta_command(
            'simulate', '--vehicle', tuned.order.vehicle, '--gains', file
        ),
        'Continue tuning from them': format_lta_command(
            'tune', tuned.order.vehicle, '--gains', file
        ),
    }


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
