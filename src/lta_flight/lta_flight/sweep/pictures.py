# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plot the results of a sweep: distributions, and results by parameter."""

from collections.abc import Mapping, Sequence
from itertools import product
from statistics import median
from typing import Final, NamedTuple

from lta_config.errors import format_count
from lta_flight.sweep.batch_workers import FAILED, SweepRow
from lta_flight.sweep.plan import convert_to_si, SweepPlan
from lta_flight.sweep.statistics import (
    collect_result_values,
    group_by_parameter,
    is_number,
    ParameterGroup,
    REACHED,
    reached_share,
)
from lta_report.drawing import create_figure
from lta_report.palette import ESTIMATE, GOOD, GRID, INK, TRUTH
from plotly.graph_objects import Box, Figure, Heatmap, Histogram, Scatter

FEWEST_BINS, MOST_BINS = 8, 40  # of a histogram
FEW_FLIGHTS: Final = 20  # flights; up to here the axis has a tick for each
TRANSPARENT: Final = 'rgba(0,0,0,0)'
DOTS: Final = 1500  # flights shown as dots; more would overlap


class PlottedResult(NamedTuple):
    """One plotted result: name, title, unit and colour."""

    name: str
    title: str
    unit: str
    colour: str


MEASURES: Final = (
    PlottedResult('search_time', 'time', 's', TRUTH),
    PlottedResult('path_length', 'path', 'm', ESTIMATE),
)


def plot_histogram(rows: Sequence[SweepRow], measure: PlottedResult) -> Figure:
    """Return a histogram of one result over all flights that reached their goal."""
    figure = create_figure()
    values = collect_result_values(rows, measure.name)
    bins = min(MOST_BINS, max(FEWEST_BINS, len(values) // 4))
    figure.add_trace(
        Histogram(
            x=values, nbinsx=bins, marker={'color': measure.colour},
            name='flights', hovertemplate='%{y} flights',
        )
    )  # fmt: skip
    figure.update_layout(bargap=0.06, margin={'r': 24})
    figure.update_xaxes(title_text=f'{measure.title} [{measure.unit}]')
    # Ticks at whole numbers of flights only
    return figure.update_yaxes(
        title_text='flights', rangemode='tozero', dtick=1 if len(values) <= FEW_FLIGHTS else None
    )


def plot_by_parameter(rows: Sequence[SweepRow], path: str, unit: str, even_in_log: bool) -> Figure:
    """Return a figure of reached share, time and path over one parameter."""
    figure = create_figure(3, [0.3, 0.35, 0.35])
    groups = group_by_parameter(rows, path)
    # Names, such as strategies, need a categorical axis
    words = any(isinstance(group.place, str) for group in groups)
    # There are fewer groups than values, so the parameter was drawn at random
    is_binned = len(groups) < len({str(row.values[path]) for row in rows})
    add_shares(figure, groups)
    for line, measure in enumerate(MEASURES, start=2):
        if is_binned:
            add_dots(figure, rows, path, measure, line)
        add_boxes(figure, groups, measure, line, dots=not is_binned)
        figure.update_yaxes(title_text=f'{measure.title} [{measure.unit}]', row=line)
    title = f'{path} [{unit}]' if unit else path
    figure.update_xaxes(type='category' if words else 'log' if even_in_log else None)
    figure.update_xaxes(title_text=title, row=3)
    figure.update_layout(hovermode='closest', margin={'r': 24, 't': 12})
    return figure


def add_shares(figure: Figure, groups: Sequence[ParameterGroup]) -> None:
    """Add the reached share of each group with its confidence interval."""
    shares = [reached_share(group.rows) for group in groups]
    figure.add_trace(
        Scatter(
            x=[group.place for group in groups],
            y=[share.value for share in shares],
            error_y={
                'type': 'data', 'symmetric': False, 'thickness': 1.2, 'width': 4, 'color': GOOD,
                # Plotly takes distances from the value, not the ends
                'array': [share.high - share.value for share in shares],
                'arrayminus': [share.value - share.low for share in shares],
            },
            mode='lines+markers', line={'color': GOOD, 'width': 1.2},
            marker={'color': GOOD, 'size': 7}, name='reached',
            text=[f'{group.name}: {format_count(len(group.rows), "flight")}' for group in groups],
            hovertemplate='%{y:.1%} reached<br>%{text}<extra></extra>',
        ),
        row=1, col=1,
    )  # fmt: skip
    figure.update_yaxes(
        title_text='reached', range=[-0.04, 1.04], tickvals=[0, 0.5, 1], tickformat='.0%', row=1
    )


def add_dots(
    figure: Figure, rows: Sequence[SweepRow], path: str, measure: PlottedResult, line: int
) -> None:
    """Add each flight that reached its goal as a dot."""
    # Rounded up, so that at most DOTS are shown
    step = -(-len(rows) // DOTS)
    arrivals = [row for row in rows[::step] if collect_result_values([row], measure.name)]
    figure.add_trace(
        Scatter(
            x=[row.values[path] for row in arrivals],
            y=[row.figures[measure.name] for row in arrivals],
            mode='markers', name='flights',
            marker={'color': measure.colour, 'size': 4, 'opacity': 0.45},
            text=[f'flight {row.index}, seed {row.seed}' for row in arrivals],
            hovertemplate=f'%{{y:.2f}} {measure.unit}<br>%{{text}}<extra></extra>',
        ),
        row=line, col=1,
    )  # fmt: skip


def add_boxes(
    figure: Figure, groups: Sequence[ParameterGroup], measure: PlottedResult, line: int, dots: bool
) -> None:
    """Add the distribution in each group: boxes for single values, a median line for ranges."""
    # Few values: a box for each
    if dots:
        for group in groups:
            values = collect_result_values(group.rows, measure.name)
            figure.add_trace(
                Box(
                    x=[group.place] * len(values), y=values, name=group.name,
                    boxpoints='all' if len(values) <= 60 else 'outliers', jitter=0.5, pointpos=0,
                    marker={'color': measure.colour, 'size': 3, 'opacity': 0.6},
                    line={'color': measure.colour, 'width': 1.2}, fillcolor=TRANSPARENT,
                    hoverinfo='y',
                ),
                row=line, col=1,
            )  # fmt: skip
        return
    # Ranges of a random parameter: a line through the medians
    parts = [collect_result_values(group.rows, measure.name) for group in groups]
    middle = [median(part) if part else None for part in parts]
    figure.add_trace(
        Scatter(
            x=[group.place for group in groups], y=middle, mode='lines+markers', name='median',
            line={'color': INK, 'width': 1.4}, marker={'color': INK, 'size': 5},
            hovertemplate=f'median %{{y:.2f}} {measure.unit}<extra></extra>',
        ),
        row=line, col=1,
    )  # fmt: skip


def plot_outcomes(counts: dict[str, int]) -> Figure:
    """Return a bar chart of the outcomes."""
    figure = create_figure()
    colours = {'reached': GOOD, 'failed': INK}
    for name, count in counts.items():
        figure.add_trace(
            Scatter(
                x=[0, count], y=[name, name], mode='lines', name=name,
                line={'color': colours.get(name, ESTIMATE), 'width': 16},
                hovertemplate=f'{count} {name}<extra></extra>',
            )
        )  # fmt: skip
        figure.add_annotation(x=count, y=name, text=str(count), xanchor='left', xshift=6)
    figure.update_layout(hovermode='closest', margin={'l': 76, 'r': 40})
    figure.update_xaxes(title_text='flights', rangemode='tozero', gridcolor=GRID)
    return figure.update_yaxes(type='category', showgrid=False)


LEAST_VALUES = 3  # values of a parameter; a map of fewer shows nothing
MAP_MARGIN = {'l': 64, 'r': 24, 't': 12}


def find_map_parameters(plan: SweepPlan) -> tuple[str, str] | None:
    """Return the two parameters of a map; None if the sweep has others."""
    if len(plan.lists) != 2 or len(plan.units) != 2:
        return None
    first, second = plan.lists
    # Names have no order and make no map
    fits = all(
        len(values) >= LEAST_VALUES and all(is_number(convert_to_si(value)) for value in values)
        for values in plan.lists.values()
    )
    return (first, second) if fits else None


def plot_heat_map(
    rows: Sequence[SweepRow], both: tuple[str, str], units: Mapping[str, str]
) -> Figure:
    """Return a figure of the reached share and the median time over two parameters."""
    across, up = both
    cells: dict[tuple[float, float], list[SweepRow]] = {}
    for row in rows:
        # Failed flights say nothing about the parameters
        if row.outcome != FAILED:
            cells.setdefault((row.values[across], row.values[up]), []).append(row)
    xs, ys = (sorted({row.values[path] for row in rows}) for path in both)
    share: list[list[float | None]] = [[None] * len(xs) for _ in ys]
    times: list[list[float | None]] = [[None] * len(xs) for _ in ys]
    for (i, x), (j, y) in product(enumerate(xs), enumerate(ys)):
        if cell_rows := cells.get((x, y)):
            reached = [row for row in cell_rows if row.outcome == REACHED]
            share[j][i] = 100.0 * len(reached) / len(cell_rows)
            spent = [row.figures.get('search_time') for row in reached]
            times_reached = [value for value in spent if value is not None]
            # None leaves the cell empty
            times[j][i] = median(times_reached) if times_reached else None
    figure = create_figure(2, [0.5, 0.5])
    for line, (grid, words) in enumerate(((share, 'reached [%]'), (times, 'time [s]')), start=1):
        add_map(figure, xs, ys, grid, words, line)
        figure.update_yaxes(title_text=format_axis_title(up, units), row=line)
    figure.update_xaxes(title_text=format_axis_title(across, units), row=2)
    return figure.update_layout(hovermode='closest', margin=MAP_MARGIN)


def add_map(
    figure: Figure,
    xs: Sequence[float],
    ys: Sequence[float],
    grid: Sequence[Sequence[float | None]],
    words: str,
    line: int,
) -> None:
    """Add one map with its colour bar."""
    # One colour bar next to each of the two maps
    bar = {'title': {'text': words}, 'len': 0.5, 'y': 0.77 if line == 1 else 0.23}
    figure.add_trace(
        Heatmap(
            x=xs, y=ys, z=grid, colorscale='Cividis', colorbar=bar,
            zmin=0.0 if line == 1 else None, zmax=100.0 if line == 1 else None,
            hovertemplate='%{x:.3g}, %{y:.3g}: %{z:.1f}<extra></extra>',
        ),
        row=line, col=1,
    )  # fmt: skip


def format_axis_title(path: str, units: Mapping[str, str]) -> str:
    """Return the last word of a parameter's path with its unit, since axes have little space."""
    *_, before, last = path.split('.')
    # An index alone, as in air.wind.0, would not identify the parameter
    short = f'{before}.{last}' if last.isdecimal() else last
    return f'{short} [{units[path]}]' if units.get(path) else short
