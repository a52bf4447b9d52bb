"""Processes that work for this one: they leave Ctrl-C to it, and end when it does."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.connection import wait
import os
import signal
from threading import Thread
from typing import Any, TypeVar

from lta_config.errors import BadInput

Result = TypeVar('Result')


def begin() -> None:
    """Leave Ctrl-C to whoever gives the work, and end when that process does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    giver = parent_process()
    if giver is not None:
        Thread(target=_end_with, args=(giver.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait([sentinel])
    os._exit(1)


def done_by(
    work: Callable[..., Result], each: Sequence[tuple[Any, ...]], jobs: int
) -> Iterator[Result]:
    """
    Yield what comes of some work in whatever order it is done; in this process with one job.

    Whoever stops early, by Ctrl-C for one, stops what is being worked on.

    Parameters
    ----------
    work : callable
        Of a module, so that another process finds it.
    each : sequence of tuples
        Its arguments.
    jobs : int
        Processes.

    Raises
    ------
    BadInput
        If a process dies.

    """
    if jobs == 1:
        for arguments in each:
            yield work(*arguments)
        return
    pool = ProcessPoolExecutor(jobs, get_context('spawn'), begin)
    try:
        coming = [pool.submit(work, *arguments) for arguments in each]
        for one in as_completed(coming):
            yield one.result()
    except BrokenProcessPool:
        raise BadInput(
            'A process that worked on a case died; see whether memory is short, or use --jobs 1.'
        ) from None
    except BaseException:
        for child in active_children():
            child.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
