"""Run an evaluation: check its sets, fly them, and store every flight."""

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
import time
from typing import final

from lta_flight.sweep.job_runner import SweepRow
from lta_flight.sweep.log import SweepLog
from lta_flight.sweep.plan import SweepPlan
from lta_flight.sweep.progress import SweepProgress
from lta_flight.sweep.run import count_cores
from lta_flight.sweep.workers import LocalWorkers
from lta_studies.light.evaluation.cells import build_cells, EvaluationCell
from lta_studies.light.evaluation.flights import (
    build_standalone_job,
    build_sweep_plans,
    count_flights_per_seed,
    EvaluationTask,
    fly_task,
    iterate_tasks,
)
from rich.console import Console

FLIGHTS = 'flights'  # folder of the logs, one per set


@final
@dataclass(frozen=True, slots=True)
class EvaluationRequest:
    """Options of an evaluation."""

    sets: tuple[str, ...]
    seeds: int
    folder: Path
    workers: int | None = None
    retry: bool = False


@final
@dataclass(frozen=True, slots=True)
class EvaluationStatus:
    """
    State of an evaluation.

    Attributes
    ----------
    order : EvaluationRequest
        Options.
    plans : mapping
        Sweep plans by set.
    cells : mapping
        Results by set.
    flown, total : int
        Flights of this run, and all flights requested.
    wall, work : float
        Wall time of this run, and computing time of all flights. [s]
    stopped : bool
        Whether Ctrl-C ended it early.

    """

    order: EvaluationRequest
    plans: Mapping[str, SweepPlan]
    cells: Mapping[str, list[EvaluationCell]]
    flown: int
    total: int
    wall: float
    work: float
    stopped: bool = False


def run_evaluation(order: EvaluationRequest, console: Console) -> EvaluationStatus:
    """
    Fly the missing flights and return the results of all.

    Flights are stored as they end. After Ctrl-C the same request resumes.

    Raises
    ------
    BadInput
        If a set cannot be flown; raised before any flight.

    """
    # All sets are checked before the first flight.
    plans = build_sweep_plans(order.sets)
    begun = time.monotonic()
    with ExitStack() as stack:
        logs = {
            name: stack.enter_context(
                SweepLog(order.folder / FLIGHTS / name, plan.identity, order.retry)
            )
            for name, plan in plans.items()
        }
        todo = [
            task for task in iterate_tasks(dict(plans), order.seeds)
            if task.job.index not in logs[task.part].rows
        ]  # fmt: skip
        total = order.seeds * sum(map(count_flights_per_seed, plans.values()))
        stopped = False
        try:
            fly_tasks(todo, plans, logs, (total, order.workers or count_cores()), console)
        except KeyboardInterrupt:
            stopped = True  # report the flights so far
        known = sum(
            len(filter_by_seed(log, plans[name], order.seeds)) for name, log in logs.items()
        )
    rows = {name: filter_by_seed(log, plans[name], order.seeds) for name, log in logs.items()}
    return EvaluationStatus(
        order, plans, {name: build_cells(name, plans[name], rows[name]) for name in plans},
        # Flights known now minus those known before: flown in this run
        known - (total - len(todo)), total, time.monotonic() - begun,
        sum(row.wall for own in rows.values() for row in own), stopped,
    )  # fmt: skip


def fly_tasks(
    todo: list[EvaluationTask],
    plans: Mapping[str, SweepPlan],
    logs: Mapping[str, SweepLog],
    size: tuple[int, int],
    console: Console,
) -> None:
    """Fly tasks into the logs of their sets; `size` is the total and the number of workers."""
    total, workers = size
    # Jobs are numbered over all sets; the log gets back the index within its own set.
    jobs = (build_standalone_job(plans[task.part], task.job, k) for k, task in enumerate(todo))
    pool = LocalWorkers(fly_task, min(workers, max(1, len(todo))))
    with SweepProgress(console, total, total - len(todo)) as progress, pool:
        for row in pool.run_jobs(jobs):
            task = todo[row.index]
            logs[task.part].add(replace(row, index=task.job.index))
            progress.count_flight(row, pool.deaths)


def filter_by_seed(log: SweepLog, plan: SweepPlan, seeds: int) -> list[SweepRow]:
    """Return the flights of the requested seeds; a log may hold more."""
    return [row for row in log.sorted_rows if row.index % plan.file.draws_per_point < seeds]
