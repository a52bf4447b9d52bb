"""Plot the strategies beside the paper, and one flight of each from above."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Final, final

from lta_flight.loop_view import LoopView
from lta_flight.report.room import choose_tick_distance, draw_room
from lta_flight.sweep.plan import SweepPlan
from lta_flight.sweep.statistics import BootstrapMean, ShareInterval
from lta_model.scenario import Scenario
from lta_report.curves import Array
from lta_report.drawing import create_figure
from lta_report.palette import ESTIMATE, GOOD, INK, LAMP, PAPER, SOFT, TIME, TRUTH
from lta_studies.reproduce.pilot import PILOT, prepare_flight
from lta_studies.reproduce.strategy_flights import StrategyFlights
import numpy as np
from plotly.graph_objects import Figure, Scatter

STRATEGY_COLOURS: Final[Mapping[str, str]] = {
    'bag': TRUTH, 'dga': LAMP, 'des': ESTIMATE, 'homing': GOOD, PILOT: SOFT,
}  # fmt: skip
STRATEGY_LABELS: Final[Mapping[str, str]] = {
    'bag': 'BAG', 'dga': 'DGA', 'des': 'DES', 'homing': 'homing', PILOT: 'pilot',
}  # fmt: skip
SYMBOLS: Final[Mapping[str, str]] = {
    'bag': 'circle', 'dga': 'square', 'des': 'diamond', 'homing': 'triangle-up', PILOT: 'x',
}  # fmt: skip
# Path [m] and time [s] of the indoor flights that the seed paper prints; None if not printed
PAPER_FLIGHTS: Final[Mapping[str, tuple[float, float | None]]] = {
    'bag': (7.3, 8.4), 'dga': (8.6, 21.4), 'des': (12.2, None),
}  # fmt: skip
Interval = BootstrapMean | ShareInterval
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


def label_strategy(name: str) -> str:
    """Return the label of a strategy."""
    return STRATEGY_LABELS.get(name, name)


def strategy_color(strategy: str) -> str:
    """Return the colour of a strategy, the same in every plot."""
    return STRATEGY_COLOURS.get(strategy, TIME[0])


def none_if_nan(length: float) -> float | None:
    """Return a number; None if it is NaN."""
    return None if math.isnan(length) else length


def build_markers(strategy: str, value: Interval) -> Scatter:
    """Return the marker of one strategy with its interval."""
    shade = strategy_color(strategy)
    return Scatter(
        x=[label_strategy(strategy)], y=[none_if_nan(value.value)],
        error_y={
            'type': 'data', 'symmetric': False, 'thickness': 1.4, 'width': 5, 'color': shade,
            'array': [none_if_nan(value.high - value.value)],
            'arrayminus': [none_if_nan(value.value - value.low)],
        },
        mode='markers', name=label_strategy(strategy), showlegend=False,
        marker={'color': shade, 'size': 8, 'symbol': SYMBOLS.get(strategy, 'circle')},
        hovertemplate='%{y:.3~g}',
    )  # fmt: skip


def plot_paper_comparison(cells: Sequence[StrategyFlights]) -> Figure:
    """Plot path, time and success of each strategy indoors, with the paper's flights."""
    figure = create_figure(3, [0.42, 0.34, 0.24])
    for cell in cells:
        intervals: tuple[Interval, ...] = (
            cell.mean('path_length'),
            cell.mean('search_time'),
            cell.reached_share,
        )
        for row, value in enumerate(intervals, start=1):
            figure.add_trace(build_markers(cell.strategy, value), row=row, col=1)
    strategies = [cell.strategy for cell in cells if cell.strategy in PAPER_FLIGHTS]
    for row in (1, 2):
        figure.add_trace(
            Scatter(
                x=[label_strategy(name) for name in strategies],
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
    figure.update_yaxes(
        title_text='reached', range=[-0.06, 1.06], tickvals=[0, 0.5, 1], tickformat='.0%', row=3
    )
    figure.update_xaxes(type='category')
    return figure.update_layout(FIGURE_LAYOUT)


TRACK_POINTS = 400  # points of a track, at most about twice that
ROOM_MARGIN = 0.25  # m of blank space around the room


@final
@dataclass(frozen=True, slots=True)
class FlownTrack:
    """Ground track of one flight over time. [s], [m, map]"""

    strategy: str
    time: Array
    x: Array
    y: Array
    reached: bool


def select_track_seed(cells: Sequence[StrategyFlights]) -> int:
    """Return the first seed in which the most strategies reach the lamp."""
    seeds = sorted({seed for cell in cells for seed in cell.rows})
    # -seed: of equal seeds the first
    return max(seeds, key=lambda seed: (sum(seed in cell.arrivals for cell in cells), -seed))


def fly_again(
    plan: SweepPlan, cells: Sequence[StrategyFlights], seed: int
) -> tuple[list[FlownTrack], Scenario]:
    """Repeat the flights of one seed, since rows do not store tracks."""
    flight_tracks = []
    for cell in cells:
        if seed not in cell.rows:
            continue
        row = cell.rows[seed]
        loop = prepare_flight(plan, plan.build_job(row.index))
        view = LoopView(loop)
        for _ in loop.iterate_steps():
            view.record_step()
        truth = view.truth
        # Integer division, so the step is too small rather than too large.
        keep = slice(None, None, max(1, len(truth.x) // TRACK_POINTS))
        way = (truth.time[keep], truth.x[keep], truth.y[keep])
        flight_tracks.append(FlownTrack(cell.strategy, *way, seed in cell.arrivals))
    return flight_tracks, loop.world.scenario


def plot_tracks(tracks: Sequence[FlownTrack], scenario: Scenario, height: float) -> Figure:
    """Plot some tracks in their room."""
    figure = create_figure()
    draw_room(figure, scenario, height)
    figure.update_traces(showlegend=False)
    for each in tracks:
        shade = strategy_color(each.strategy)
        figure.add_trace(
            Scatter(
                x=each.x.astype(np.float32), y=each.y.astype(np.float32), mode='lines',
                name=label_strategy(each.strategy), line={'color': shade, 'width': 1.8},
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
