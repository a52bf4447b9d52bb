"""
Run a function on many items in worker processes of this machine or on a Dask cluster.

An error in the function, or the death of its worker, gives an `ItemFailure` and does not stop the
other items. Workers exit when the main process is gone.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from multiprocessing import get_context, parent_process, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
import os
from pickle import PicklingError
import signal
from threading import Thread
from typing import Any, Final, final, Generic, NamedTuple, Protocol, Self, TypeVar

from lta_config.errors import BadInput
from lta_config.machine import count_cores
from lta_report.cluster import connect_cluster

Item = TypeVar('Item')
Result = TypeVar('Result')
Outcome = TypeVar('Outcome', covariant=True)

CHANCES: Final = 2  # attempts of an item whose worker dies
STILLBORN: Final = 3  # consecutive deaths per worker, without a result, that stop the run
AHEAD: Final = 4  # items queued per thread of a cluster, so that none waits for the network
# One thread per worker, since the workers already use all cores
THREADS: Final = ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS')


class ItemFailure(NamedTuple):
    """Stands for the result of an item that could not be finished; `reason` is a sentence."""

    reason: str


class Workers(Protocol[Item, Outcome]):
    """Workers that apply a function to items; `lost` counts workers that died."""

    lost: int

    def run(self, items: Iterable[Item]) -> Iterator[tuple[Item, Outcome | ItemFailure]]:
        """Yield each item with its result or failure, as they finish."""
        ...

    def __enter__(self) -> Self:
        """Start the workers."""
        ...

    def __exit__(self, *_: object) -> None:
        """Stop the workers."""
        ...


_reporter: ContextVar[Callable[[float], None] | None] = ContextVar('reporter', default=None)


def report_progress(share: float) -> None:
    """Report the finished share of the current item; the function of the workers may call it."""
    if (report := _reporter.get()) is not None:
        report(share)


def attempt(function: Callable[[Item], Result], item: Item) -> Result | ItemFailure:
    """Apply the function to an item; any error gives a failure."""
    try:
        return function(item)
    except BadInput as error:
        return ItemFailure(str(error))
    except Exception as error:  # one item must not end the others
        return ItemFailure(f'{type(error).__name__}: {error}')


def serve_items(connection: Connection, function: Callable[[Any], Any]) -> None:
    """Work in a worker process until it is killed or the main process is gone."""
    if (parent := parent_process()) is not None:
        # A daemon thread, because the main thread may compute for minutes
        Thread(target=_exit_with_parent, args=(parent.sentinel,), daemon=True).start()
    # A message is the share of an unfinished item, or None and the outcome
    _reporter.set(lambda share: connection.send((share, None)))
    with suppress(EOFError, OSError):
        while True:
            outcome = attempt(function, connection.recv())
            try:
                connection.send((None, outcome))
            except (AttributeError, PicklingError, TypeError, ValueError) as error:
                connection.send((None, ItemFailure(f'The result cannot be sent: {error}')))


def _exit_with_parent(sentinel: int) -> None:
    # Ready when the parent has exited
    wait([sentinel])
    os._exit(1)


@contextmanager
def _worker_environment() -> Iterator[None]:
    """
    Block SIGINT and limit BLAS to one thread; processes started meanwhile inherit both.

    They take no module from the current folder, as Python's own start of a process would.
    """
    missing = [name for name in (*THREADS, 'PYTHONSAFEPATH') if name not in os.environ]
    os.environ.update(dict.fromkeys(missing, '1'))
    # Start Python's resource tracker before, because it would unblock the signal
    resource_tracker.ensure_running()
    # The main process handles Ctrl-C
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        for name in missing:
            del os.environ[name]


@final
@dataclass(slots=True)
class _Task(Generic[Item]):
    """An item, the number of workers lost over it, and its finished share."""

    item: Item
    losses: int = 0
    share: float = 0.0


@final
class WorkerProcess(Generic[Item, Result]):
    """One process and its current task."""

    def __init__(self, function: Callable[[Item], Result]) -> None:
        # Forking a process with threads, as numba and rclpy start, is unsafe
        context = get_context('spawn')
        # Two-way: items go out, results come back
        self.connection, theirs = context.Pipe()
        self.process: SpawnProcess = context.Process(
            target=serve_items, args=(theirs, function), daemon=True
        )
        with _worker_environment():
            self.process.start()
        # Otherwise our copy would keep the pipe open after the child has died
        theirs.close()
        self.task: _Task[Item] | None = None
        self.finished = 0

    def start_task(self, task: _Task[Item]) -> None:
        """Send an item; if the process is gone, the next `recv` from it fails."""
        self.task = task
        with suppress(OSError):
            self.connection.send(task.item)

    def kill(self) -> str:
        """Kill the process and return how it ended."""
        self.process.kill()
        self.process.join()
        self.connection.close()
        # Negative for a signal
        code = self.process.exitcode or 0
        return signal.Signals(-code).name if code < 0 else f'exit status {code}'


@final
class LocalWorkers(Generic[Item, Result]):
    """
    Worker processes of this machine; one worker is this process itself.

    If a worker dies, its item is repeated once by another one, and a new worker is started.
    Within a worker process there is only this process, since its siblings use the other cores.

    `function`: a function at the top of a module, or a `partial` of one, which can be pickled.
    `size`: number of workers; a process starts when there is an item for it. `on_progress`: called
    with the sum of the finished shares of the current items, if the function calls
    `report_progress`.
    """

    def __init__(
        self,
        function: Callable[[Item], Result],
        size: int,
        on_progress: Callable[[float], None] | None = None,
    ) -> None:
        self._function = function
        self._size = 1 if parent_process() is not None else size
        self._on_progress = on_progress
        self._workers: list[WorkerProcess[Item, Result]] = []
        self._again: deque[_Task[Item]] = deque()
        self._stillborn = 0
        self.lost = 0

    def __enter__(self) -> Self:
        """Return this object."""
        return self

    def __exit__(self, *_: object) -> None:
        """Kill all workers."""
        while self._workers:
            self._workers.pop().kill()

    def run(self, items: Iterable[Item]) -> Iterator[tuple[Item, Result | ItemFailure]]:
        """
        Yield each item with its result or failure, as they finish.

        Raise `BadInput` if workers die before they finish anything, which indicates a problem of
        the machine.
        """
        if self._size == 1:
            yield from self._run_here(items)
            return
        tasks = map(_Task, items)
        try:
            while self._assign_tasks(tasks):
                workers: dict[object, WorkerProcess[Item, Result]] = {
                    each.connection: each for each in self._workers
                }
                # A closed connection counts as ready, so a death is noticed at once
                for ready in wait(list(workers)):  # type: ignore[arg-type]
                    yield from self._receive_message(workers[ready])
        finally:
            # Workers that are still busy would send old results to the next run
            for worker in [each for each in self._workers if each.task is not None]:
                worker.kill()
                self._workers.remove(worker)
            self._again.clear()

    def _run_here(self, items: Iterable[Item]) -> Iterator[tuple[Item, Result | ItemFailure]]:
        for item in items:
            token = _reporter.set(self._on_progress)
            try:
                outcome = attempt(self._function, item)
            finally:
                _reporter.reset(token)
            yield item, outcome

    def _assign_tasks(self, tasks: Iterator[_Task[Item]]) -> bool:
        """Give every idle worker a task, and start workers as needed; return False at the end."""
        while True:
            idle = next((worker for worker in self._workers if worker.task is None), None)
            # All workers are busy
            if idle is None and len(self._workers) >= self._size:
                return True
            task = self._again.popleft() if self._again else next(tasks, None)
            if task is None:
                return any(worker.task is not None for worker in self._workers)
            if idle is None:
                idle = WorkerProcess(self._function)
                self._workers.append(idle)
            idle.start_task(task)

    def _receive_message(
        self, worker: WorkerProcess[Item, Result]
    ) -> Iterator[tuple[Item, Result | ItemFailure]]:
        try:
            share, outcome = worker.connection.recv()
        except (EOFError, OSError):
            yield from self._remove_dead_worker(worker)
            return
        task = worker.task
        assert task is not None
        if share is not None:
            task.share = share
            if self._on_progress is not None:
                self._on_progress(sum(each.task.share for each in self._workers if each.task))
            return
        worker.task, worker.finished, self._stillborn = None, worker.finished + 1, 0
        yield task.item, outcome

    def _remove_dead_worker(
        self, worker: WorkerProcess[Item, Result]
    ) -> Iterator[tuple[Item, ItemFailure]]:
        """Remove a dead worker; repeat its task, or yield it as failed."""
        how = worker.kill()
        self._workers.remove(worker)
        self.lost += 1
        # A worker that never finished an item points to the machine, not to an item
        self._stillborn += not worker.finished
        if self._stillborn >= STILLBORN * self._size:
            raise BadInput(
                f'{self._stillborn} worker processes in a row ended before they finished anything '
                f'(the last with {how}); check whether memory ran out, or use fewer --workers.'
            )
        if (task := worker.task) is None:
            return
        task.losses, task.share = task.losses + 1, 0.0
        # An item that kills workers again is given up
        if task.losses < CHANCES:
            self._again.append(task)
            return
        yield (
            task.item,
            ItemFailure(
                f'{task.losses} worker processes ended during this computation, the last by {how}.'
            ),
        )


@final
class DaskWorkers(Generic[Item, Result]):
    """
    Workers of a Dask cluster, whose machines need LTA with its shipped files.

    `function`: a function that can be pickled; it is sent to each worker once. `address`: address
    of the scheduler, such as tcp://127.0.0.1:8786. Raise `BadInput` if dask.distributed is not
    installed, or no scheduler answers.
    """

    def __init__(self, function: Callable[[Item], Result], address: str) -> None:
        self._dask, self._client = connect_cluster(address)
        self._function = function
        self.lost = 0  # items given up; Dask replaces lost workers silently

    def __enter__(self) -> Self:
        """Send the function to all workers."""
        self._there = self._client.scatter(self._function, broadcast=True, hash=False)
        return self

    def __exit__(self, *_: object) -> None:
        """Cancel pending items and disconnect."""
        # The scheduler may have gone already
        with suppress(OSError):
            self._client.close()

    def run(self, items: Iterable[Item]) -> Iterator[tuple[Item, Result | ItemFailure]]:
        """Yield each item with its result or failure; Dask repeats items of lost workers."""
        pending: dict[Any, Item] = {}
        coming = iter(items)
        # At least one, if the workers have just been lost
        threads = sum(self._client.nthreads().values()) or 1
        running = self._dask.as_completed([], loop=self._client.loop)
        for _ in range(AHEAD * threads):
            self._submit_next(coming, pending, running)
        for future in running:
            item = pending.pop(future.key)
            # Only the cluster fails here; errors of the function are failures already
            error = future.exception()
            yield item, future.result() if error is None else self._describe_loss(error)
            # Frees the result on the cluster
            future.release()
            self._submit_next(coming, pending, running)

    def _submit_next(
        self,
        items: Iterator[Item],
        pending: dict[Any, Item],
        running: Any,  # noqa: ANN401 - Dask has no types
    ) -> None:
        for item in items:
            # pure=False: equal arguments must not return an earlier result
            future = self._client.submit(attempt, self._there, item, pure=False)
            pending[future.key] = item
            running.add(future)
            return

    def _describe_loss(self, error: BaseException) -> ItemFailure:
        self.lost += 1
        reason = ' '.join(str(error).split())
        return ItemFailure(
            f'The Dask cluster could not finish this: {type(error).__name__}: {reason}'
        )


def open_workers(
    function: Callable[[Item], Result],
    workers: int | None = None,
    scheduler: str | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> Workers[Item, Result]:
    """
    Return the workers that the options --workers and --scheduler select.

    Raise `BadInput` if both options are given, or no scheduler answers.
    """
    if scheduler is None:
        return LocalWorkers(function, workers or count_cores(), on_progress)
    if workers is not None:
        # An ignored option would be misleading
        raise BadInput(
            '--workers has no effect with --scheduler, where the cluster determines the number of '
            'workers; remove one of them.'
        )
    return DaskWorkers(function, scheduler)
