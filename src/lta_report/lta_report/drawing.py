# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Shared style and elements of figures: fonts, axes, lines and labels at line ends."""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

from lta_report.curves import Array
from lta_report.palette import GRID, INK, PAPER, SOFT
import numpy as np
from plotly.graph_objects import Figure, Scatter
from plotly.graph_objs.layout import Template
from plotly.subplots import make_subplots

FONT = '-apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif'
LEFT, RIGHT, TOP, BOTTOM = 56, 88, 22, 40  # px; equal, so that time axes line up
LETTER = 6.4  # px, mean width of a letter of a label
FITTING = 15  # letters of a label that fit the margin RIGHT
MOST_POINTS = 2000  # per line: more than the pixels of a panel, few enough to redraw at once
AXIS_LOOK = {
    'gridcolor': GRID,
    'linecolor': GRID,
    'zeroline': False,
    'ticks': '',
    'ticklabelstandoff': 3,
    'tickfont': {'color': SOFT, 'size': 11},
    'title': {'font': {'color': SOFT, 'size': 12}, 'standoff': 8},
}
TEMPLATE = Template(
    layout={
        'font': {'family': FONT, 'size': 12, 'color': INK},
        'paper_bgcolor': PAPER,
        'plot_bgcolor': PAPER,
        'showlegend': False,
        'hovermode': 'x unified',
        'hoverlabel': {'bgcolor': PAPER, 'bordercolor': GRID, 'font': {'color': INK, 'size': 11}},
        'margin': {'l': LEFT, 'r': RIGHT, 't': TOP, 'b': BOTTOM},
        'xaxis': AXIS_LOOK,
        'yaxis': AXIS_LOOK,
        'annotationdefaults': {'showarrow': False, 'font': {'size': 11, 'color': SOFT}},
    }
)


class EndLabel(NamedTuple):
    """A label at the right end of a line: text, height in units of the y axis, colour."""

    text: str
    height: float
    colour: str


def add_legend(figure: Figure) -> Figure:
    """Show a legend in rows above a figure; the top margin grows with it."""
    return figure.update_layout(
        showlegend=True,
        legend={
            'orientation': 'h',
            'x': 0.0,
            'y': 1.02,
            'yanchor': 'bottom',
            'font': {'size': 11},
        },
    )


def create_figure(rows: int = 1, heights: Sequence[float] | None = None) -> Figure:
    """Return an empty figure with rows that share the x axis."""
    # To copy a figure takes a fifth of the time
    return Figure(_create_blank_figure(rows, heights and tuple(heights)))


@cache
def _create_blank_figure(rows: int, heights: tuple[float, ...] | None) -> Figure:
    figure = make_subplots(
        rows=rows,
        cols=1,
        shared_xaxes=True,
        vertical_spacing=0.06,
        row_heights=heights and list(heights),
    )
    return figure.update_layout(template=TEMPLATE)


def decimate_line(time: Array, values: Array, most: int = MOST_POINTS) -> tuple[Array, Array]:
    """
    Reduce a line to few points, keeping the minimum and maximum of each interval.

    Parameters
    ----------
    time, values : ndarray, shape (n,)
        The line.
    most : int
        Most points of the result.

    Returns
    -------
    time, values : ndarray of float32, shape (at most `most`,)
        A line that looks the same.

    """
    if len(time) > most:
        # Two points per interval
        count = most // 2
        length = len(time) // count + 1
        # Repeat the last value, so that the line divides into equal intervals
        padded = np.pad(values, (0, length * count - len(values)), mode='edge')
        table = padded.reshape(count, length)
        starts = np.arange(count) * length
        extremes = np.stack([table.argmin(axis=1) + starts, table.argmax(axis=1) + starts])
        # In order of time and without duplicates; index 0 keeps the start of the line
        keep = np.unique(np.clip(np.append(extremes.ravel(), 0), 0, len(time) - 1))
        time, values = time[keep], values[keep]
    # Half the size of the page's data
    return time.astype(np.float32), values.astype(np.float32)


def build_line_trace(
    name: str,
    time: Array,
    values: Array,
    colour: str,
    *,
    unit: str,
    width: float = 1.6,
    dash: str = 'solid',
    steps: bool = False,
) -> Scatter:
    """Return a thin line; with `steps`, values are held between messages."""
    x, y = decimate_line(time, values)
    return Scatter(
        x=x,
        y=y,
        name=name,
        mode='lines',
        line={'color': colour, 'width': width, 'dash': dash, 'shape': 'hv' if steps else 'linear'},
        hovertemplate=f'%{{y:.3~f}} {unit}',
    )


def build_dot_trace(name: str, time: Array, values: Array, colour: str, *, unit: str) -> Scatter:
    """Return raw measurements as small dots."""
    x, y = decimate_line(time, values)
    return Scatter(
        x=x,
        y=y,
        name=name,
        mode='markers',
        marker={'color': colour, 'size': 2.5},
        hovertemplate=f'%{{y:.3~f}} {unit}',
    )


def padded_range(*lines: Array, pad: float = 0.08) -> tuple[float, float]:
    """Return the range of all finite values with a margin."""
    values = np.concatenate([part[np.isfinite(part)] for part in lines])
    if not len(values):
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    # A constant line gets a tenth of its value, and zero gets 1
    air = pad * (high - low) or 0.1 * abs(high) or 1.0
    return low - air, high + air


def label_ends(
    figure: Figure, labels: Sequence[EndLabel], bounds: tuple[float, float], row: int = 1
) -> None:
    """
    Add labels at the ends of lines, moved apart where they would overlap.

    `bounds`: lower and upper end of the y axis, which are set as its range. `row`: row of the
    lines, from 1.
    """
    low, high = bounds
    gap = 0.085 * (high - low)  # least distance of two labels: a line of text
    heights: list[float] = []
    ordered = sorted(labels, key=lambda label: label.height)
    # Upwards: push each label above the one below it
    for label in ordered:
        height = min(max(label.height, low), high)
        heights.append(max(height, heights[-1] + gap) if heights else height)
    # Downwards: push labels back that left the axis at the top
    for k in range(len(heights) - 1, -1, -1):
        ceiling = high if k == len(heights) - 1 else heights[k + 1] - gap
        heights[k] = min(heights[k], ceiling)
    for label, height in zip(ordered, heights, strict=True):
        figure.add_annotation(
            x=1.0,
            xref='x domain',
            y=height,
            xanchor='left',
            xshift=6,
            text=label.text,
            font={'color': label.colour, 'size': 11},
            row=row,
            col=1,
        )
    # Long labels get more space than the margin that figures over time share
    longest = max((len(label.text) for label in labels), default=0)
    if longest > FITTING:
        right = figure.layout.margin.r or RIGHT
        figure.update_layout(margin_r=max(right, 8 + LETTER * longest))
    figure.update_yaxes(range=[low, high], row=row)
