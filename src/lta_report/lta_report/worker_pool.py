"""Processes that work for this one: they leave Ctrl-C to it, and end when it does."""

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

KEPT = ' What was done is kept: give the same command again to go on.'
ALONE = ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS')


def initialize_worker() -> None:
    """Leave Ctrl-C to whoever gives the work, and end when that process does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ALONE:  # before anything loads numpy: the others have the processors
        os.environ.setdefault(name, '1')
    giver = parent_process()
    if giver is not None:
        Thread(target=_exit_with_parent, args=(giver.sentinel,), daemon=True).start()


def _exit_with_parent(sentinel: int) -> None:
    wait([sentinel])
    os._exit(1)


@final
class WorkerPool:
    """
    Some processes, as a context manager; with one job, all is done in this one.

    Whoever leaves early, by Ctrl-C for one, stops what is being worked on.

    Parameters
    ----------
    jobs : int
        Processes.
    option : str
        Of the command line, that says how many.
    goes_on : bool
        Whether the command keeps what was done, and goes on there when it is given again.

    """

    def __init__(self, jobs: int, option: str, goes_on: bool = False) -> None:
        self._pool = (
            ProcessPoolExecutor(jobs, get_context('spawn'), initialize_worker)
            if jobs > 1
            else None
        )
        self._died = (
            'A process that worked for this one died; see whether memory is short, or use '
            f'{option} 1.{KEPT if goes_on else ""}'
        )

    def map_unordered(
        self, work: Callable[..., Result], each: Sequence[tuple[Any, ...]]
    ) -> Iterator[Result]:
        """
        Yield what comes of some work in whatever order it is done.

        Parameters
        ----------
        work : callable
            Of a module, so that another process finds it.
        each : sequence of tuples
            Its arguments.

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
                one.cancel()

    def __enter__(self) -> Self:
        """Be ready."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave nobody behind."""
        if self._pool is None:
            return
        if kind is not None:
            for child in active_children():
                child.terminate()
        self._pool.shutdown(wait=True, cancel_futures=True)


def run_in_workers(
    work: Callable[..., Result],
    each: Sequence[tuple[Any, ...]],
    jobs: int,
    option: str,
    goes_on: bool = False,
) -> Iterator[Result]:
    """Yield what comes of some work in whatever order it is done, by `WorkerPool` of its own."""
    with WorkerPool(jobs, option, goes_on) as children:
        yield from children.map_unordered(work, each)
