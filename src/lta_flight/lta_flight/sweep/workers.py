"""
Fly a sweep in worker processes of this machine, one flight at a time each.

If a worker dies, its flight is repeated once by another one, and a new worker is started. Workers
exit when the main process is gone.
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
CHANCES = 2  # attempts of a flight whose worker dies
STILLBORN = 3  # consecutive deaths per worker, without a flight, that stop the sweep


class SweepWorkers(Protocol):
    """Workers that fly jobs; `deaths` counts lost workers."""

    deaths: int

    def run_jobs(self, jobs: Iterator[SweepJob]) -> Iterator[SweepRow]:
        """Yield the rows of jobs as they finish."""
        ...

    def __enter__(self) -> Self:
        """Start the workers."""
        ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop the workers."""
        ...


def run_worker(connection: Connection, fly: Fly) -> None:
    """Fly jobs until there are no more, or the main process is gone."""
    with suppress(EOFError, OSError):
        while (job := connection.recv()) is not None:
            connection.send(fly(job))


@final
class WorkerProcess:
    """One process and its current job."""

    def __init__(self, fly: Fly) -> None:
        # A fork would copy numba's threads in an undefined state
        context = get_context('spawn')
        # Two-way: jobs go out, rows come back
        self.connection, theirs = context.Pipe()
        self.process: SpawnProcess = context.Process(
            target=run_worker, args=(theirs, fly), daemon=True
        )
        # The child inherits the blocked SIGINT, since the main process handles Ctrl-C. Start
        # Python's resource tracker before that, because it would unblock the signal
        resource_tracker.ensure_running()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            self.process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        # Otherwise our copy would keep the pipe open after the child has died
        theirs.close()
        self.job: SweepJob | None = None
        self.flown = 0

    def send_job(self, job: SweepJob) -> bool:
        """Send a job; return False if the process is gone."""
        self.job = job
        try:
            self.connection.send(job)
        except OSError:
            return False
        return True

    def kill(self) -> str:
        """Kill the process and return how it ended."""
        self.process.kill()
        self.process.join()
        self.connection.close()
        # Negative for a signal
        code = self.process.exitcode or 0
        return signal.Signals(-code).name if code < 0 else f'exit status {code}'


@final
class LocalWorkers:
    """
    Workers on this machine.

    Parameters
    ----------
    fly : callable
        Returns the row of a job and never raises; must be picklable.
    size : int
        Number of workers.

    """

    def __init__(self, fly: Fly, size: int) -> None:
        self._fly = fly
        self._size = size
        self._workers: list[WorkerProcess] = []
        self._losses: dict[int, int] = {}  # lost workers by index of the flight
        self._again: deque[SweepJob] = deque()
        self._stillborn = 0
        self.deaths = 0

    def __enter__(self) -> Self:
        """Limit BLAS to one thread per worker; workers start with their first job."""
        for name in ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS'):
            os.environ.setdefault(name, '1')
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Kill all workers."""
        while self._workers:
            self._workers.pop().kill()

    def run_jobs(self, jobs: Iterator[SweepJob]) -> Iterator[SweepRow]:
        """
        Yield the rows of jobs as they finish.

        Raises
        ------
        BadInput
            If workers die before they fly anything, which indicates a problem of the machine.

        """
        while self._assign_jobs(jobs):
            places: dict[object, WorkerProcess] = {each.connection: each for each in self._workers}
            # A closed connection counts as ready, so a death is noticed at once
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
        """Give a job to every idle worker, starting workers as needed; return False at the end."""
        while True:
            idle = next((worker for worker in self._workers if worker.job is None), None)
            # All workers are busy
            if idle is None and len(self._workers) >= self._size:
                return True
            job = self._again.popleft() if self._again else next(jobs, None)
            if job is None:
                return any(worker.job is not None for worker in self._workers)
            if idle is None:
                idle = WorkerProcess(self._fly)
                self._workers.append(idle)
            idle.send_job(job)  # if the worker is dead, the next `recv` from it fails

    def _remove_dead_worker(self, worker: WorkerProcess) -> Iterator[SweepRow]:
        """Remove a dead worker; repeat its job, or yield it as failed."""
        how = worker.kill()
        self._workers.remove(worker)
        self.deaths += 1
        # A worker that never finished a flight points to the machine, not to a flight
        self._stillborn += not worker.flown
        if self._stillborn >= STILLBORN * self._size:
            raise BadInput(
                f'{self._stillborn} worker processes in a row ended before they finished a flight '
                f'(the last with {how}); check whether memory ran out, or use fewer --workers.'
            )
        if (job := worker.job) is None:
            return
        losses = self._losses[job.index] = self._losses.get(job.index, 0) + 1
        # A flight that kills workers again is given up
        if losses < CHANCES:
            self._again.append(job)
            return
        yield build_failed_row(
            job, f'{losses} worker processes ended during this flight, the last by {how}.'
        )
