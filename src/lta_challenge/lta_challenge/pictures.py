"""Plot the confusion matrix, the detection by strength, and the coverage of intervals."""

from collections import Counter
from collections.abc import Sequence
import math
from typing import Final

from lta_challenge.case_score import confusion_cell, ScoredCase
from lta_challenge.score_statistics import shares_by_strength
from lta_report.drawing import create_figure
from lta_report.palette import build_color_scale, ESTIMATE, GOOD, HEAT, SOFT, WALL
from plotly.graph_objects import Figure, Heatmap, Scatter

LAST: Final = ('nothing', 'unexplained', 'no answer')


def plot_confusion(cases: Sequence[ScoredCase]) -> Figure:
    """Plot named effect against hidden effect, for cases with at most one."""
    cells = Counter(
        confusion_cell(one) for one in cases if one.kind in ('clean', 'single', 'outside')
    )
    # Effects in alphabetical order, then the special outcomes
    rows = sorted({hidden for hidden, _ in cells} - {'nothing'})
    rows += [name for name in ('nothing',) if any(hidden == name for hidden, _ in cells)]
    columns = sorted({answer for _, answer in cells} - set(LAST))
    columns += [name for name in LAST if any(answer == name for _, answer in cells)]
    counts = [[cells.get((row, column), 0) for column in columns] for row in rows]
    figure = create_figure()
    figure.add_trace(
        Heatmap(
            x=columns,
            y=rows,
            # None leaves a cell empty; 0 would be coloured
            z=[[count or None for count in line] for line in counts],
            text=[[str(count) if count else '' for count in line] for line in counts],
            texttemplate='%{text}',
            colorscale=build_color_scale(HEAT),
            showscale=False,
            xgap=1,
            ygap=1,
            hovertemplate='hidden %{y}, named %{x}: %{z} cases<extra></extra>',
        )
    )
    figure.update_xaxes(title_text='effect that discovery named', tickangle=-50, type='category')
    figure.update_yaxes(title_text='hidden effect', autorange='reversed', type='category')
    return figure.update_layout(hovermode='closest', margin={'l': 150, 'b': 150, 'r': 24})


def plot_strength(cases: Sequence[ScoredCase]) -> Figure:
    """Plot the share of exact, wrong and missing names against the strength of the effect."""
    figure = create_figure()
    bands = [each for each in shares_by_strength(cases) if each.exact.of]
    middles = [
        math.sqrt(max(low, 1.0) * (high if math.isfinite(high) else 2.0 * low))
        for low, high, *_ in bands
    ]
    for name, shares, colour in (
        ('exact', [each.exact for each in bands], GOOD),
        ('wrong', [each.wrong for each in bands], ESTIMATE),
        ('silent', [each.silent for each in bands], SOFT),
    ):
        figure.add_trace(
            Scatter(
                x=middles,
                y=[100 * share.value for share in shares],
                name=name,
                mode='lines+markers',
                line={'color': colour, 'width': 1.5},
                error_y={
                    'type': 'data',
                    'symmetric': False,
                    'array': [100 * (share.high - share.value) for share in shares],
                    'arrayminus': [100 * (share.value - share.low) for share in shares],
                    'thickness': 1,
                    'width': 3,
                },
                hovertemplate='%{y:.0f} %<extra>' + name + '</extra>',
            )
        )
    figure.update_xaxes(
        title_text='size of the hidden effect [standard deviations]', type='log',
        tickvals=[1, 3, 10, 30, 100, 300],
    )  # fmt: skip
    figure.update_yaxes(title_text='share [%]', range=[-3, 103])
    return figure.update_layout(showlegend=True, legend={'orientation': 'h', 'y': 1.08})


def plot_coverage(cases: Sequence[ScoredCase]) -> Figure:
    """Plot the truth minus the estimate, in half widths of the interval."""
    intervals = [(one.number, each) for one in cases for each in one.intervals]
    figure = create_figure()
    places = []
    for _, each in intervals:
        half = 0.5 * (each.ci95[1] - each.ci95[0])
        places.append((each.true - each.value) / half if half > 0.0 else math.nan)
    order = sorted(range(len(intervals)), key=lambda k: places[k])
    figure.add_trace(
        Scatter(
            # Empirical distribution: sorted errors against their rank
            x=[100 * (rank + 0.5) / len(intervals) for rank in range(len(intervals))],
            # Clip outliers at four half widths
            y=[max(min(places[k], 4.0), -4.0) for k in order],
            text=[f'{intervals[k][1].name}, case {intervals[k][0]}' for k in order],
            mode='markers',
            marker={'color': GOOD, 'size': 6},
            hovertemplate='%{text}: %{y:.2f}<extra></extra>',
        )
    )
    for edge in (-1.0, 1.0):
        figure.add_hline(y=edge, line={'color': WALL, 'width': 1, 'dash': '3px,3px'})
    figure.update_xaxes(title_text='rank of the parameter [%]')
    figure.update_yaxes(title_text='true value minus estimate [half interval widths]')
    return figure.update_layout(hovermode='closest')
