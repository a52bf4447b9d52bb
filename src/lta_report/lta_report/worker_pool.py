"""Worker processes that ignore Ctrl-C and end with their parent."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.connection import wait
import os
import signal
from threading import Thread
from types import TracebackType
from typing import Any, final, Self, TypeVar

from lta_config.errors import BadInput

Result = TypeVar('Result')

KEPT = ' Finished work is stored; run the same command again to continue.'
# One thread per worker, since the workers already use all processors
ALONE = ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS')


def initialize_worker() -> None:
    """Ignore Ctrl-C, and exit when the parent process does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ALONE:  # before numpy is loaded, which reads them once
        os.environ.setdefault(name, '1')
    giver = parent_process()
    if giver is not None:
        # A daemon thread, because the worker's main thread blocks in the pool's queue
        Thread(target=_exit_with_parent, args=(giver.sentinel,), daemon=True).start()


def _exit_with_parent(sentinel: int) -> None:
    # Ready when the parent has exited
    wait([sentinel])
    os._exit(1)


@final
class WorkerPool:
    """
    A pool of worker processes as a context manager; with one job, work runs in this process.

    Leaving it by an exception, for example Ctrl-C, terminates running work.

    Parameters
    ----------
    jobs : int
        Number of processes.
    option : str
        The command-line option for it, named in messages.
    goes_on : bool
        Whether the command resumes when it is run again.

    """

    def __init__(self, jobs: int, option: str, goes_on: bool = False) -> None:
        self._pool = (
            # Forking a process with threads, as numba and rclpy start, is unsafe
            ProcessPoolExecutor(jobs, get_context('spawn'), initialize_worker)
            if jobs > 1
            else None
        )
        self._died = (
            'A worker process died, perhaps because memory ran out; try again with '
            f'{option} 1.{KEPT if goes_on else ""}'
        )

    def map_unordered(
        self, work: Callable[..., Result], each: Sequence[tuple[Any, ...]]
    ) -> Iterator[Result]:
        """
        Yield the results of calls in the order in which they finish.

        Parameters
        ----------
        work : callable
            A function at the top of a module, which can be pickled.
        each : sequence of tuples
            The arguments of each call.

        Raises
        ------
        BadInput
            If a process dies.

        """
        if self._pool is None:
            for arguments in each:
                yield work(*arguments)
            return
        coming = []
        try:
            coming += [self._pool.submit(work, *arguments) for arguments in each]
            for one in as_completed(coming):
                yield one.result()
        except BrokenProcessPool:
            raise BadInput(self._died) from None
        finally:
            for one in coming:
                # After an error, drop calls that have not started
                one.cancel()

    def __enter__(self) -> Self:
        """Return this pool."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop all workers; terminate them after an exception."""
        if self._pool is None:
            return
        if kind is not None:
            for child in active_children():
                # Otherwise shutdown would wait for running calls, which may take minutes
                child.terminate()
        self._pool.shutdown(wait=True, cancel_futures=True)


def run_in_workers(
    work: Callable[..., Result],
    each: Sequence[tuple[Any, ...]],
    jobs: int,
    option: str,
    goes_on: bool = False,
) -> Iterator[Result]:
    """Yield the results of calls in the order in which they finish, from a temporary pool."""
    with WorkerPool(jobs, option, goes_on) as children:
        yield from children.map_unordered(work, each)
