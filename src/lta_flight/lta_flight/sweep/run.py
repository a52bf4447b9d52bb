# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run a sweep: check it, fly it, and write its table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
import time
from typing import Any, Final, final

from lta_bag.provenance import read_commit
from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.schema.sweep_file import load_sweep
from lta_flight.batch.fly import Device
from lta_flight.report.results import FlightResults
from lta_flight.sweep.batch_workers import BatchWorkers, fly_job, store_row, SWEEP_STORE, SweepRow
from lta_flight.sweep.plan import SweepJob, SweepPlan
from lta_report.report import Report
from lta_report.request import argument, option, StudyRequest, StudyRun
from lta_report.study import hash_inputs, run_items, StudyProgress
from lta_report.study_store import StudyStore
from lta_report.workers import Workers
import pyarrow as arrow
from pyarrow import parquet
from rich.console import Console


@final
class SweepRequest(
    StudyRequest, command='sweep', quick='Fly only the first seed or sample of each case.'
):
    """
    Fly a parameter grid or a Monte Carlo study in parallel; write one table and a page.

    A sweep file names vehicle, scenario, strategy, gains, seeds and the parameters to vary, by
    path (see "lta simulate --help"): each a list of values or a distribution (normal, uniform,
    loguniform, choice) sampled "samples" times. Lists form a full grid, and every grid point gets
    the same samples and seeds. The drone's own model uses the varied values, too. Everything is
    checked before the first flight.

    Finished flights are stored in the results folder, by default runs/sweep-<name>-<hash>. A
    stopped sweep reports its finished flights, and repeating the command resumes it. Failed
    flights are stored with their seed and the reason. flights.parquet has one row per flight, with
    SI units and descriptions in the column metadata.

    --device flies thousands of closed loops at once, after one compilation of a minute or two for
    each strategy. It models the received lamp signal by geometry and noise instead of ADC blocks,
    so flights agree in distribution, not seed by seed. A batch reports no cruise data and no
    estimator errors. It supports every strategy, routes and several lamps, but no courses, only
    the control law cascade, and no effects on measurements.

    Exit status 0: all flights were flown. 1: some failed. 2: bad input, nothing was flown; or the
    workers failed. 130: Ctrl-C.

    Example: lta sweep heaviness --workers 2
    """

    file: str = argument('Sweep file, or the name of a shipped one, such as heaviness.')
    device: Device | None = option(
        'Simulate all flights as one batch: on all cores (cpu-batch) or on a GPU (gpu).',
        default=None,
    )

    def run(self, run: StudyRun) -> Report:
        """Return the report of all flights that are stored."""
        from lta_flight.sweep.report import build_report

        if self.device is not None and (self.workers, self.scheduler) != (None, None):
            raise BadInput(
                '--device cannot be combined with --workers or --scheduler; remove one of them.'
            )
        done = sweep_once(self, run.console)
        run.open_folder(done.folder)
        return build_report(done)

    @property
    def flight_options(self) -> tuple[str, ...]:
        """Command-line options that determine the flights in addition to the file."""
        return ('--device', self.device) if self.device else ()

    def compute_sweep_hash(self, plan: SweepPlan) -> str:
        """Return the hash of everything that determines the flights."""
        options = self.flight_options
        return hash_inputs(plan.identity, *options) if options else plan.identity


@final
@dataclass(frozen=True, slots=True)
class SweepRun:
    """The result of a sweep."""

    order: SweepRequest
    plan: SweepPlan  # the planned flights
    rows: list[SweepRow]  # all flights, including those of earlier runs
    # The results
    folder: Path
    table: Path
    # Flights and lost workers of this run
    new_flights: int
    lost: int
    wall: float  # duration of this run's flights [s]
    # What stopped this run before its last flight
    failure: KeyboardInterrupt | BadInput | None = None


def sweep_once(order: SweepRequest, console: Console) -> SweepRun:
    """
    Fly the flights of a sweep file that have not been flown yet, and write the table.

    Ctrl-C, or a machine or cluster that fails, ends the sweep early; the result then has the
    finished flights and the reason.

    Raise `BadInput` if the sweep is invalid; nothing has been flown then.
    """
    file = load_sweep(order.file)
    plan = SweepPlan(file.shorten() if order.quick else file)
    plan.check()
    identity = order.compute_sweep_hash(plan)
    # The name contains the identity, so the same command resumes its own sweep
    folder = (order.out or Path('runs') / f'sweep-{file.name}-{identity[:8]}').absolute()
    # Before the folder is created: a batch or a cluster may not be usable
    workers = create_workers(order, plan)
    with StudyStore(folder, SWEEP_STORE, identity, order.retry_failed) as store:
        done = set(store.results)
        progress = StudyProgress(console, plan.count, len(done), 'flights')
        begun, failure = time.monotonic(), None
        try:
            run_items(plan.iterate_jobs(done), workers, partial(store_row, store), progress)
        except (KeyboardInterrupt, BadInput) as error:
            failure = error
        finally:
            wall = time.monotonic() - begun
            rows = [store.results[index] for index in sorted(store.results)]
            # Also after Ctrl-C, from the flights in the store
            path = write_sweep_table(plan, rows, folder, order)
        new_flights = len(rows) - len(done)
        return SweepRun(order, plan, rows, folder, path, new_flights, workers.lost, wall, failure)


def create_workers(order: SweepRequest, plan: SweepPlan) -> Workers[SweepJob, SweepRow]:
    """Return the workers that fly a sweep; a batch checks all values of the sweep."""
    if order.device is None:
        return order.options.open_workers(partial(fly_job, plan.base))
    batch = BatchWorkers(plan.base, order.device)
    # Before the first flight: a batch supports fewer features than a single flight
    batch.check(plan)
    return batch


def write_sweep_table(
    plan: SweepPlan, rows: list[SweepRow], folder: Path, order: SweepRequest
) -> Path:
    """Write the table and return its path."""
    path = folder / TABLE_NAME
    about = {
        **describe_origin(plan, order),
        'identity': order.compute_sweep_hash(plan),
        'file': plan.file.model_dump_json(),
    }
    write_table(rows, plan.units, about, path)
    return path


def describe_origin(plan: SweepPlan, order: SweepRequest) -> dict[str, str]:
    """Return the provenance of table and report."""
    return {
        'sweep': str(find_file('sweep', order.file)),
        'vehicle': plan.file.vehicle,
        'scenario': plan.file.scenario,
        'strategy': plan.file.strategy,
        'gains': plan.file.gains,
        'commit': read_commit(),
        **({'flown as': ' '.join(order.flight_options)} if order.flight_options else {}),
    }


TABLE_NAME = 'flights.parquet'
FIXED_COLUMNS: Final = (
    ('index', arrow.int64(), '', 'number of the flight in the sweep, from 0'),
    ('seed', arrow.int64(), '', 'random seed of the flight'),
    ('outcome', arrow.string(), '', 'reached, timeout, escaped, or failed (could not be flown)'),
    ('sentence', arrow.string(), '', 'outcome as a sentence, or why the flight failed'),
    ('wall', arrow.float64(), 's', 'computing time of the flight'),
)


def write_table(
    rows: Sequence[SweepRow], units: Mapping[str, str], about: Mapping[str, str], path: Path
) -> None:
    """
    Write the rows of a sweep.

    `units`: SI unit of each varied path; '' if it has none. `about`: metadata of the file: its
    provenance. `path`: parquet file; replaced as a whole. Raise `BadInput` if it cannot be
    written.
    """
    columns, declared = [], []
    for name, kind, unit, meaning in FIXED_COLUMNS:
        columns.append(arrow.array([getattr(row, name) for row in rows], kind))
        declared.append(_build_field(name, kind, unit, meaning))
    for varied, unit in units.items():
        values = [row.values.get(varied) for row in rows]
        kind = _column_type(values)
        columns.append(arrow.array(values, kind))
        declared.append(_build_field(varied, kind, unit, 'varied'))
    for item in fields(FlightResults):
        # All other results are numbers, or null if unknown
        kind = arrow.bool_() if item.name == 'success' else arrow.float64()
        columns.append(arrow.array([row.figures.get(item.name) for row in rows], kind))
        declared.append(
            _build_field(item.name, kind, item.metadata['unit'], item.metadata['about'])
        )
    # Units and descriptions are stored in the schema
    table = arrow.table(columns, schema=arrow.schema(declared, metadata=dict(about)))
    try:
        with replace_atomically(path) as part:
            parquet.write_table(table, part, compression='zstd')
    except OSError as error:
        raise BadInput(
            f"'{path}' cannot be written ({error}); check that its folder is writable and has "
            'free space.'
        ) from None


def _build_field(name: str, kind: Any, unit: str, meaning: str) -> Any:
    return arrow.field(name, kind, metadata={'unit': unit, 'about': meaning})


def _column_type(values: Sequence[Any]) -> Any:
    """Return the type of a varied column: number, list of numbers, bool, or text."""
    # A path may have no value in the rows of other cases
    first = next((value for value in values if value is not None), 0.0)
    if isinstance(first, list):
        return arrow.list_(arrow.float64())
    if isinstance(first, bool):
        return arrow.bool_()
    return arrow.float64() if isinstance(first, int | float) else arrow.string()
