"""Plot the evaluation: the paper, success along an axis, factors, and one flight of each."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
import math
from typing import Any, Final, final

from lta_flight.loop_view import LoopView
from lta_flight.report.room import choose_tick_distance, draw_room
from lta_flight.sweep.plan import SweepPlan
from lta_flight.sweep.statistics import ShareInterval
from lta_model.scenario import Scenario
from lta_report.curves import Array
from lta_report.drawing import create_figure, TEMPLATE
from lta_report.palette import ESTIMATE, GOOD, INK, LAMP, PAPER, SOFT, TIME, TRUTH
from lta_studies.light.evaluation import tables
from lta_studies.light.evaluation.cells import BootstrapMean, EvaluationCell, select_pilot_cells
from lta_studies.light.evaluation.flights import build_standalone_job, PILOT, prepare_flight
from lta_studies.light.evaluation.sets import EvaluationAxis
import numpy as np
from plotly.graph_objects import Figure, Scatter
from plotly.subplots import make_subplots

STRATEGY_COLOURS: Final[Mapping[str, str]] = {
    'bag': TRUTH, 'dga': LAMP, 'des': ESTIMATE, 'homing': GOOD, PILOT: SOFT,
}  # fmt: skip
SYMBOLS: Final[Mapping[str, str]] = {
    'bag': 'circle', 'dga': 'square', 'des': 'diamond', 'homing': 'triangle-up', PILOT: 'x',
}  # fmt: skip
# Path [m] and time [s] of the indoor flights that the seed paper prints; None if not printed
PAPER_FLIGHTS: Final[Mapping[str, tuple[float, float | None]]] = {
    'bag': (7.3, 8.4), 'dga': (8.6, 21.4), 'des': (12.2, None),
}  # fmt: skip
Interval = BootstrapMean | ShareInterval
STRATEGY_SPACING: Final = 0.012  # share of the axis between the markers of two strategies
LEGEND_ABOVE: Final = {
    'orientation': 'h',
    'x': 0,
    'y': 1.02,
    'xanchor': 'left',
    'yanchor': 'bottom',
}
FIGURE_LAYOUT: Final = {
    'hovermode': 'closest', 'showlegend': True, 'legend': LEGEND_ABOVE, 'margin': {'r': 16, 't':
    26},
}  # fmt: skip


def strategy_offset(strategy: str) -> int:
    """Return the place of a strategy's markers beside those of the others; 0 is the middle."""
    order = (
        list(STRATEGY_COLOURS).index(strategy)
        if strategy in STRATEGY_COLOURS
        else len(STRATEGY_COLOURS)
    )
    # Five strategies: the third stays in the middle.
    return order - 2


def strategy_color(strategy: str) -> str:
    """Return the colour of a strategy, the same in every plot."""
    return STRATEGY_COLOURS.get(strategy, TIME[0])


def build_error_bars(values: Sequence[Interval], colour: str) -> dict[str, Any]:
    """Return error bars from intervals."""
    return {
        'type': 'data', 'symmetric': False, 'thickness': 1.4, 'width': 5, 'color': colour,
        'array': [none_if_nan(each.high - each.value) for each in values],
        'arrayminus': [none_if_nan(each.value - each.low) for each in values],
    }  # fmt: skip


def none_if_nan(length: float) -> float | None:
    """Return a number; None if it is NaN."""
    return None if math.isnan(length) else length


def build_markers(
    name: str, x: Sequence[Any], values: Sequence[Interval], *, joined: bool, legend: bool
) -> Scatter:
    """Return the markers of one strategy with error bars."""
    shade = strategy_color(name)
    return Scatter(
        x=list(x), y=[none_if_nan(each.value) for each in values],
        error_y=build_error_bars(values, shade),
        mode='lines+markers' if joined else 'markers', name=tables.label_strategy(name),
        line={'color': shade, 'width': 1.4}, showlegend=legend, legendgroup=name,
        marker={'color': shade, 'size': 8, 'symbol': SYMBOLS.get(name, 'circle')},
        hovertemplate='%{y:.3~g}',
    )  # fmt: skip


def plot_paper_comparison(cells: Sequence[EvaluationCell]) -> Figure:
    """Plot path, time and success of each strategy indoors, with the paper's flights."""
    figure = create_figure(3, [0.42, 0.34, 0.24])
    for cell in cells:
        name = tables.label_strategy(cell.strategy)
        intervals: tuple[Interval, ...] = (
            cell.mean('path_length'),
            cell.mean('search_time'),
            cell.reached_share,
        )
        for row, value in enumerate(intervals, start=1):
            markers = build_markers(cell.strategy, [name], [value], joined=False, legend=False)
            figure.add_trace(markers, row=row, col=1)
    strategies = [cell.strategy for cell in cells if cell.strategy in PAPER_FLIGHTS]
    for row in (1, 2):
        figure.add_trace(
            Scatter(
                x=[tables.label_strategy(name) for name in strategies],
                y=[PAPER_FLIGHTS[name][row - 1] for name in strategies],
                mode='markers', name='paper, one flight', showlegend=row == 1,
                marker={'symbol': 'star', 'size': 11, 'color': PAPER,
                        'line': {'color': INK, 'width': 1.3}},
                hovertemplate='paper %{y:.3~g}<extra></extra>',
            ),
            row=row, col=1,
        )  # fmt: skip
    figure.update_yaxes(title_text='path [m]', rangemode='tozero', row=1)
    figure.update_yaxes(title_text='time [s]', rangemode='tozero', row=2)
    set_share_axis(figure, 3)
    figure.update_xaxes(type='category')
    return figure.update_layout(FIGURE_LAYOUT)


def set_share_axis(figure: Figure, row: int) -> None:
    """Format the y axis of a row for shares."""
    figure.update_yaxes(
        title_text='reached', range=[-0.06, 1.06], tickvals=[0, 0.5, 1], tickformat='.0%', row=row
    )


def plot_along_axis(cells: Sequence[EvaluationCell], axis: EvaluationAxis) -> Figure:
    """Plot success along an axis, one row per family of cases, and path ratios."""
    families = group_by_family(cells)
    piloted = bool(select_pilot_cells(cells))
    figure = create_figure(len(families) + piloted, None)
    places = sorted({cell.place for cell in cells})
    seen: set[str] = set()
    for row, (family, own) in enumerate(families.items(), start=1):
        for name, line in group_by_strategy(own).items():
            x = offset_marker_positions(line, places, axis, name)
            shares = [cell.reached_share for cell in line]
            markers = build_markers(name, x, shares, joined=True, legend=name not in seen)
            figure.add_trace(markers, row=row, col=1)
            seen.add(name)
        set_share_axis(figure, row)
        if family:
            figure.update_yaxes(title_text=wrap_text(tables.label_factor(family)), row=row)
    if piloted:
        add_ratios(figure, cells, places, axis, len(families) + 1)
    last = len(families) + piloted
    figure.update_xaxes(title_text=f'{axis.title} [{axis.unit}]', row=last)
    if axis.decades:
        figure.update_xaxes(
            tickvals=list(range(len(places))),
            ticktext=['dark' if place == 0.0 else f'{place:,.0f}' for place in places],
        )
    return figure.update_layout(FIGURE_LAYOUT)


def add_ratios(
    figure: Figure,
    cells: Sequence[EvaluationCell],
    places: Sequence[float],
    axis: EvaluationAxis,
    row: int,
) -> None:
    """Draw the ratio of each strategy's path to the pilot's, for all families."""
    best = select_pilot_cells(cells)
    worst = 1.5
    for name, line in group_by_strategy(cells).items():
        if name == PILOT:
            continue
        ratios = [cell.ratio_to(best.get(cell.case)) for cell in line]
        x = offset_marker_positions(line, places, axis, name)
        markers = build_markers(name, x, ratios, joined=False, legend=False)
        figure.add_trace(markers, row=row, col=1)
        # Only NaN differs from itself.
        worst = max([worst, *(each.value for each in ratios if each.value == each.value)])
    figure.add_hline(y=1.0, line={'color': SOFT, 'width': 1}, row=row, col=1)
    # At most 4, as one very long path would flatten all others.
    figure.update_yaxes(title_text='path / pilot', range=[0.8, min(1.1 * worst, 4.0)], row=row)


def group_by_family(cells: Sequence[EvaluationCell]) -> dict[str, list[EvaluationCell]]:
    """Group cells by family; cells without a family are in all of them."""
    names = list(dict.fromkeys(cell.family for cell in cells if cell.family)) or ['']
    return {name: [cell for cell in cells if cell.family in {name, ''}] for name in names}


def group_by_strategy(cells: Sequence[EvaluationCell]) -> dict[str, list[EvaluationCell]]:
    """Group cells by strategy, sorted along the axis."""
    ordered = sorted(cells, key=lambda cell: (cell.strategy, cell.place))
    # `groupby` needs sorted input; the dictionary below restores the order of the set.
    grouped = groupby(ordered, key=lambda cell: cell.strategy)
    own = {name: list(line) for name, line in grouped}
    return {cell.strategy: own[cell.strategy] for cell in cells}


def offset_marker_positions(
    line: Sequence[EvaluationCell], places: Sequence[float], axis: EvaluationAxis, name: str
) -> list[float]:
    """Return the x positions of a strategy's cells, shifted so that markers do not overlap."""
    # Axes over decades show evenly spaced categories, as dark (0 lx) has no logarithm.
    span = len(places) - 1.0 if axis.decades else places[-1] - places[0]
    shift = STRATEGY_SPACING * strategy_offset(name) * (span or 1.0)
    return [(places.index(cell.place) if axis.decades else cell.place) + shift for cell in line]


def plot_factors(cells: Sequence[EvaluationCell]) -> Figure:
    """Plot the mean path of each strategy with one factor changed at a time, a line for each."""
    figure = make_subplots(rows=1, cols=2, shared_yaxes=True, column_widths=[0.62, 0.38])
    cases = list(dict.fromkeys(cell.case for cell in cells))
    for name, line in group_by_strategy(cells).items():
        places = [cases.index(cell.case) + 0.09 * strategy_offset(name) for cell in line]
        lengths = [cell.mean('path_length') for cell in line]
        shares = [cell.reached_share for cell in line]
        for column, markers in (
            (1, build_markers(name, places, lengths, joined=False, legend=True)),
            (2, build_markers(name, places, shares, joined=False, legend=False)),
        ):
            figure.add_trace(lay_down(markers), row=1, col=column)
    figure.update_xaxes(title_text='path [m]', rangemode='tozero', col=1)
    figure.update_xaxes(
        title_text='reached', range=[-0.06, 1.06], tickvals=[0, 0.5, 1], tickformat='.0%', col=2
    )
    figure.update_yaxes(
        tickvals=list(range(len(cases))), range=[len(cases) - 0.5, -0.5],
        ticktext=[wrap_text(tables.label_factor(case)) for case in cases],
    )  # fmt: skip
    figure.update_layout(template=TEMPLATE).update_layout(FIGURE_LAYOUT)
    return figure.update_layout(margin={'l': 122})


def lay_down(markers: Scatter) -> Scatter:
    """Return markers with x and y exchanged."""
    across = markers.to_plotly_json()
    across['x'], across['y'] = across['y'], across['x']
    across['error_x'] = across.pop('error_y')
    across['hovertemplate'] = '%{x:.3~g}'
    return Scatter(across)


def wrap_text(text: str, width: int = 16) -> str:
    """Wrap text with Plotly line breaks."""
    lines = ['']
    for word in text.split():
        if lines[-1] and len(lines[-1]) + len(word) >= width:
            lines.append('')
        lines[-1] = f'{lines[-1]} {word}'.strip()
    return '<br>'.join(lines)


TRACK_POINTS = 400  # points of a track, at most about twice that
ROOM_MARGIN = 0.25  # m of blank space around the room


@final
@dataclass(frozen=True, slots=True)
class EvaluationTrack:
    """Ground track of one flight over time. [s], [m, map]"""

    strategy: str
    time: Array
    x: Array
    y: Array
    reached: bool


def select_track_seed(cells: Sequence[EvaluationCell]) -> int:
    """Return the first seed in which the most strategies reach the lamp."""
    seeds = sorted({seed for cell in cells for seed in cell.rows})
    # -seed: of equal seeds the first
    return max(seeds, key=lambda seed: (sum(seed in cell.arrivals for cell in cells), -seed))


def fly_again(
    plan: SweepPlan, cells: Sequence[EvaluationCell], seed: int
) -> tuple[list[EvaluationTrack], Scenario]:
    """Repeat the flights of one seed, since rows do not store tracks."""
    flight_tracks = []
    for cell in cells:
        if seed not in cell.rows:
            continue
        row = cell.rows[seed]
        loop = prepare_flight(build_standalone_job(plan, plan.build_job(row.index)))
        view = LoopView(loop)
        for _ in loop.iterate_steps():
            view.record_step()
        truth = view.truth
        # Integer division, so the step is too small rather than too large.
        keep = slice(None, None, max(1, len(truth.x) // TRACK_POINTS))
        way = (truth.time[keep], truth.x[keep], truth.y[keep])
        flight_tracks.append(EvaluationTrack(cell.strategy, *way, seed in cell.arrivals))
    return flight_tracks, loop.world.scenario


def plot_tracks(tracks: Sequence[EvaluationTrack], scenario: Scenario, height: float) -> Figure:
    """Plot some tracks in their room."""
    figure = create_figure()
    draw_room(figure, scenario, height)
    figure.update_traces(showlegend=False)
    for each in tracks:
        shade = strategy_color(each.strategy)
        figure.add_trace(
            Scatter(
                x=each.x.astype(np.float32), y=each.y.astype(np.float32), mode='lines',
                name=tables.label_strategy(each.strategy), line={'color': shade, 'width': 1.8},
                showlegend=True, hoverinfo='name',
            )
        )  # fmt: skip
    length, width, _ = scenario.room.size.vector
    step = choose_tick_distance(max(length, width))
    shared = {'showgrid': False, 'dtick': step, 'constrain': 'domain'}
    figure.update_xaxes(
        range=[-length / 2 - ROOM_MARGIN, length / 2 + ROOM_MARGIN], title_text='x [m]', **shared
    )
    figure.update_yaxes(
        range=[-width / 2 - ROOM_MARGIN, width / 2 + ROOM_MARGIN], title_text='y [m]',
        scaleanchor='x',
        constraintoward='top', **shared,
    )  # fmt: skip
    return figure.update_layout(
        hovermode='closest', showlegend=True, legend=LEGEND_ABOVE,
        margin={'l': 44, 'r': 12, 't': 26, 'b': 40},
    )  # fmt: skip
