# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plot the floor from above: coverage with gaps, and hand-overs."""

from collections.abc import Sequence
from itertools import pairwise
import math
from typing import Final

from lta_report.drawing import add_legend, create_figure
from lta_report.palette import (
    build_color_scale,
    ESTIMATE,
    GOOD,
    HEAT,
    INK,
    LAMP,
    PAPER,
    RAW,
    TRUTH,
    VEIL,
    WALL,
)
from lta_studies.light.plan.layout import LampHandover, LampLayout, Place
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure, Heatmap, Scatter

SCALE_STEPS: Final = (1, 2, 5)  # labels of the colour scale, times powers of ten
HALL_MARGIN: Final = 0.02  # margin around the hall, as a share of its longer side
SIDEWAYS_SHARE: Final = 0.4  # horizontal part of the axis above which a lamp is drawn as an arrow
CHARACTER: Final = 6.0  # px, width of a character of a label


def plot_coverage(layout: LampLayout) -> Figure:
    """Plot the SNR of the best received lamp, the lamps, and the gaps hatched."""
    figure = create_floor_figure(layout)
    floor = layout.floor
    best = np.full(floor.target_cells.shape, np.nan)
    names = np.full(floor.target_cells.shape, '', dtype=object)
    best[floor.target_cells] = layout.snr.max(axis=0)
    names[floor.target_cells] = [layout.lamps[k].name for k in layout.snr.argmax(axis=0)]
    low, high = color_range(layout)
    figure.add_trace(
        Heatmap(
            x=floor.x.astype(np.float32), y=floor.y.astype(np.float32),
            # Logarithmic colours; below the required SNR all cells look the same.
            z=np.log10(np.clip(best, 10.0**low, None)).astype(np.float32),
            customdata=np.stack([np.round(best, 1).astype(object), names], axis=-1),
            zmin=low, zmax=high, colorscale=build_color_scale(HEAT), hoverongaps=False,
            hovertemplate='SNR %{customdata[0]} of %{customdata[1]}<extra></extra>',
            colorbar={
                'title': {'text': 'SNR', 'side': 'top'}, 'thickness': 12, 'len': 0.9,
                'tickvals': [math.log10(t) for t in choose_ticks(low, high)],
                'ticktext': [f'{t:g}' for t in choose_ticks(low, high)], 'outlinewidth': 0,
            },
        )
    )  # fmt: skip
    hatch_gaps(figure, layout)
    draw_lamps(figure, layout)
    return figure


def plot_handovers(layout: LampLayout, handover: LampHandover) -> Figure:
    """Plot the ends of flights to lamps, the hand-overs between them, and the route."""
    figure = create_floor_figure(layout)
    ends = handover.arrivals
    ways = [(a, b) for i, j in handover.edges if (a := ends[i]) and (b := ends[j])]
    draw_ways(figure, ways, RAW, 1.2, 'hand-over')
    stops = [handover.start, *(ends[k] for k in handover.route)]
    known_stops = [stop for stop in stops if stop is not None]
    draw_ways(figure, list(pairwise(known_stops)), GOOD, 3.0, 'route')
    reached = [place for place in ends if place is not None]
    figure.add_trace(
        Scatter(
            x=[x for x, _ in reached], y=[y for _, y in reached], mode='markers',
            name='end of the flight to a lamp',
            marker={'size': 6, 'color': PAPER, 'line': {'color': TRUTH, 'width': 1.5}},
            hovertemplate='a flight to the lamp ends here<extra></extra>',
        )
    )  # fmt: skip
    if handover.start is not None:
        x, y = handover.start
        figure.add_annotation(
            x=x, y=y, text='start', yshift=-14, font={'color': GOOD, 'size': 11}, bgcolor=VEIL
        )
    draw_lamps(figure, layout)
    return add_legend(figure)


def create_floor_figure(layout: LampLayout) -> Figure:
    """Return a figure with the walls and obstacles."""
    plan = layout.plan
    figure = create_figure()
    corners = plan.outline.corners
    low, high = corners.min(axis=0), corners.max(axis=0)
    air = HALL_MARGIN * float((high - low).max())
    bare = {'showgrid': False, 'constrain': 'domain'}
    figure.update_xaxes(title_text='x [m]', range=[low[0] - air, high[0] + air], **bare)
    figure.update_yaxes(
        title_text='y [m]', range=[low[1] - air, high[1] + air],
        scaleanchor='x', constraintoward='top', **bare,
    )  # fmt: skip
    for obstacle in plan.obstacles.values():
        for footprint in obstacle.footprints:
            figure.add_shape(
                type='path', path=format_svg_path(footprint), layer='below', line={'width': 0},
                fillcolor=RAW,
            )  # fmt: skip
    figure.add_shape(
        type='path', path=format_svg_path(corners), layer='below', line={'color': WALL, 'width': 3}
    )
    return figure.update_layout(hovermode='closest', margin={'l': 48, 'r': 16, 't': 12, 'b': 40})


def format_svg_path(corners: NDArray[np.float64]) -> str:
    """Return the SVG path of a polygon."""
    return 'M ' + ' L '.join(f'{x:g} {y:g}' for x, y in corners) + ' Z'


def color_range(layout: LampLayout) -> tuple[float, float]:
    """Return the range of the colour scale, as log10 of the SNR."""
    low = math.log10(layout.ear.required_snr)
    # The 98 % quantile ignores peaks next to lamps; the scale spans at least half a decade.
    best = layout.snr.max(axis=0)
    return low, max(math.log10(max(float(np.quantile(best, 0.98)), 1e-9)), low + 0.5)


def choose_ticks(low: float, high: float) -> list[float]:
    """Return round numbers between 10**low and 10**high."""
    decades = range(math.floor(low), math.ceil(high) + 1)
    steps = [step * 10.0**k for k in decades for step in SCALE_STEPS]
    return [step for step in steps if low <= math.log10(step) <= high]


def hatch_gaps(figure: Figure, layout: LampLayout) -> None:
    """Hatch the cells that receive too few lamps."""
    floor, half = layout.floor, 0.5 * layout.floor.cell
    grid = np.zeros(floor.target_cells.shape, dtype=bool)
    grid[floor.target_cells] = layout.received_count < layout.overlap
    x: list[float | None] = []
    y: list[float | None] = []
    for row, line in enumerate(grid):
        # Start and end of each run of gap cells in the row: one rectangle per run
        edges = np.flatnonzero(np.diff(np.concatenate([[False], line, [False]]).astype(int)))
        for first, last in edges.reshape(-1, 2):
            west, east = float(floor.x[first]) - half, float(floor.x[last - 1]) + half
            south, north = float(floor.y[row]) - half, float(floor.y[row]) + half
            x += [west, east, east, west, west, None]
            y += [south, south, north, north, south, None]
    if x:
        figure.add_trace(
            Scatter(
                x=x, y=y, mode='lines', fill='toself', line={'width': 0}, name='gap',
                hoverinfo='skip', fillcolor=PAPER,
                fillpattern={'shape': '/', 'fgcolor': ESTIMATE, 'size': 6, 'solidity': 0.4,
                             'fillmode': 'overlay'},
            )
        )  # fmt: skip


def draw_lamps(figure: Figure, layout: LampLayout) -> None:
    """Draw the lamps in their direction, with the numbers that the table lists."""
    facing = [lamp.mount.axis[:2] for lamp in layout.lamps]
    sideways = [math.hypot(*axis) > SIDEWAYS_SHARE for axis in facing]
    figure.add_trace(
        Scatter(
            x=[lamp.mount.position[0] for lamp in layout.lamps],
            y=[lamp.mount.position[1] for lamp in layout.lamps],
            mode='markers', name='lamp', cliponaxis=False,
            marker={
                'symbol': ['triangle-up' if side else 'circle' for side in sideways], 'size': 13,
                'color': LAMP, 'line': {'color': PAPER, 'width': 1.5},
                'angle': [
                    # Plotly turns markers clockwise from up, the axis is counter-clockwise from x.
                    90.0 - math.degrees(math.atan2(y, x)) if side else 0.0
                    for (x, y), side in zip(facing, sideways, strict=True)
                ],
            },
            customdata=[[lamp.name, lamp.frequency] for lamp in layout.lamps],
            hovertemplate='%{customdata[0]}, %{customdata[1]} Hz<extra></extra>',
        )
    )  # fmt: skip
    for k, lamp in enumerate(layout.lamps):
        along, up = lamp.mount.axis[:2] if sideways[k] else (0.0, 1.0)
        # Half the width of the label, plus a gap [px]
        reach = 14.0 + CHARACTER * len(str(k + 1)) / 2.0
        figure.add_annotation(
            x=lamp.mount.position[0], y=lamp.mount.position[1], xshift=reach * along,
            yshift=18.0 * up, text=f'<b>{k + 1}</b>', font={'color': INK, 'size': 10},
            bgcolor=VEIL, borderpad=1,
        )  # fmt: skip


def draw_ways(
    figure: Figure, ways: Sequence[tuple[Place, Place]], colour: str, width: float, name: str
) -> None:
    """Draw straight lines between places as one trace."""
    figure.add_trace(
        Scatter(
            x=[x for (a, _), (b, _) in ways for x in (a, b, None)],
            y=[y for (_, a), (_, b) in ways for y in (a, b, None)],
            mode='lines', name=name, hoverinfo='skip', line={'color': colour, 'width': width},
        )
    )  # fmt: skip
