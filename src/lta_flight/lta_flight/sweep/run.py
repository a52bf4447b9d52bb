"""Run a sweep: check it, fly it, and write its table."""

from dataclasses import dataclass, field
from functools import partial
import hashlib
from pathlib import Path
import time
from typing import final

from lta_bridge.provenance import read_commit
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.schema.sweep_file import load_sweep
from lta_flight.batch.fly import Device
from lta_flight.sweep import table
from lta_flight.sweep.batch_workers import BatchWorkers
from lta_flight.sweep.job_runner import fly_job, STORE, store_row, SweepRow
from lta_flight.sweep.plan import SweepJob, SweepPlan
from lta_report.study import run_items, StudyOptions
from lta_report.study_progress import StudyProgress
from lta_report.study_store import StudyStore
from lta_report.workers import Workers
from rich.console import Console


@final
@dataclass(frozen=True, slots=True)
class SweepRequest:
    """What to sweep, and how."""

    file: str
    out: Path | None = None
    computing: StudyOptions = field(default_factory=StudyOptions)
    device: Device | None = None
    duties: tuple[float, ...] = ()
    quick: bool = False

    @property
    def options(self) -> tuple[str, ...]:
        """Command-line options that determine the flights in addition to the file."""
        device = ('--device', self.device) if self.device else ()
        return device + (('--duties', ','.join(map(str, self.duties))) if self.duties else ())

    def compute_sweep_hash(self, plan: SweepPlan) -> str:
        """Return the hash of everything that determines the flights."""
        if not self.options:
            return plan.identity
        return hashlib.sha256(' '.join((plan.identity, *self.options)).encode()).hexdigest()


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
    with StudyStore(folder, STORE, identity, order.computing.retry_failed) as store:
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
        return order.computing.open_workers(partial(fly_job, plan.base))
    batch = BatchWorkers(plan.base, order.device, order.duties)
    # Before the first flight: a batch supports fewer features than a single flight
    batch.check(plan)
    return batch


def write_sweep_table(
    plan: SweepPlan, rows: list[SweepRow], folder: Path, order: SweepRequest
) -> Path:
    """Write the table and return its path."""
    path = folder / table.NAME
    about = {
        **describe_origin(plan, order),
        'identity': order.compute_sweep_hash(plan),
        'file': plan.file.model_dump_json(),
    }
    table.write_table(rows, plan.units, about, path)
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
        **({'flown as': ' '.join(order.options)} if order.options else {}),
    }
