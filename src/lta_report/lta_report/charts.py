# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Generic figures of studies: lines and dots over one axis, polar curves, and stacked bars."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
import math
from typing import Any, Final, final, Literal

from lta_report.drawing import add_legend, create_figure, EndLabel, label_ends, padded_range
from lta_report.palette import ESTIMATE, GOOD, GRID, INK, LAMP, SETPOINT, SOFT, TIME, TRUTH, WALL
import numpy as np
from plotly.graph_objects import Bar, Figure, Scatter, Scatterpolar

# Colours of items that a study compares, in order; they repeat
ITEM_COLOURS: Final = (TRUTH, ESTIMATE, GOOD, LAMP, SETPOINT, TIME[0], TIME[2], TIME[3])
DOTTED, DASHED = '2px,3px', '4px,3px'


def item_colour(place: int) -> str:
    """Return the colour of an item by its place among those that a figure compares."""
    return ITEM_COLOURS[place % len(ITEM_COLOURS)]


@final
@dataclass(frozen=True, slots=True)
class ChartAxis:
    """An axis: its title and, if they are not chosen by the figure, its ticks and range."""

    title: str
    log: bool = False
    ticks: Sequence[float] = ()
    words: Sequence[str] = ()  # of the ticks; by default their numbers
    range: Sequence[float] | None = None  # of a logarithmic axis in decades
    zero: bool = False  # whether zero is on it
    more: Mapping[str, Any] = field(default_factory=dict)  # further properties, as Plotly has them

    def to_plotly(self) -> dict[str, Any]:
        """Return its properties."""
        look: dict[str, Any] = {'title_text': self.title, **self.more}
        if self.log:
            look |= {'type': 'log'} | ({} if self.ticks or 'dtick' in self.more else {'dtick': 1})
        if self.ticks:
            words = self.words or [f'{each:g}' for each in self.ticks]
            look |= {'tickvals': list(self.ticks), 'ticktext': list(words)}
        if self.range is not None:
            look['range'] = list(self.range)
        if self.zero:
            look['rangemode'] = 'tozero'
        return look


@final
@dataclass(frozen=True, slots=True)
class Curve:
    """A line, dots, or both; NaN and None leave a gap."""

    name: str
    x: Iterable[Any]
    y: Iterable[Any]
    colour: str
    hover: str = '%{y:.3~g}'  # Plotly's template, with the unit
    mode: Literal['lines', 'markers', 'lines+markers'] = 'lines'
    dash: str = 'solid'
    width: float = 1.6
    size: float | Sequence[float] = 8  # of dots [px]
    # Lengths of error bars, upwards and downwards; the second is the first by default
    above: Iterable[float | None] | None = None
    below: Iterable[float | None] | None = None
    label: str | None = None  # words at the end of the line, in place of a legend
    more: Mapping[str, Any] = field(default_factory=dict)  # further properties, as Plotly has them

    def to_trace(self) -> Scatter:
        """Return its trace."""
        bars = None if self.above is None else {
            'type': 'data', 'array': list(self.above), 'color': self.colour, 'thickness': 1.4,
            'width': 3, 'symmetric': self.below is None,
            'arrayminus': None if self.below is None else list(self.below),
        }  # fmt: skip
        trace = Scatter(
            x=list(self.x), y=list(self.y), mode=self.mode, name=self.name,
            line={'color': self.colour, 'width': self.width, 'dash': self.dash},
            marker={'color': self.colour, 'size': self.size}, error_y=bars,
            hovertemplate=self.hover or None,
        )  # fmt: skip
        return trace.update(dict(self.more))


@final
@dataclass(frozen=True, slots=True)
class Level:
    """A dotted horizontal line at a value, with words at one of its ends."""

    value: float
    words: str = ''
    right: bool = False
    below: bool = False


def draw_curves(
    curves: Sequence[Curve], x: ChartAxis, y: ChartAxis, *, levels: Sequence[Level] = ()
) -> Figure:
    """Return a figure of curves, with labels at their ends if they have any, else a legend."""
    figure = create_figure()
    figure.add_traces([each.to_trace() for each in curves])
    figure.update_xaxes(x.to_plotly())
    figure.update_yaxes(y.to_plotly())
    for level in levels:
        add_level(figure, level, log=y.log)
    labels = [
        EndLabel(each.label, float(last), each.colour)
        for each in curves
        if each.label is not None and (last := _last_value(each)) is not None
    ]
    if labels:
        bounds = y.range or padded_range(*(np.array(list(each.y), np.float64) for each in curves))
        label_ends(figure, labels, (bounds[0], bounds[1]))
        return figure
    return add_legend(figure).update_layout(showlegend=sum(bool(each.name) for each in curves) > 1)


def _last_value(curve: Curve) -> float | None:
    """Return the last value of a curve that is a number."""
    values = [each for each in curve.y if each is not None and math.isfinite(each)]
    return values[-1] if values else None


def add_level(figure: Figure, level: Level, *, log: bool = False, row: int = 1) -> None:
    """Add a level to a row of a figure, whose y axis may be logarithmic."""
    where = {'row': row, 'col': 1}
    line = {'color': WALL, 'width': 1, 'dash': DOTTED}
    figure.add_hline(y=level.value, line=line, layer='below', **where)
    if level.words:
        figure.add_annotation(
            # On a logarithmic axis annotations take the exponent, while lines take the value
            x=float(level.right), xref='x domain', text=level.words,
            y=math.log10(level.value) if log else level.value, font={'size': 10, 'color': SOFT},
            xanchor='right' if level.right else 'left',
            yanchor='top' if level.below else 'bottom', **where,
        )  # fmt: skip


def draw_polar(curves: Mapping[str, tuple[Sequence[float], str]]) -> Figure:
    """
    Return angles by direction, over one turn counter-clockwise with the nose up.

    `curves`: angles at even directions from 0 [rad], and colour, by name.
    """
    figure = create_figure()
    for name, (angles, colour) in curves.items():
        figure.add_trace(
            Scatterpolar(
                # The first direction again closes the curve
                theta=np.linspace(0.0, 360.0, len(angles) + 1),
                r=np.degrees([*angles, angles[0]]), mode='lines+markers', name=name,
                line={'color': colour, 'width': 1.6}, marker={'size': 6, 'color': colour},
                hovertemplate='%{theta}°: %{r:.2f}°',
            )
        )  # fmt: skip
    look = {'gridcolor': GRID, 'linecolor': GRID, 'tickfont': {'color': SOFT, 'size': 11}}
    return add_legend(figure).update_layout(
        polar={
            'bgcolor': 'rgba(0,0,0,0)',
            'angularaxis': {**look, 'dtick': 45, 'rotation': 90},
            'radialaxis': {**look, 'ticksuffix': '°', 'angle': 22.5, 'rangemode': 'tozero'},
        },
        xaxis={'visible': False}, yaxis={'visible': False}, margin={'b': 30},
        hovermode='closest',
    )  # fmt: skip


def draw_bars(
    names: Sequence[str], parts: Mapping[str, tuple[Sequence[float], str]], title: str, unit: str
) -> Figure:
    """
    Return horizontal bars, one an item, with the sum at its end.

    `parts`: values and colour of each part of the bars, by its name. `title`: of the axis.
    """
    figure = create_figure()
    for name, (values, colour) in parts.items():
        figure.add_trace(
            Bar(
                y=list(names), x=list(values), name=name, marker={'color': colour},
                orientation='h', hovertemplate=f'%{{x:.3~g}} {unit}',
            )
        )  # fmt: skip
    sums = np.sum([values for values, _ in parts.values()], axis=0)
    for name, total in zip(names, sums.tolist(), strict=True):
        figure.add_annotation(
            y=name, x=total, xanchor='left', xshift=6, text=f'{total:.0f}',
            font={'color': INK, 'size': 11},
        )  # fmt: skip
    add_legend(figure).update_layout(
        barmode='stack', bargap=0.35, hovermode='closest', legend_traceorder='normal'
    )
    figure.update_xaxes(title_text=f'{title} [{unit}]', rangemode='tozero')
    return figure.update_yaxes(automargin=True, autorange='reversed')
