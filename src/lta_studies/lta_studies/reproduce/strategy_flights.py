# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Group flights by strategy and case, and compute statistics with bootstrap intervals."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
import math
from typing import Final, final

from lta_control.laws.cascade import CascadeGains
from lta_control.motion import yaw_from_quaternion
from lta_control.strategies.protocol import (
    LightMeasurement,
    Memory,
    NavigationStrategy,
    SteeringCommand,
)
from lta_control.strategies.settings import CruiseSettings
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_loop
from lta_flight.loop_view import LoopView
from lta_flight.report.path import choose_tick_distance, draw_room
from lta_flight.sweep.batch_workers import FAILED, SweepRow
from lta_flight.sweep.plan import SweepJob, SweepPlan
from lta_flight.sweep.statistics import (
    BOOTSTRAP_DRAWS,
    bootstrap_mean,
    BOOTSTRAP_SEED,
    BootstrapMean,
    format_value,
    is_number,
    REACHED,
    ShareInterval,
    wilson_interval,
)
from lta_model.scenario import Scenario
from lta_model.state import QUATERNION
from lta_report.curves import Array
from lta_report.drawing import create_figure
from lta_report.palette import ESTIMATE, GOOD, INK, LAMP, PAPER, SOFT, TIME, TRUTH
from lta_sim.world import World
import numpy as np
from plotly.graph_objects import Figure, Scatter

STRATEGY_PATH: Final = 'strategy'
FEWEST_VALUES: Final = 5  # values of an order; the bootstrap is overconfident with fewer


@final
@dataclass(frozen=True, slots=True)
class StrategyFlights:
    """All seeds of one strategy in one case, of flights that could be simulated."""

    strategy: str
    case: str  # label of the case: its name, its values in SI units, or both
    place: float  # number that the cases vary, in SI units; NaN without one
    rows: Mapping[int, SweepRow]  # by seed

    @property
    def reached_share(self) -> ShareInterval:
        """Share of the flights that reached the lamp, with its Wilson interval."""
        return wilson_interval(len(self.arrivals), len(self.rows))

    @property
    def arrivals(self) -> dict[int, SweepRow]:
        """Flights that reached the lamp, by seed."""
        return {seed: row for seed, row in self.rows.items() if row.outcome == REACHED}

    def arrival_values(self, name: str) -> dict[int, float]:
        """Return a figure of the flights that reached the lamp, by seed."""
        values = {seed: row.figures.get(name) for seed, row in self.arrivals.items()}
        return {seed: float(value) for seed, value in values.items() if value is not None}

    def mean(self, name: str) -> BootstrapMean:
        """Return the mean of a figure over the flights that reached the lamp."""
        return bootstrap_mean(list(self.arrival_values(name).values()))


def group_flights(rows: Iterable[SweepRow]) -> list[StrategyFlights]:
    """Return flights by case and strategy, in the order of their sweep."""
    grouped: dict[tuple[str, str], list[SweepRow]] = {}
    # The order of the sweep, by the index of the first flight
    for row in sorted(rows, key=lambda row: row.index):
        values = [value for path, value in row.values.items() if path != STRATEGY_PATH]
        case = ', '.join(map(format_value, values))
        grouped.setdefault((case, row.values[STRATEGY_PATH]), []).append(row)
    return [
        StrategyFlights(
            strategy,
            case,
            next((float(value) for value in own[0].values.values() if is_number(value)), math.nan),
            {row.seed: row for row in own if row.outcome != FAILED},
        )
        for (case, strategy), own in grouped.items()
    ]


def ordered_share(values: Sequence[Sequence[float]]) -> float:
    """Return the share of bootstrap draws with ascending means; NaN with too few values."""
    if min(map(len, values)) < FEWEST_VALUES:
        return math.nan
    chance = np.random.default_rng(BOOTSTRAP_SEED)
    means = [
        # Strategies are resampled separately: different seeds arrive with each.
        np.array(own)[chance.integers(len(own), size=(BOOTSTRAP_DRAWS, len(own)))].mean(axis=1)
        for own in values
    ]
    rises = np.all([a < b for a, b in pairwise(means)], axis=0)
    return float(rises.mean())


PILOT = 'pilot'
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
    'hovermode': 'closest',
    'showlegend': True,
    'legend': LEGEND_ABOVE,
    'margin': {'r': 16, 't': 26},
}


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
    """Ground track of one flight over time [s], [m, map]."""

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


WIND_FILTER_TIME = 5.0  # s, time constant of the low-pass filter of the wind
LEAST_GROUND_SHARE = (
    0.5  # share of the cruise speed over ground below which the pilot flies faster
)


def build_pilot_strategy(world: World, top: float) -> NavigationStrategy:
    """
    Return a strategy that uses the true state of the world instead of the light.

    `world`: simulated world. `top`: airspeed limit of the controller [m/s].
    """
    lamp_x, lamp_y, _ = world.scenario.goal_lamp.position.vector

    def start(heading: float) -> Memory:
        return (heading,)

    def steer(
        settings: CruiseSettings, memory: Memory, sight: LightMeasurement
    ) -> tuple[SteeringCommand, Memory]:
        towards = math.atan2(lamp_y - float(world.state[1]), lamp_x - float(world.state[0]))
        c, s = math.cos(towards), math.sin(towards)
        x, y, _ = world.wind
        # The first call has no filtered wind yet and takes the current one.
        if len(memory) > 1:
            # First-order low-pass filter, discretised; at most 1 for long intervals
            share = min(sight.interval / WIND_FILTER_TIME, 1.0)
            x, y = memory[1] + share * (x - memory[1]), memory[2] + share * (y - memory[2])
        # Wind along the track and to the left of it
        along, left = solve_wind_triangle(x * c + y * s, y * c - x * s, settings.speed, top)
        qx, qy, qz, qw = world.state[QUATERNION].tolist()
        # The drone's heading is relative to its start; correct it by the true heading.
        turn = towards + math.atan2(left, along) - yaw_from_quaternion((qx, qy, qz, qw))
        heading = sight.heading + math.remainder(turn, math.tau)
        return SteeringCommand(heading, math.hypot(along, left)), (heading, x, y)

    return NavigationStrategy(PILOT, start, steer)


def solve_wind_triangle(
    with_it: float, across: float, cruise: float, top: float
) -> tuple[float, float]:
    """
    Return the air velocity for a straight track: along the track, and left of it [m/s].

    `with_it`, `across`: wind along the track to the lamp, and to the left of it [m/s]. `cruise`,
    `top`: cruise and maximum airspeed [m/s].
    """
    # Cruise if that makes enough way, else as fast as the controller allows
    for speed in (cruise, max(cruise, top)):
        # Cancel the crosswind as far as the airspeed allows.
        left = min(max(-across, -speed), speed)
        along = math.sqrt(speed * speed - left * left)
        if along + with_it >= LEAST_GROUND_SHARE * cruise and left == -across:
            break
    return along, left


def prepare_flight(plan: SweepPlan, job: SweepJob) -> ClosedLoop:
    """Return the closed loop of a job before its first step; the strategy may be `PILOT`."""
    changes = dict(job.changes)
    piloted = changes[STRATEGY_PATH] == PILOT
    if piloted:
        # The spec needs a real strategy; the pilot replaces it below.
        del changes[STRATEGY_PATH]
    loop = build_loop(plan.base.with_values(changes), job.seed)
    if piloted:
        pilot = build_pilot_strategy(loop.world, top_airspeed(loop))
        loop.policy = replace(loop.policy, strategy=pilot)
    return loop


def top_airspeed(loop: ClosedLoop) -> float:
    """Return the airspeed limit of the controller [m/s]."""
    gains = loop.policy.gains
    # Only the cascade has an airspeed limit.
    return gains.speed_limit if isinstance(gains, CascadeGains) else math.inf
