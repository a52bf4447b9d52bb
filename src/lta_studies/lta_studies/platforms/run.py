# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly all flights of a comparison by workers.

The flights are independent and seeded, so their order does not matter.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import datetime
from functools import cache
from operator import attrgetter
from typing import Any, Final, final, NamedTuple

from lta_config.schema.comparison_file import (
    ComparisonFile,
    load_comparison,
    load_maneuver_file,
    ManeuverFile,
)
from lta_model.scenario import load_scenario, Scenario
from lta_report.json_value import StoredArray
from lta_report.report import Report
from lta_report.request import argument, option, StudyRequest, StudyRun
from lta_report.results_folder import resolve_folder
from lta_report.study import hash_inputs, Study
from lta_report.study_store import StoreFormat
from lta_studies.platforms.flight import (
    build_entrant,
    Entrant,
    fly_maneuver,
    ManeuverFlight,
    TrackingMetrics,
)
import numpy as np
from pydantic import TypeAdapter

CONTESTANT, ABLATION, LIMIT = 'contestant', 'ablation', 'limit'
TRACE_DECIMATION = 10  # decimation of the traces for plots


@final
@dataclass(frozen=True, slots=True)
class PlatformJob:
    """One flight of an entry in a comparison file."""

    file: str
    kind: str
    name: str
    manoeuvre: str
    seed: int
    speed: float | None = None  # replaces the speed of the manoeuvre [m/s]

    @property
    def key(self) -> str:
        """Name in the store."""
        speed = '' if self.speed is None else f' at {self.speed} m/s'
        return f'{self.kind} {self.name}, {self.manoeuvre}{speed}, seed {self.seed}'


@final
@dataclass(frozen=True, slots=True)
class PlatformResult:
    """Result of a flight; traces are stored for seed 1 only."""

    job: PlatformJob
    held: bool
    metrics: TrackingMetrics
    height: TrackingMetrics
    tilt: float
    lost: str
    speed: float  # along the course, mean of the last quarter [m/s]
    flown: StoredArray = None  # time, altitude, heading, speed
    asked: StoredArray = None


PLATFORM_STORE: Final = StoreFormat(
    'flights.jsonl', 'comparison', 'comparison', TypeAdapter(PlatformResult)
)


@final
class PlatformsRequest(StudyRequest, command='platforms', quick={'seeds': 1}):
    """
    Compare platforms in climb, turn, heading and cruise, each with its own control law.

    A comparison file names contestants (vehicle, control law, gains, changed parameters),
    ablations (one change to a contestant, with its reason) and speed-limit tests. A manoeuvre is a
    file of setpoints over time with a tolerance band. Everything is checked before the first
    flight.

    Finished flights are stored, and repeating the command with the same --out resumes.

    Writes flights.json (SI units) and a page: plots, metrics with their spread over the seeds,
    the effect of each ablation, and each platform's static margin.

    Exit status 0: all flown, whatever the results. 2: bad input, nothing flown. 130: Ctrl-C.

    Example: lta platforms --seeds 3
    """

    file: str = argument(
        'Comparison file, or the name platforms for the shipped file.', default='platforms'
    )
    seeds: int | None = option(
        'Number of flights of each platform; by default as in the comparison file.',
        default=None, low=1,
    )  # fmt: skip

    def run(self, run: StudyRun) -> Report:
        """Return the report of all flights."""
        from lta_studies.platforms.report import build_report

        comparison = load_comparison(self.file)
        # Every vehicle, gains file and manoeuvre is loaded before the first flight
        entries = build_entries(self.file, comparison)
        count = self.seeds or comparison.seeds
        todo = list_jobs(self.file, comparison, count)
        created = datetime.now().astimezone().isoformat(timespec='seconds')
        run.open_folder(resolve_folder(None, comparison.name))
        rows = fly_jobs(entries, todo, run)
        facts = {
            'comparison': self.file, 'seeds': str(count), 'flights': str(len(rows)),
            'created': created,
        }  # fmt: skip
        return build_report(comparison, rows, facts)


class ComparisonEntries(NamedTuple):
    """Everything that the flights of a comparison depend on, besides the seed."""

    scenario: Scenario  # scenario of all flights
    entrants: Mapping[tuple[str, str], Entrant]  # entrants by kind and name
    manoeuvres: Mapping[str, ManeuverFile]  # manoeuvres by name

    @property
    def identity(self) -> str:
        """Hash of everything that determines the flights, except seeds and speeds."""
        parts = [self.scenario.model_dump_json()]
        for name, each in sorted(self.entrants.items()):
            parts += [
                *name, each.vehicle.file.model_dump_json(), each.law.name,
                each.gains.model_dump_json(), str(each.release),
            ]  # fmt: skip
        for manoeuvre, file in sorted(self.manoeuvres.items()):
            parts += [manoeuvre, file.model_dump_json()]
        return hash_inputs(*parts)


def list_jobs(file: str, comparison: ComparisonFile, seeds: int) -> list[PlatformJob]:
    """Return all flights of a comparison."""
    jobs: list[PlatformJob] = []
    for seed in range(1, seeds + 1):
        for name, contestant in comparison.contestants.items():
            own = contestant.manoeuvres or comparison.manoeuvres
            jobs += [PlatformJob(file, CONTESTANT, name, manoeuvre, seed) for manoeuvre in own]
        for name, ablation in comparison.ablations.items():
            jobs += [PlatformJob(file, ABLATION, name, each, seed) for each in ablation.manoeuvres]
        for name, limit in comparison.limits.items():
            jobs += [
                PlatformJob(file, LIMIT, name, limit.manoeuvre, seed, speed)
                for speed in limit.speeds.vector
            ]
    return jobs


@cache
def _load_files(file: str) -> tuple[ComparisonFile, Scenario]:
    comparison = load_comparison(file)
    return comparison, load_scenario(comparison.scenario)


@cache
# Cached, as all seeds and manoeuvres share the entrant.
def _build_entrant(file: str, kind: str, name: str) -> Entrant:
    comparison, scenario = _load_files(file)
    density = scenario.air.density
    if kind == CONTESTANT:
        return build_entrant(comparison.contestants[name], density)
    change = comparison.ablations[name] if kind == ABLATION else comparison.limits[name]
    return build_entrant(comparison.contestants[change.of], density, change)


def build_entries(file: str, comparison: ComparisonFile) -> ComparisonEntries:
    """Build every entry and load every manoeuvre; raise `BadInput` if one is invalid."""
    jobs = list_jobs(file, comparison, 1)
    return ComparisonEntries(
        _load_files(file)[1],
        {(job.kind, job.name): _build_entrant(file, job.kind, job.name) for job in jobs},
        {job.manoeuvre: load_maneuver_file(job.manoeuvre) for job in jobs},
    )


def replace_speeds(manoeuvre: ManeuverFile, speed: float | None) -> ManeuverFile:
    """Return the manoeuvre with its positive speeds replaced [m/s]."""
    if speed is None:
        return manoeuvre
    rows = [
        row.model_copy(update={'speed': row.speed.model_copy(update={'value': speed})})
        # Rows with speed 0 are the hover before or after, which stays.
        if row.speed.si > 0.0 else row
        for row in manoeuvre.course
    ]  # fmt: skip
    return manoeuvre.model_copy(update={'course': rows})


def fly_job(job: PlatformJob) -> PlatformResult:
    """Fly one job; workers call this."""
    flight = fly_maneuver(
        _build_entrant(job.file, job.kind, job.name),
        _load_files(job.file)[1],
        replace_speeds(load_maneuver_file(job.manoeuvre), job.speed),
        job.seed,
    )
    return summarize_flight(job, flight)


def summarize_flight(job: PlatformJob, flight: ManeuverFlight) -> PlatformResult:
    """Return the result of a flight with decimated traces."""
    count = len(flight.flown)
    # Column 3 is the speed along the course.
    last = flight.flown[3 * count // 4 :, 3]
    traces = {}
    if job.seed == 1:
        for name in ('flown', 'asked'):
            # Decimated and in single precision: results travel between processes.
            traces[name] = getattr(flight, name)[::TRACE_DECIMATION].astype(np.float32)
    return PlatformResult(
        job, flight.is_successful, flight.metrics, flight.height, flight.tilt, flight.lost,
        float(last.mean()), **traces,
    )  # fmt: skip


def fly_jobs(
    entries: ComparisonEntries, jobs: list[PlatformJob], run: StudyRun
) -> list[PlatformResult]:
    """Fly the jobs that are not stored in the folder, and return the results of all."""
    return run.run_study(
        Study(fly_job, attrgetter('key'), PLATFORM_STORE, 'flights'), entries.identity, jobs
    )


def result_to_json(row: PlatformResult) -> dict[str, Any]:
    """Return a flight as a JSON object in SI units, with NaN as null."""
    content = {
        **asdict(row.job),
        'held': row.held,
        'lost': row.lost,
        'tilt': row.tilt,
        'speed_reached': row.speed,
        **{f'judged_{name}': value for name, value in row.metrics._asdict().items()},
        **{f'height_{name}': value for name, value in row.height._asdict().items()},
    }
    del content['file']
    # Only NaN differs from itself; JSON has no NaN.
    return {name: None if value != value else value for name, value in content.items()}
