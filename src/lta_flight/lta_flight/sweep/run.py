"""A sweep from its file to its table and page: checked first, flown, kept whatever happens."""

from dataclasses import dataclass
from functools import partial
import hashlib
import os
from pathlib import Path
import time
from typing import final

from lta_bridge.provenance import commit
from lta_config.files import find
from lta_config.schema.sweep_file import load_sweep
from lta_flight.fleet.fly import Device
from lta_flight.sweep import page, table
from lta_flight.sweep.cluster import ClusterCrew
from lta_flight.sweep.crew import Crew, LocalCrew
from lta_flight.sweep.fleet_crew import FleetCrew
from lta_flight.sweep.flown import fly_job, Row
from lta_flight.sweep.log import Log
from lta_flight.sweep.plan import Plan
from lta_flight.sweep.progress import SweepProgress
from rich.console import Console


@final
@dataclass(frozen=True, slots=True)
class Order:
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

    def identity(self, plan: Plan) -> str:
        """Return the hash of all that decides the flights."""
        if not self.options:
            return plan.identity
        return hashlib.sha256(' '.join((plan.identity, *self.options)).encode()).hexdigest()


@final
@dataclass(frozen=True, slots=True)
class Swept:
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

    plan: Plan
    rows: list[Row]
    folder: Path
    table: Path
    page: Path | None
    flown: int
    deaths: int
    wall: float


def cores() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0))


def sweep_once(order: Order, console: Console) -> Swept:
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
    plan = Plan(file)
    plan.check()
    identity = order.identity(plan)
    folder = (order.out or Path('runs') / f'sweep-{file.name}-{identity[:8]}').absolute()
    far: Crew | None = None
    if order.device is not None:
        far = FleetCrew(plan.base, order.device, order.duties)
    elif order.scheduler is not None:
        far = ClusterCrew(plan.base, order.scheduler)
    with Log(folder, identity, order.retry) as log:
        before = len(log.rows)
        crew: Crew = far or LocalCrew(
            partial(fly_job, plan.base), min(order.workers or cores(), max(1, plan.count - before))
        )
        begun = time.monotonic()
        try:
            fly(plan, log, crew, console)
        finally:
            wall = time.monotonic() - begun
            written = write(plan, log.ordered, folder, order)
        flown = len(log.rows) - before
        return Swept(plan, log.ordered, folder, *written, flown, crew.deaths, wall)


def fly(plan: Plan, log: Log, crew: Crew, console: Console) -> None:
    """Fly what is not in the log."""
    done = set(log.rows)
    with SweepProgress(console, plan.count, len(done)) as progress, crew:
        for row in crew.fly(plan.jobs(done)):
            log.add(row)
            progress.flown(row, crew.deaths)


def write(plan: Plan, rows: list[Row], folder: Path, order: Order) -> tuple[Path, Path | None]:
    """Write table and page; return where they are."""
    path = folder / table.NAME
    origin = {
        'sweep': str(find('sweep', order.file)),
        'vehicle': plan.file.vehicle,
        'scenario': plan.file.scenario,
        'strategy': plan.file.strategy,
        'gains': plan.file.gains,
        'commit': commit(),
        **({'flown as': ' '.join(order.options)} if order.options else {}),
    }
    about = {**origin, 'identity': order.identity(plan), 'file': plan.file.model_dump_json()}
    table.write_table(rows, plan.units, about, path)
    if not order.page:
        return path, None
    told = page.Told(plan, rows, plan.units, folder, order.file, origin, order.options)
    return path, page.write_page(told)
