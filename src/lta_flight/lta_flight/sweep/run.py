"""Run a sweep: check it, fly it, and write its table."""

from dataclasses import dataclass
from functools import partial
import hashlib
import os
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
from lta_flight.sweep.cluster import SweepCluster
from lta_flight.sweep.job_runner import fly_job, SweepRow
from lta_flight.sweep.log import SweepLog
from lta_flight.sweep.plan import SweepPlan
from lta_flight.sweep.progress import SweepProgress
from lta_flight.sweep.workers import LocalWorkers, SweepWorkers
from rich.console import Console


@final
@dataclass(frozen=True, slots=True)
class SweepRequest:
    """What to sweep, and how."""

    file: str
    out: Path | None = None
    workers: int | None = None
    scheduler: str | None = None
    retry: bool = False
    device: Device | None = None
    duties: tuple[float, ...] = ()

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
    """
    The result of a sweep.

    Attributes
    ----------
    order : SweepRequest
        The request.
    plan : SweepPlan
        The planned flights.
    rows : list of SweepRow
        All flights, including those of earlier runs.
    folder, table : Path
        The results.
    flown, deaths : int
        Flights and lost workers of this run.
    wall : float
        Duration of this run's flights. [s]
    failure : KeyboardInterrupt or BadInput, optional
        What stopped this run before its last flight.

    """

    order: SweepRequest
    plan: SweepPlan
    rows: list[SweepRow]
    folder: Path
    table: Path
    flown: int
    deaths: int
    wall: float
    failure: KeyboardInterrupt | BadInput | None = None


def count_cores() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


def sweep_once(order: SweepRequest, console: Console) -> SweepRun:
    """
    Fly the flights of a sweep file that have not been flown yet, and write the table.

    Ctrl-C, or a machine or cluster that fails, ends the sweep early; the result then has the
    finished flights and the reason.

    Raises
    ------
    BadInput
        If the sweep is invalid; nothing has been flown then.

    """
    file = load_sweep(order.file)
    plan = SweepPlan(file)
    plan.check()
    identity = order.compute_sweep_hash(plan)
    # The name contains the identity, so the same command resumes its own sweep
    folder = (order.out or Path('runs') / f'sweep-{file.name}-{identity[:8]}').absolute()
    far: SweepWorkers | None = None
    if order.device is not None:
        far = BatchWorkers(plan.base, order.device, order.duties)
        # Before the first flight: a batch supports fewer features than a single flight
        far.check(plan)
    elif order.scheduler is not None:
        far = SweepCluster(plan.base, order.scheduler)
    with SweepLog(folder, identity, order.retry) as log:
        before = len(log.rows)
        # A batch or a cluster replaces the local workers
        crew: SweepWorkers = far or LocalWorkers(
            partial(fly_job, plan.base),
            # No more workers than flights are left
            min(order.workers or count_cores(), max(1, plan.count - before)),
        )
        begun, failure = time.monotonic(), None
        try:
            fly_missing(plan, log, crew, console)
        except (KeyboardInterrupt, BadInput) as error:
            failure = error
        finally:
            wall = time.monotonic() - begun
            # Also after Ctrl-C, from the flights in the log
            path = write_sweep_table(plan, log.sorted_rows, folder, order)
        flown, rows = len(log.rows) - before, log.sorted_rows
        return SweepRun(order, plan, rows, folder, path, flown, crew.deaths, wall, failure)


def fly_missing(plan: SweepPlan, log: SweepLog, workers: SweepWorkers, console: Console) -> None:
    """Fly all flights that are not in the log."""
    done = set(log.rows)
    with SweepProgress(console, plan.count, len(done)) as progress, workers:
        for row in workers.run_jobs(plan.iterate_jobs(done)):
            log.add(row)
            progress.count_flight(row, workers.deaths)


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
