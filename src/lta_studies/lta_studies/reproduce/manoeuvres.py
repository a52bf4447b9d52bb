# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly entries of the platform comparison for the rows that need them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import final

from lta_config.schema.comparison_file import ComparisonFile, load_comparison, load_maneuver_file
from lta_model.scenario import load_scenario
from lta_studies.platforms.flight import build_entrant, Entrant, fly_maneuver, ManeuverFlight
from lta_studies.platforms.run import (
    ABLATION,
    CONTESTANT,
    fly_job,
    LIMIT,
    PlatformJob,
    PlatformResult,
)
from lta_studies.platforms.summary import (
    ComparisonCell,
    draw_tracking,
    find_top_speed,
    format_entry_name,
)
from lta_studies.reproduce.study_result import MeasuredValue, RowStudyRequest
from plotly.graph_objects import Figure

COMPARISON_FILE = 'platforms'  # the comparison file


@final
@dataclass(frozen=True, slots=True)
class ComparisonFlights:
    """Some flights of the comparison."""

    comparison: ComparisonFile
    rows: Sequence[PlatformResult]

    def find_cell(self, name: str, manoeuvre: str) -> ComparisonCell:
        """Return all seeds of an entry in a manoeuvre."""
        return ComparisonCell(
            [r for r in self.rows if r.job.name == name and r.job.manoeuvre == manoeuvre]
        )

    def metric_value(
        self, name: str, manoeuvre: str, figure: str, of: str = 'metrics'
    ) -> MeasuredValue:
        """Return a metric of an entry with its interval; NaN if no seed has it."""
        cell = self.find_cell(name, manoeuvre)
        mean = cell.mean_metric(figure, of)
        return MeasuredValue(mean.value, mean.low, mean.high, len(cell.rows))

    def success_share(self, name: str, manoeuvre: str) -> MeasuredValue:
        """Return the share of flights that held a manoeuvre."""
        cell = self.find_cell(name, manoeuvre)
        # One flight gives no interval.
        if len(cell.rows) == 1:
            return MeasuredValue(cell.success_share.value, seeds=1)
        return MeasuredValue(*cell.success_share, seeds=len(cell.rows))

    def plot_tracking(self, manoeuvre: str, names: Iterable[str]) -> Figure:
        """Plot setpoint and response of each entry, for seed 1."""
        titles = {name: self.entry_title(name) for name in names}
        selected = [
            replace(row, job=replace(row.job, kind=CONTESTANT))  # draw ablations as contestants
            for row in self.rows
            if row.job.name in titles
        ]
        return draw_tracking(selected, titles, load_maneuver_file(manoeuvre))

    def entry_title(self, name: str) -> str:
        """Return the title of an entry."""
        contestant = self.comparison.contestants.get(name)
        return contestant.title if contestant else format_entry_name(self.comparison, name)


def fly_entries(pairs: Iterable[tuple[str, str]], seeds: int) -> ComparisonFlights:
    """Fly pairs of entry and manoeuvre, each with the same seeds."""
    comparison = load_comparison(COMPARISON_FILE)
    rows = [
        fly_cached(
            PlatformJob(COMPARISON_FILE, entry_kind(comparison, name), name, manoeuvre, seed)
        )
        for name, manoeuvre in pairs
        for seed in range(1, seeds + 1)
    ]
    return ComparisonFlights(comparison, rows)


def sample_gtmab(request: RowStudyRequest, seed: int) -> Entrant:
    """Return GT-MAB with a draw of what is assumed."""
    comparison = load_comparison(COMPARISON_FILE)
    changed = comparison.contestants['gtmab'].model_copy(
        update={'changes': request.draw_changes(seed)}
    )
    return build_entrant(changed, load_scenario(comparison.scenario).air.density)


def fly_gtmab_draws(
    request: RowStudyRequest, manoeuvres: Sequence[str]
) -> dict[str, list[ManeuverFlight]]:
    """Fly GT-MAB once in every draw of what is assumed; return its flights by manoeuvre."""
    scenario = load_scenario(load_comparison(COMPARISON_FILE).scenario)
    samples = {seed: sample_gtmab(request, seed) for seed in request.draw_seeds}
    return {
        name: [
            fly_maneuver(entrant, scenario, load_maneuver_file(name), seed)
            for seed, entrant in samples.items()
        ]
        for name in manoeuvres
    }


def draw_gtmab(
    request: RowStudyRequest, manoeuvres: Sequence[str]
) -> dict[str, list[float | str]]:
    """Fly GT-MAB once in every draw of what is assumed; return what it held, by measure."""
    return {
        f'gtmab_{name}_held': [float(each.is_successful) for each in flights]
        for name, flights in fly_gtmab_draws(request, manoeuvres).items()
    }


def find_speed_limit(name: str, seeds: int) -> MeasuredValue:
    """Return the highest speed up to which an entry held all commanded speeds [m/s]."""
    comparison = load_comparison(COMPARISON_FILE)
    limit = comparison.limits[name]
    rows = [
        fly_cached(PlatformJob(COMPARISON_FILE, LIMIT, name, limit.manoeuvre, seed, speed))
        for speed in limit.speeds.vector
        for seed in range(1, seeds + 1)
    ]
    return MeasuredValue(find_top_speed(comparison, rows, name)[0], seeds=seeds)


@cache
# Deterministic by its seed, so a cached result equals a new one.
def fly_cached(job: PlatformJob) -> PlatformResult:
    """Fly a job, once for all rows that share it."""
    return fly_job(job)


def entry_kind(comparison: ComparisonFile, name: str) -> str:
    """Return whether a name is a contestant or an ablation."""
    return CONTESTANT if name in comparison.contestants else ABLATION
