"""Run an evaluation: check its sets, fly them, and store every flight."""

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
import time
from typing import final

from lta_flight.batch.fly import Device
from lta_flight.flight_spec import load_spec
from lta_flight.sweep.batch_workers import BatchWorkers
from lta_flight.sweep.job_runner import store_row, SWEEP_STORE, SweepRow
from lta_flight.sweep.plan import SweepPlan
from lta_report.report import Report
from lta_report.request import option, StudyRequest, StudyRun
from lta_report.study import hash_inputs, run_items
from lta_report.study_progress import StudyProgress
from lta_report.study_store import refuse_foreign_folder, StudyStore
from lta_report.workers import ItemFailure, Workers
from lta_studies.light.evaluation.cells import build_cells, EvaluationCell
from lta_studies.light.evaluation.flights import (
    BatchEvaluation,
    build_standalone_job,
    build_sweep_plans,
    count_flights_per_seed,
    EvaluationTask,
    fly_task,
    iterate_tasks,
    MOST_SEEDS,
)
from lta_studies.light.evaluation.sets import SETS

FLIGHTS_FOLDER = 'flights'  # folder of the logs, one per set


@final
class EvaluationRequest(
    StudyRequest, command='light evaluate', folder='light-evaluate', quick={'seeds': 2}
):
    """
    Compare the navigation strategies: indoors, in wind, from afar, in daylight, and variations.

    Each set is a sweep file (light_indoors, light_reference_winds, ...) that "lta sweep" can also
    fly. All strategies get the same seeds. In the sets with wind, a reference pilot that knows
    lamp and wind gives the best path that the vehicle can fly.

    Shares have Wilson 95 % intervals, means bootstrap intervals. "lta reproduce indoors outdoors"
    compares the flights with the paper's claims.

    All sets fly their first seed before any flies its second. Finished flights are stored:
    repeating the command resumes, more seeds are added to the stored ones, and after Ctrl-C the
    page covers the flights so far.

    --device is much faster for many seeds, after a compilation of a minute or two for each
    strategy. Batches model the received lamp signal by geometry and noise instead of ADC blocks,
    as "lta sweep --device" does; the pilot flies as before.

    Exit status 0: all flown. 1: some flights failed. 2: bad input. 130: Ctrl-C.

    Example: lta light evaluate --seeds 10 --sets indoors winds
    """

    seeds: int = option(
        'Number of flights of each strategy in each case.', default=50, low=1, high=MOST_SEEDS
    )
    sets: tuple[str, ...] = option(
        f'Sets of cases to fly: {", ".join(SETS)}; all by default.', default=(), metavar='A B'
    )
    device: Device | None = option(
        'Simulate the flights in batches: on all cores (cpu-batch) or on a GPU (gpu).',
        default=None,
    )

    def run(self, run: StudyRun) -> Report:
        """Return the report of all flights that are stored."""
        from lta_studies.light.evaluation.report import build_report

        # No time in the name, so that repeating the command resumes
        run.open_folder(Path('runs') / 'light-evaluate')
        status = run_evaluation(self.replace(sets=self.sets or tuple(SETS)), run)
        return build_report(status, with_pictures=self.page)

    def compute_set_hash(self, plan: SweepPlan) -> str:
        """Return the hash of everything that determines the flights of a set."""
        return plan.identity if self.device is None else hash_inputs(plan.identity, self.device)


@final
@dataclass(frozen=True, slots=True)
class EvaluationStatus:
    """State of an evaluation."""

    order: EvaluationRequest  # options
    plans: Mapping[str, SweepPlan]  # sweep plans by set
    cells: Mapping[str, list[EvaluationCell]]  # results by set
    # Flights of this run, and all flights requested
    new_flights: int
    total: int
    # Wall time of this run, and computing time of all flights [s]
    wall: float
    work: float
    stopped: bool = False  # whether Ctrl-C ended it early


def run_evaluation(order: EvaluationRequest, run: StudyRun) -> EvaluationStatus:
    """
    Fly the missing flights and return the results of all.

    Flights are stored as they end. After Ctrl-C the same request resumes.

    Raise `BadInput` if a set cannot be flown; raised before any flight.
    """
    # All sets are checked before the first flight.
    options = run.options
    workers: Workers[EvaluationTask, SweepRow] = options.open_workers(fly_task)
    if order.device is None:
        plans = build_sweep_plans(order.sets)
    else:
        # Every job names all its files, so that any base will do
        batches = BatchWorkers(load_spec('gtmab', 'lamp_room', 'bag', ''), order.device)
        plans = build_sweep_plans(order.sets, batches.check)
        workers = BatchEvaluation(batches, workers)
    refuse_foreign_folder(run.folder, FLIGHTS_FOLDER, 'comparison of strategies')
    begun = time.monotonic()
    with ExitStack() as stack:
        stores = {
            name: stack.enter_context(
                StudyStore(
                    run.folder / FLIGHTS_FOLDER / name,
                    SWEEP_STORE,
                    order.compute_set_hash(plan),
                    options.retry_failed,
                )
            )
            for name, plan in plans.items()
        }

        def save(task: EvaluationTask, outcome: SweepRow | ItemFailure) -> str:
            return store_row(stores[task.part], task.job, outcome)

        todo = [
            task for task in iterate_tasks(dict(plans), order.seeds)
            if task.job.index not in stores[task.part]
        ]  # fmt: skip
        total = order.seeds * sum(map(count_flights_per_seed, plans.values()))
        stopped = False
        try:
            run_items(
                (
                    replace(task, job=build_standalone_job(plans[task.part], task.job))
                    for task in todo
                ),
                workers,
                save,
                StudyProgress(run.console, total, total - len(todo), 'flights'),
            )
        except KeyboardInterrupt:
            stopped = True  # report the flights so far
    rows = {name: filter_by_seed(stores[name], plan, order.seeds) for name, plan in plans.items()}
    count = sum(map(len, rows.values()))
    return EvaluationStatus(
        order, plans, {name: build_cells(name, plans[name], rows[name]) for name in plans},
        # Flights known now minus those known before: flown in this run
        count - (total - len(todo)), total, time.monotonic() - begun,
        sum(row.wall for own in rows.values() for row in own), stopped,
    )  # fmt: skip


def filter_by_seed(store: StudyStore[SweepRow], plan: SweepPlan, seeds: int) -> list[SweepRow]:
    """Return the flights of the requested seeds; a store may hold more."""
    return [
        store.results[k] for k in sorted(store.results) if k % plan.file.draws_per_point < seeds
    ]
