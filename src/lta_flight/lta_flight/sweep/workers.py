"""
Processes of this machine that fly a sweep, one flight at a time each.

A worker that dies takes nothing with it: its flight is given to another one, once, and a new
worker takes its place. Workers end by themselves when whoever gave them work is gone.
"""

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
import os
import signal
from types import TracebackType
from typing import final, Protocol, Self

from lta_config.errors import BadInput
from lta_flight.sweep.job_runner import build_failed_row, SweepRow
from lta_flight.sweep.plan import SweepJob

Fly = Callable[[SweepJob], SweepRow]
CHANCES = 2  # workers that may die over one flight
STILLBORN = 3  # workers in a row that die before they have flown anything


class SweepWorkers(Protocol):
    """Whoever flies jobs; `deaths` counts workers lost."""

    deaths: int

    def run_jobs(self, jobs: Iterator[SweepJob]) -> Iterator[SweepRow]:
        """Yield the rows of all jobs as they come."""
        ...

    def __enter__(self) -> Self:
        """Be ready."""
        ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave nobody behind."""
        ...


def run_worker(connection: Connection, fly: Fly) -> None:
    """Fly jobs until there are no more, or nobody is there to give any."""
    with suppress(EOFError, OSError):
        while (job := connection.recv()) is not None:
            connection.send(fly(job))


@final
class WorkerProcess:
    """One process and the job that it is at."""

    def __init__(self, fly: Fly) -> None:
        context = get_context('spawn')
        self.connection, theirs = context.Pipe()
        self.process: SpawnProcess = context.Process(
            target=run_worker, args=(theirs, fly), daemon=True
        )
        # The child keeps this mask: a Ctrl-C is for whoever gives the work to answer. Python's
        # tracker of resources takes it off where it starts, with the first child at the latest.
        resource_tracker.ensure_running()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            self.process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        theirs.close()
        self.job: SweepJob | None = None
        self.flown = 0

    def send_job(self, job: SweepJob) -> bool:
        """Hand a job over; False if nobody is there to take it."""
        self.job = job
        try:
            self.connection.send(job)
        except OSError:
            return False
        return True

    def kill(self) -> str:
        """Make sure that it has ended; return how."""
        self.process.kill()
        self.process.join()
        self.connection.close()
        code = self.process.exitcode or 0
        return signal.Signals(-code).name if code < 0 else f'exit status {code}'


@final
class LocalWorkers:
    """
    Workers on this machine.

    Parameters
    ----------
    fly : callable
        Returns the row of a job, whatever happens; a function that a new process can find, or a
        `partial` of one.
    size : int
        Workers.

    """

    def __init__(self, fly: Fly, size: int) -> None:
        self._fly = fly
        self._size = size
        self._workers: list[WorkerProcess] = []
        self._losses: dict[int, int] = {}  # by flight
        self._again: deque[SweepJob] = deque()
        self._stillborn = 0
        self.deaths = 0

    def __enter__(self) -> Self:
        """Be ready; workers start with the first job. One thread of BLAS each."""
        for name in ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS'):
            os.environ.setdefault(name, '1')
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End all workers, whatever they are at."""
        while self._workers:
            self._workers.pop().kill()

    def run_jobs(self, jobs: Iterator[SweepJob]) -> Iterator[SweepRow]:
        """
        Yield the rows of all jobs as they come.

        Raises
        ------
        BadInput
            If workers die before they fly anything: something is wrong with the machine.

        """
        while self._assign_jobs(jobs):
            places: dict[object, WorkerProcess] = {each.connection: each for each in self._workers}
            for ready in wait(list(places)):  # type: ignore[arg-type]
                worker = places[ready]
                try:
                    row: SweepRow = worker.connection.recv()
                except (EOFError, OSError):
                    yield from self._remove_dead_worker(worker)
                    continue
                worker.job, worker.flown, self._stillborn = None, worker.flown + 1, 0
                yield row

    def _assign_jobs(self, jobs: Iterator[SweepJob]) -> bool:
        """Give every idle worker a job, starting workers as needed; False if all is done."""
        while True:
            idle = next((worker for worker in self._workers if worker.job is None), None)
            if idle is None and len(self._workers) >= self._size:
                return True
            job = self._again.popleft() if self._again else next(jobs, None)
            if job is None:
                return any(worker.job is not None for worker in self._workers)
            if idle is None:
                idle = WorkerProcess(self._fly)
                self._workers.append(idle)
            idle.send_job(job)  # if nobody takes it, its connection says so at the next look

    def _remove_dead_worker(self, worker: WorkerProcess) -> Iterator[SweepRow]:
        """Take a dead worker out; its job goes to another, or is given up."""
        how = worker.kill()
        self._workers.remove(worker)
        self.deaths += 1
        self._stillborn += not worker.flown
        if self._stillborn >= STILLBORN * self._size:
            raise BadInput(
                f'{self._stillborn} workers in a row died before they flew anything, the last by '
                f'{how}; see whether memory is short, or use fewer --workers.'
            )
        if (job := worker.job) is None:
            return
        losses = self._losses[job.index] = self._losses.get(job.index, 0) + 1
        if losses < CHANCES:
            self._again.append(job)
            return
        yield build_failed_row(job, f'{losses} workers died over this flight, the last by {how}.')
