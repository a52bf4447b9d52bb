"""Plot the results of a sweep: distributions, and results by parameter."""

from collections.abc import Sequence
from statistics import median
from typing import Final, NamedTuple

from lta_flight.sweep.job_runner import SweepRow
from lta_flight.sweep.statistics import (
    collect_result_values,
    group_by_parameter,
    ParameterGroup,
    reached_share,
)
from lta_report.drawing import create_figure
from lta_report.formatting import format_count
from lta_report.palette import ESTIMATE, GOOD, GRID, INK, TRUTH
from plotly.graph_objects import Box, Figure, Histogram, Scatter

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
