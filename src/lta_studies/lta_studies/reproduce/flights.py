# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly the navigation rows: parts of the sweeps that compare the strategies."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
import math
from typing import Any, final

from lta_config.command_line import format_lta_command
from lta_config.schema.sweep_file import load_sweep, SweepSeeds
from lta_flight.flight_spec import to_set_args
from lta_flight.sweep.batch_workers import BatchWorkers, run_job, SweepRow
from lta_flight.sweep.plan import SweepJob, SweepPlan
from lta_flight.sweep.statistics import BootstrapMean, REACHED, ShareInterval
from lta_studies.reproduce.strategy_flights import (
    group_flights,
    prepare_flight,
    STRATEGY_PATH,
    StrategyFlights,
)
from lta_studies.reproduce.study_result import MeasuredValue, RowStudyRequest
from plotly.graph_objects import Figure

PAPERS = ('bag', 'dga', 'des')  # strategies of the paper, the shortest path first
BATCHED = 100  # draws from which on it pays to compile a batch
FLIGHTS_A_DRAW = 3  # of which the rate of a draw is that most of them show
SEEDS_APART = 100_000  # between the flights of one draw, above any number of draws


@final
@dataclass(frozen=True, slots=True)
class FlightGroup:
    """Flights of a sweep by strategy and case, with their plan."""

    plan: SweepPlan
    cells: Sequence[StrategyFlights]

    def find_cell(self, strategy: str, case: str = '') -> StrategyFlights:
        """Return the flights of a strategy in the first case whose name starts with `case`."""
        return next(
            each for each in self.cells
            if each.strategy == strategy and each.case.startswith(case)
        )  # fmt: skip

    def find_cells(self, case: str = '') -> dict[str, StrategyFlights]:
        """Return the flights of all strategies in a case, by strategy."""
        return {each.strategy: each for each in self.cells if each.case.startswith(case)}


def fly_job(plan: SweepPlan, job: SweepJob) -> SweepRow:
    """Fly a job of a plan, whose strategy may be the pilot."""
    return run_job(job, lambda: prepare_flight(plan, job))


def fly_group(
    sweep: str,
    seeds: int,
    *,
    strategies: Sequence[str] = PAPERS,
    cases: Sequence[str] = (),
    vary: Mapping[str, Sequence[Any]] | None = None,
    change: Mapping[str, Any] | None = None,
) -> FlightGroup:
    """
    Fly part of a sweep, each strategy with the same seeds.

    Parameters
    ----------
    sweep : str
        Name of a sweep file that varies the strategy.
    seeds : int
        Flights per strategy and case.
    strategies, cases : sequence of str
        What to fly; all cases if none is named.
    vary, change : mapping, optional
        Replaced sweep axes, and additional settings.

    """
    file = load_sweep(sweep)
    plan = SweepPlan(
        file.model_copy(
            update={
                'seeds': SweepSeeds(first=file.seeds.first, count=seeds),
                'cases': {k: v for k, v in file.cases.items() if not cases or k in cases},
                'vary': {**file.vary, **(vary or {}), STRATEGY_PATH: list(strategies)},
                'settings': {**file.settings, **(change or {})},
            }
        )
    )
    # One after the other: the rows of the reproduction already run in parallel.
    jobs = map(plan.build_job, range(plan.count))
    return FlightGroup(plan, group_flights(fly_job(plan, job) for job in jobs))


def fly_draws(
    sweep: str,
    request: RowStudyRequest,
    *,
    strategies: Sequence[str] = PAPERS,
    change: Mapping[str, Any] | None = None,
    flights: int = 1,
) -> dict[str, list[list[SweepRow]]]:
    """
    Fly part of a sweep in each draw of what is assumed; return the flights by strategy and draw.

    Many are flown as a batch, which compiles for minutes and then flies hundreds a minute; a few
    are flown one after the other.
    """
    file = load_sweep(sweep)
    cut = {
        'seeds': SweepSeeds(first=1, count=1),
        'cases': {},
        'vary': {STRATEGY_PATH: [*strategies]},
    }
    settings = {**file.settings, **(change or {})}
    plan = SweepPlan(file.model_copy(update={**cut, 'settings': settings}))
    changes = {seed: request.draw_changes(seed) for seed in request.draw_seeds}
    jobs = [
        SweepJob(index, seed + again * SEEDS_APART, {STRATEGY_PATH: name, **changes[seed]})
        for index, (name, seed, again) in enumerate(product(strategies, changes, range(flights)))
    ]
    if len(changes) < BATCHED:
        rows = [fly_job(plan, job) for job in jobs]
    else:
        # A batch may return flights of other strategies in between
        results = {job.index: row for job, row in BatchWorkers(plan.base, 'cpu-batch').run(jobs)}
        rows = [results[job.index] for job in jobs]
    draws = [rows[k : k + flights] for k in range(0, len(rows), flights)]
    count = len(changes)
    return {name: draws[k * count : (k + 1) * count] for k, name in enumerate(strategies)}


def summarize_draws(
    name: str, draws: Sequence[Sequence[SweepRow]]
) -> dict[str, list[float | str]]:
    """Return the share that arrives, path [m] and time [s] of one flight; NaN if it did not."""
    return {
        f'{name}_reached': [
            sum(row.outcome == REACHED for row in flights) / len(flights) for flights in draws
        ],
        f'{name}_path': [arrival_figure(first, 'path_length') for first, *_ in draws],
        f'{name}_time': [arrival_figure(first, 'search_time') for first, *_ in draws],
    }


def arrival_figure(row: SweepRow, name: str) -> float:
    """Return a figure of a flight that reached the lamp, else NaN."""
    value = row.figures.get(name) if row.outcome == REACHED else None
    return math.nan if value is None else float(value)


def to_measured_value(mean: BootstrapMean) -> MeasuredValue:
    """Convert a bootstrap mean to a measured value."""
    return MeasuredValue(mean.value, mean.low, mean.high, mean.flights)


def measure_success_share(cell: StrategyFlights) -> MeasuredValue:
    """Return the share of flights that reached the lamp, with its Wilson interval."""
    share: ShareInterval = cell.reached_share
    if len(cell.rows) == 1:  # no interval from a single flight
        return MeasuredValue(share.value, math.nan, math.nan, 1)
    return MeasuredValue(share.value, share.low, share.high, len(cell.rows))


def summarize_cell(name: str, cell: StrategyFlights) -> dict[str, MeasuredValue]:
    """Return share, path [m] and time [s] of the flights of a cell."""
    return {
        f'{name}_reached': measure_success_share(cell),
        f'{name}_path': to_measured_value(cell.mean('path_length')),
        f'{name}_time': to_measured_value(cell.mean('search_time')),
    }


def format_command(group: FlightGroup, cell: StrategyFlights, seed: int) -> str:
    """Return the command that repeats one flight of a cell."""
    base, row = group.plan.base, cell.rows[seed]
    # The changes of the flight override those of the plan.
    changes = {**base.replaced, **group.plan.build_job(row.index).changes}
    strategy = str(changes.pop(STRATEGY_PATH))
    sets = [word for each in to_set_args(changes) for word in ('--set', each)]
    return format_lta_command(
        'simulate', '--scenario', base.names['scenario'], '--strategy', strategy, '--seed',
        str(seed), *sets,
    )  # fmt: skip


def thin_annotations(figure: Figure) -> Figure:
    """Remove labels and ticks of a top view that would overlap on a small figure."""
    figure.layout.annotations = [
        each for each in figure.layout.annotations if not each.text.startswith('goal')
    ]
    # px to the left, where no track begins
    figure.for_each_annotation(lambda word: word.update(xshift=-24), {'text': 'start'})
    return figure.update_xaxes(dtick=10).update_yaxes(dtick=10)
