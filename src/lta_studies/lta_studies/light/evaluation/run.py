"""The evaluation from its sets to its results: checked first, flown, kept whatever happens."""

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
    build_plans,
    complete_job,
    count_points,
    EvaluationTask,
    fly_task,
    iterate_tasks,
)
from rich.console import Console

FLIGHTS = 'flights'  # folder of the logs, one a set


@final
@dataclass(frozen=True, slots=True)
class EvaluationRequest:
    """What to fly: names of sets, seeds, and the folder of the results."""

    sets: tuple[str, ...]
    seeds: int
    folder: Path
    workers: int | None = None
    retry: bool = False


@final
@dataclass(frozen=True, slots=True)
class EvaluationStatus:
    """
    How an evaluation stands.

    Attributes
    ----------
    order : Order
        What was asked for.
    plans : mapping
        Its sets, by name.
    cells : mapping
        What was found, by set.
    flown, total : int
        Flights of this run, and of all that was asked for.
    wall, work : float
        Time of this run, and of all flights together. [s]
    stopped : bool
        Whether Ctrl-C ended it before all was flown.

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
    Fly what has not been flown yet, and return what all flights come to.

    Flights are kept as they end. Ctrl-C ends it: the same order goes on from there.

    Raises
    ------
    BadInput
        If a set cannot be flown as it is designed: nothing has been flown then.

    """
    plans = build_plans(order.sets)
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
        total = order.seeds * sum(map(count_points, plans.values()))
        stopped = False
        try:
            fly_tasks(todo, plans, logs, (total, order.workers or count_cores()), console)
        except KeyboardInterrupt:
            stopped = True  # what has been flown is told all the same
        known = sum(len(select_rows(log, plans[name], order.seeds)) for name, log in logs.items())
    rows = {name: select_rows(log, plans[name], order.seeds) for name, log in logs.items()}
    return EvaluationStatus(
        order, plans, {name: build_cells(name, plans[name], rows[name]) for name in plans},
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
    """Fly some flights, of `size` in all and by so many workers, into the logs of their sets."""
    total, workers = size
    jobs = (complete_job(plans[task.part], task.job, k) for k, task in enumerate(todo))
    crew = LocalWorkers(fly_task, min(workers, max(1, len(todo))))
    with SweepProgress(console, total, total - len(todo)) as progress, crew:
        for row in crew.run_jobs(jobs):
            task = todo[row.index]
            logs[task.part].add(replace(row, index=task.job.index))
            progress.count_flight(row, crew.deaths)


def select_rows(log: SweepLog, plan: SweepPlan, seeds: int) -> list[SweepRow]:
    """Return the flights of as many seeds as are asked for; a log may hold more."""
    return [row for row in log.sorted_rows if row.index % plan.file.draws_per_point < seeds]
