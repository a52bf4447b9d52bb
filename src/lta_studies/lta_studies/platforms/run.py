"""
Fly all flights of a comparison in worker processes.

The flights are independent and seeded, so their order does not matter.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cache
import os
from typing import Any, final

from lta_config.schema.comparison_file import ComparisonFile, load_comparison
from lta_config.schema.maneuver_file import load_maneuver_file, ManeuverFile
from lta_flight.closed_loop import ClosedLoop
from lta_model.scenario import load_scenario
from lta_report.worker_pool import run_in_workers
from lta_studies.platforms.entrants import build_entrant
from lta_studies.platforms.flight import fly_maneuver, ManeuverFlight, prepare_flight
from lta_studies.platforms.metrics import TrackingMetrics
import numpy as np

CONTESTANT, ABLATION, LIMIT = 'contestant', 'ablation', 'limit'
SHOWN = 10  # decimation of the traces for plots


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
    flown: Any = None  # time, altitude, heading, speed; ndarray or None
    asked: Any = None
    duties: Any = None


def list_jobs(file: str, comparison: ComparisonFile, seeds: int) -> list[PlatformJob]:
    """Return all flights of a comparison."""
    found: list[PlatformJob] = []
    for seed in range(1, seeds + 1):
        for name, contestant in comparison.contestants.items():
            own = contestant.manoeuvres or comparison.manoeuvres
            found += [PlatformJob(file, CONTESTANT, name, manoeuvre, seed) for manoeuvre in own]
        for name, ablation in comparison.ablations.items():
            found += [
                PlatformJob(file, ABLATION, name, each, seed) for each in ablation.manoeuvres
            ]
        for name, limit in comparison.limits.items():
            found += [
                PlatformJob(file, LIMIT, name, limit.manoeuvre, seed, speed)
                for speed in limit.speeds.vector
            ]
    return found


@cache
def _load_files(file: str) -> tuple[ComparisonFile, Any]:
    comparison = load_comparison(file)
    return comparison, load_scenario(comparison.scenario)


@cache
# Cached in each worker, as all seeds and manoeuvres share the entrant.
def _build_entrant(file: str, kind: str, name: str) -> Any:  # noqa: ANN401 - an Entrant
    comparison, scenario = _load_files(file)
    density = scenario.air.density
    if kind == CONTESTANT:
        return build_entrant(comparison.contestants[name], density)
    change = comparison.ablations[name] if kind == ABLATION else comparison.limits[name]
    return build_entrant(comparison.contestants[change.of], density, change)


def check_comparison(file: str, comparison: ComparisonFile) -> None:
    """Build every entry and load every manoeuvre; raise `BadInput` if one is invalid."""
    for job in list_jobs(file, comparison, 1):
        _build_entrant(job.file, job.kind, job.name)
        load_maneuver_file(job.manoeuvre)


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
    """Fly one job."""
    _, scenario = _load_files(job.file)
    manoeuvre = replace_speeds(load_maneuver_file(job.manoeuvre), job.speed)
    flight = fly_maneuver(
        _build_entrant(job.file, job.kind, job.name), scenario, manoeuvre, job.seed
    )
    return summarize_flight(job, flight)


def build_loop(job: PlatformJob) -> ClosedLoop:
    """Return the closed loop of a job before its first step."""
    _, scenario = _load_files(job.file)
    manoeuvre = replace_speeds(load_maneuver_file(job.manoeuvre), job.speed)
    return prepare_flight(
        _build_entrant(job.file, job.kind, job.name), scenario, manoeuvre, job.seed
    )


def summarize_flight(job: PlatformJob, flight: ManeuverFlight) -> PlatformResult:
    """Return the result of a flight with decimated traces."""
    count = len(flight.flown)
    # Column 3 is the speed along the course.
    last = flight.flown[3 * count // 4 :, 3]
    traces = {}
    if job.seed == 1:
        for name in ('flown', 'asked', 'duties'):
            # Decimated and in single precision: results travel between processes.
            traces[name] = getattr(flight, name)[::SHOWN].astype(np.float32)
    return PlatformResult(
        job, flight.is_successful, flight.metrics, flight.height, flight.tilt, flight.lost,
        float(last.mean()), **traces,
    )  # fmt: skip


def fly_all(todo: list[PlatformJob], workers: int) -> Iterator[PlatformResult]:
    """Yield the results as they finish; one worker runs in this process."""
    return run_in_workers(fly_job, [(job,) for job in todo], workers, '--workers')


def count_processors() -> int:
    """Return the number of available processors."""
    return len(os.sched_getaffinity(0))


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
