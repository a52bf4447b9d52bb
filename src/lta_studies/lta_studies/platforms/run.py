"""
Fly a whole comparison, one process a processor, into rows and a summary.

Every flight stands by itself and by its seed, so that the order in which they come does not
matter.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cache
import os
from typing import Any, final

from lta_config.schema.comparison_file import Comparison, load_comparison
from lta_config.schema.manoeuvre_file import load_manoeuvre, Manoeuvre
from lta_flight.loop import Loop
from lta_model.scenario import load_scenario
from lta_report.children import done_by
from lta_studies.platforms.entries import entrant
from lta_studies.platforms.flying import begun, Flight, fly
from lta_studies.platforms.metrics import Metrics
import numpy as np

CONTESTANT, ABLATION, LIMIT = 'contestant', 'ablation', 'limit'
SHOWN = 10  # steps between two that a picture shows


@final
@dataclass(frozen=True, slots=True)
class Job:
    """One flight: file of the comparison, kind and name of the entry, manoeuvre, seed, speed."""

    file: str
    kind: str
    name: str
    manoeuvre: str
    seed: int
    speed: float | None = None  # asked for instead of the manoeuvre's [m/s]


@final
@dataclass(frozen=True, slots=True)
class Row:
    """What a flight came to; the traces are kept of the first seed alone."""

    job: Job
    held: bool
    metrics: Metrics
    height: Metrics
    tilt: float
    lost: str
    speed: float  # along the course, mean of the last quarter [m/s]
    flown: Any = None  # time, altitude, heading, speed; ndarray or None
    asked: Any = None
    duties: Any = None


def jobs(file: str, comparison: Comparison, seeds: int) -> list[Job]:
    """Return every flight of a comparison."""
    found: list[Job] = []
    for seed in range(1, seeds + 1):
        for name, contestant in comparison.contestants.items():
            own = contestant.manoeuvres or comparison.manoeuvres
            found += [Job(file, CONTESTANT, name, manoeuvre, seed) for manoeuvre in own]
        for name, ablation in comparison.ablations.items():
            found += [Job(file, ABLATION, name, each, seed) for each in ablation.manoeuvres]
        for name, limit in comparison.limits.items():
            found += [
                Job(file, LIMIT, name, limit.manoeuvre, seed, speed)
                for speed in limit.speeds.vector
            ]
    return found


@cache
def _read(file: str) -> tuple[Comparison, Any]:
    comparison = load_comparison(file)
    return comparison, load_scenario(comparison.scenario)


@cache
def _entrant(file: str, kind: str, name: str) -> Any:  # noqa: ANN401 - an Entrant
    comparison, scenario = _read(file)
    density = scenario.air.density
    if kind == CONTESTANT:
        return entrant(comparison.contestants[name], density)
    change = comparison.ablations[name] if kind == ABLATION else comparison.limits[name]
    return entrant(comparison.contestants[change.of], density, change)


def check(file: str, comparison: Comparison) -> None:
    """Build every entry and read every manoeuvre, before any of them flies; or `BadInput`."""
    for job in jobs(file, comparison, 1):
        _entrant(job.file, job.kind, job.name)
        load_manoeuvre(job.manoeuvre)


def at_speed(manoeuvre: Manoeuvre, speed: float | None) -> Manoeuvre:
    """Return a manoeuvre that asks for another speed wherever it asks for one. [m/s]"""
    if speed is None:
        return manoeuvre
    rows = [
        row.model_copy(update={'speed': row.speed.model_copy(update={'value': speed})})
        if row.speed.si > 0.0 else row
        for row in manoeuvre.course
    ]  # fmt: skip
    return manoeuvre.model_copy(update={'course': rows})


def fly_job(job: Job) -> Row:
    """Fly one flight."""
    _, scenario = _read(job.file)
    manoeuvre = at_speed(load_manoeuvre(job.manoeuvre), job.speed)
    flight = fly(_entrant(job.file, job.kind, job.name), scenario, manoeuvre, job.seed)
    return row_of(job, flight)


def loop_of(job: Job) -> Loop:
    """Return a flight that is about to begin, for who flies it otherwise."""
    _, scenario = _read(job.file)
    manoeuvre = at_speed(load_manoeuvre(job.manoeuvre), job.speed)
    return begun(_entrant(job.file, job.kind, job.name), scenario, manoeuvre, job.seed)


def row_of(job: Job, flight: Flight) -> Row:
    """Return what is kept of a flight."""
    count = len(flight.flown)
    last = flight.flown[3 * count // 4 :, 3]
    traces = {}
    if job.seed == 1:
        for name in ('flown', 'asked', 'duties'):
            traces[name] = getattr(flight, name)[::SHOWN].astype(np.float32)
    return Row(
        job, flight.held, flight.metrics, flight.height, flight.tilt, flight.lost,
        float(last.mean()), **traces,
    )  # fmt: skip


def fly_all(todo: list[Job], workers: int) -> Iterator[Row]:
    """Return the rows of all flights as they come; in this process where one worker is asked."""
    return done_by(fly_job, [(job,) for job in todo], workers, '--workers')


def processors() -> int:
    """Return how many processes this machine has room for."""
    return len(os.sched_getaffinity(0))


def printed(row: Row) -> dict[str, Any]:
    """Return a flight as JSON has it; SI units, headings in rad, what is no number as null."""
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
    return {name: None if value != value else value for name, value in content.items()}
