"""A sweep from its file to its table and page: checked first, flown, kept whatever happens."""

from dataclasses import dataclass
from functools import partial
import hashlib
import os
from pathlib import Path
import time
from typing import final

from lta_bridge.provenance import read_commit
from lta_config.files import find_file
from lta_config.schema.sweep_file import load_sweep
from lta_flight.batch.fly import Device
from lta_flight.sweep import page, table
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
    """What to sweep and how."""

    file: str
    out: Path | None = None
    workers: int | None = None
    scheduler: str | None = None
    retry: bool = False
    page: bool = True
    device: Device | None = None
    duties: tuple[float, ...] = ()

    @property
    def options(self) -> tuple[str, ...]:
        """What decides the flights beside the file, as it is typed."""
        device = ('--device', self.device) if self.device else ()
        return device + (('--duties', ','.join(map(str, self.duties))) if self.duties else ())

    def compute_identity(self, plan: SweepPlan) -> str:
        """Return the hash of all that decides the flights."""
        if not self.options:
            return plan.identity
        return hashlib.sha256(' '.join((plan.identity, *self.options)).encode()).hexdigest()


@final
@dataclass(frozen=True, slots=True)
class SweepRun:
    """
    How a sweep went.

    Attributes
    ----------
    plan : Plan
        What was to be flown.
    rows : list of Row
        All flights, those of earlier runs included.
    folder, table : Path
        Where the results are.
    page : Path or None
        The page, if one was asked for.
    flown, deaths : int
        Flights and lost workers of this run.
    wall : float
        Time of this run's flights. [s]

    """

    plan: SweepPlan
    rows: list[SweepRow]
    folder: Path
    table: Path
    page: Path | None
    flown: int
    deaths: int
    wall: float


def count_cores() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0))


def sweep_once(order: SweepRequest, console: Console) -> SweepRun:
    """
    Fly what a sweep file asks for and has not been flown yet; write its table and page.

    Table and page are written as well when Ctrl-C or an error ends it, from what has been flown.

    Raises
    ------
    BadInput
        If the sweep cannot be flown as it is designed: nothing has been flown then. Or if the
        machine or the cluster gives up; what has been flown is kept.

    """
    file = load_sweep(order.file)
    plan = SweepPlan(file)
    plan.check()
    identity = order.compute_identity(plan)
    folder = (order.out or Path('runs') / f'sweep-{file.name}-{identity[:8]}').absolute()
    far: SweepWorkers | None = None
    if order.device is not None:
        far = BatchWorkers(plan.base, order.device, order.duties)
        far.check(plan)
    elif order.scheduler is not None:
        far = SweepCluster(plan.base, order.scheduler)
    with SweepLog(folder, identity, order.retry) as log:
        before = len(log.rows)
        crew: SweepWorkers = far or LocalWorkers(
            partial(fly_job, plan.base),
            min(order.workers or count_cores(), max(1, plan.count - before)),
        )
        begun = time.monotonic()
        try:
            fly_missing(plan, log, crew, console)
        finally:
            wall = time.monotonic() - begun
            written = write_results(plan, log.sorted_rows, folder, order)
        flown = len(log.rows) - before
        return SweepRun(plan, log.sorted_rows, folder, *written, flown, crew.deaths, wall)


def fly_missing(plan: SweepPlan, log: SweepLog, workers: SweepWorkers, console: Console) -> None:
    """Fly what is not in the log."""
    done = set(log.rows)
    with SweepProgress(console, plan.count, len(done)) as progress, workers:
        for row in workers.run_jobs(plan.iterate_jobs(done)):
            log.add(row)
            progress.count_flight(row, workers.deaths)


def write_results(
    plan: SweepPlan, rows: list[SweepRow], folder: Path, order: SweepRequest
) -> tuple[Path, Path | None]:
    """Write table and page; return where they are."""
    path = folder / table.NAME
    origin = {
        'sweep': str(find_file('sweep', order.file)),
        'vehicle': plan.file.vehicle,
        'scenario': plan.file.scenario,
        'strategy': plan.file.strategy,
        'gains': plan.file.gains,
        'commit': read_commit(),
        **({'flown as': ' '.join(order.options)} if order.options else {}),
    }
    about = {
        **origin,
        'identity': order.compute_identity(plan),
        'file': plan.file.model_dump_json(),
    }
    table.write_table(rows, plan.units, about, path)
    if not order.page:
        return path, None
    told = page.SweepPageData(plan, rows, plan.units, folder, order.file, origin, order.options)
    return path, page.write_page(told)
