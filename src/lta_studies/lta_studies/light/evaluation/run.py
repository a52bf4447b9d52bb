"""The evaluation from its sets to its results: checked first, flown, kept whatever happens."""

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
import time
from typing import final

from lta_flight.sweep.crew import LocalCrew
from lta_flight.sweep.flown import Row
from lta_flight.sweep.log import Log
from lta_flight.sweep.plan import Plan
from lta_flight.sweep.progress import SweepProgress
from lta_flight.sweep.run import cores
from lta_studies.light.evaluation.cells import Cell, cells_of
from lta_studies.light.evaluation.flying import chosen, fly_task, points, Task, tasks, whole
from rich.console import Console

FLIGHTS = 'flights'  # folder of the logs, one a set


@final
@dataclass(frozen=True, slots=True)
class Order:
    """What to fly: names of sets, seeds, and the folder of the results."""

    sets: tuple[str, ...]
    seeds: int
    folder: Path
    workers: int | None = None
    retry: bool = False


@final
@dataclass(frozen=True, slots=True)
class Evaluated:
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

    order: Order
    plans: Mapping[str, Plan]
    cells: Mapping[str, list[Cell]]
    flown: int
    total: int
    wall: float
    work: float
    stopped: bool = False


def evaluate(order: Order, console: Console) -> Evaluated:
    """
    Fly what has not been flown yet, and return what all flights come to.

    Flights are kept as they end. Ctrl-C ends it: the same order goes on from there.

    Raises
    ------
    BadInput
        If a set cannot be flown as it is designed: nothing has been flown then.

    """
    plans = chosen(order.sets)
    begun = time.monotonic()
    with ExitStack() as stack:
        logs = {
            name: stack.enter_context(
                Log(order.folder / FLIGHTS / name, plan.identity, order.retry)
            )
            for name, plan in plans.items()
        }
        todo = [
            task for task in tasks(dict(plans), order.seeds)
            if task.job.index not in logs[task.part].rows
        ]  # fmt: skip
        total = order.seeds * sum(map(points, plans.values()))
        stopped = False
        try:
            fly(todo, plans, logs, (total, order.workers or cores()), console)
        except KeyboardInterrupt:
            stopped = True  # what has been flown is told all the same
        known = sum(len(asked(log, plans[name], order.seeds)) for name, log in logs.items())
    rows = {name: asked(log, plans[name], order.seeds) for name, log in logs.items()}
    return Evaluated(
        order, plans, {name: cells_of(name, plans[name], rows[name]) for name in plans},
        known - (total - len(todo)), total, time.monotonic() - begun,
        sum(row.wall for own in rows.values() for row in own), stopped,
    )  # fmt: skip


def fly(
    todo: list[Task],
    plans: Mapping[str, Plan],
    logs: Mapping[str, Log],
    size: tuple[int, int],
    console: Console,
) -> None:
    """Fly some flights, of `size` in all and by so many workers, into the logs of their sets."""
    total, workers = size
    jobs = (whole(plans[task.part], task.job, k) for k, task in enumerate(todo))
    crew = LocalCrew(fly_task, min(workers, max(1, len(todo))))
    with SweepProgress(console, total, total - len(todo)) as progress, crew:
        for row in crew.fly(jobs):
            task = todo[row.index]
            logs[task.part].add(replace(row, index=task.job.index))
            progress.flown(row, crew.deaths)


def asked(log: Log, plan: Plan, seeds: int) -> list[Row]:
    """Return the flights of as many seeds as are asked for; a log may hold more."""
    return [row for row in log.ordered if row.index % plan.file.draws < seeds]
