# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Run a function on many items in worker processes of this machine or on a Dask cluster.

An error in the function, or the death of its worker, gives an `ItemFailure` and does not stop the
other items. Workers exit when the main process is gone.
"""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from itertools import islice
from multiprocessing import get_context, parent_process, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
import os
from pickle import PicklingError
from queue import SimpleQueue
import signal
from threading import Lock, Thread
from typing import Any, Final, final, Generic, NamedTuple, Protocol, Self, TypeVar

from lta_config.errors import BadInput
from lta_config.machine import count_cores
from lta_report.cluster import connect_cluster

Item = TypeVar('Item')
Result = TypeVar('Result')
Outcome = TypeVar('Outcome', covariant=True)

CHANCES: Final = 2  # attempts of an item whose worker dies
STILLBORN: Final = 3  # consecutive deaths per worker, without a result, that stop the run
QUEUED_PER_THREAD: Final = (
    4  # items queued per thread of a cluster, so that none waits for the network
)
# One thread per worker, since the workers already use all cores
THREAD_VARIABLES: Final = ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS')


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
    missing = [name for name in (*THREAD_VARIABLES, 'PYTHONSAFEPATH') if name not in os.environ]
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


def iterate_finished(
    submit: Callable[[Item], Any], items: Iterable[Item], ahead: int
) -> Iterator[tuple[Item, Any]]:
    """
    Yield items with their finished futures, as they finish.

    `submit`: returns the future of an item, of `concurrent.futures` or of Dask. `ahead`: items
    that are submitted at the same time.
    """
    pending: dict[Any, Item] = {}
    done: SimpleQueue[Any] = SimpleQueue()
    coming = iter(items)
    while True:
        for item in islice(coming, ahead - len(pending)):
            future = submit(item)
            pending[future] = item
            future.add_done_callback(done.put)
        if not pending:
            return
        future = done.get()
        yield pending.pop(future), future


@final
class WorkerProcess(Generic[Item, Result]):
    """A process that applies a function to one item at a time."""

    def __init__(self, function: Callable[[Item], Result]) -> None:
        # Forking a process with threads, as numba and rclpy start, is unsafe
        context = get_context('spawn')
        # Two-way: items go out, results come back
        self._connection, theirs = context.Pipe()
        self.process: SpawnProcess = context.Process(
            target=serve_items, args=(theirs, function), daemon=True
        )
        with _worker_environment():
            self.process.start()
        # Otherwise our copy would keep the pipe open after the child has died
        theirs.close()
        self.share = 0.0  # finished share of the current item
        self.finished = 0  # number of its items

    def work(self, item: Item, on_share: Callable[[], None] | None) -> Result | ItemFailure:
        """Return the outcome of an item; raise `EOFError` or `OSError` if the process dies."""
        self._connection.send(item)
        while True:
            share, outcome = self._connection.recv()
            if share is None:
                self.share, self.finished = 0.0, self.finished + 1
                return outcome  # type: ignore[no-any-return]
            self.share = share
            if on_share is not None:
                on_share()

    def kill(self) -> str:
        """Kill the process and return how it ended."""
        self.process.kill()
        self.process.join()
        self._connection.close()
        # Negative for a signal
        code = self.process.exitcode or 0
        return signal.Signals(-code).name if code < 0 else f'exit status {code}'


@final
class LocalWorkers(Generic[Item, Result]):
    """
    Worker processes of this machine, a thread for each; one worker is this process itself.

    If a worker dies, its item is repeated once by another one. Within a worker process there is
    only this process, since its siblings use the other cores.

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
        self._lock = Lock()  # of everything below
        self._idle: list[WorkerProcess[Item, Result]] = []
        self._busy: list[WorkerProcess[Item, Result]] = []
        self._stopping = False
        self._stillborn = 0
        self.lost = 0

    def __enter__(self) -> Self:
        """Return this object."""
        return self

    def __exit__(self, *_: object) -> None:
        """Kill all workers."""
        while self._idle:
            self._idle.pop().kill()

    def run(self, items: Iterable[Item]) -> Iterator[tuple[Item, Result | ItemFailure]]:
        """
        Yield each item with its result or failure, as they finish.

        Raise `BadInput` if workers die before they finish anything, which indicates a problem of
        the machine.
        """
        if self._size == 1:
            yield from self._run_here(items)
            return
        self._stopping = False
        with ThreadPoolExecutor(self._size) as threads:
            try:
                for item, future in iterate_finished(
                    lambda item: threads.submit(self._compute, item), items, self._size
                ):
                    yield item, future.result()
            finally:
                # Workers that are still busy, after Ctrl-C or when a run is left, are of no use
                with self._lock:
                    self._stopping = True
                    for worker in self._busy:
                        worker.process.kill()

    def _run_here(self, items: Iterable[Item]) -> Iterator[tuple[Item, Result | ItemFailure]]:
        for item in items:
            token = _reporter.set(self._on_progress)
            try:
                outcome = attempt(self._function, item)
            finally:
                _reporter.reset(token)
            yield item, outcome

    def _compute(self, item: Item) -> Result | ItemFailure:
        """Return the outcome of an item from the next idle worker, in a thread."""
        how = ''
        for _ in range(CHANCES):
            with self._lock:
                if self._stopping:
                    break
                worker = self._idle.pop() if self._idle else WorkerProcess(self._function)
                self._busy.append(worker)
            try:
                outcome = worker.work(item, self._on_progress and self._sum_progress)
            except (EOFError, OSError):
                with self._lock:
                    self._busy.remove(worker)
                    how = worker.kill()
                    if not self._stopping:
                        self._count_death(worker, how)
                continue
            with self._lock:
                self._busy.remove(worker)
                self._idle.append(worker)
                self._stillborn = 0
            return outcome
        return ItemFailure(
            f'{CHANCES} worker processes ended during this computation, the last by {how}.'
        )

    def _sum_progress(self) -> None:
        assert self._on_progress is not None
        with self._lock:
            self._on_progress(sum(worker.share for worker in self._busy))

    def _count_death(self, worker: WorkerProcess[Item, Result], how: str) -> None:
        self.lost += 1
        # A worker that never finished an item points to the machine, not to an item
        self._stillborn += not worker.finished
        if self._stillborn >= STILLBORN * self._size:
            raise BadInput(
                f'{self._stillborn} worker processes in a row ended before they finished anything '
                f'(the last with {how}); check whether memory ran out, or use fewer --workers.'
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
        self._client = connect_cluster(address)
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
        # At least one, if the workers have just been lost
        threads = sum(self._client.nthreads().values()) or 1
        for item, future in iterate_finished(
            # pure=False: equal arguments must not return an earlier result
            lambda item: self._client.submit(attempt, self._there, item, pure=False),
            items,
            QUEUED_PER_THREAD * threads,
        ):
            # Only the cluster fails here; errors of the function are failures already
            error = future.exception()
            yield item, future.result() if error is None else self._describe_loss(error)

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
