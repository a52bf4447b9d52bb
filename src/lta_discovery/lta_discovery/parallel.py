"""Flights side by side: what is asked of each is nearly all compiled code, which frees the GIL."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import parent_process
import os
from typing import TypeVar

Given = TypeVar('Given')
Result = TypeVar('Result')


def map_parallel(work: Callable[[Given], Result], items: Sequence[Given]) -> list[Result]:
    """
    Return what comes of some work on each of a few things, in their order.

    A process that was given its work leaves the other processors to the others (`children`).
    NumPy's error state is that of the thread: `work` has to set its own.

    Parameters
    ----------
    work : callable
        Of one of them; it changes nothing that another one reads.
    given : sequence
        Of flights, or of the two sides of a study.

    """
    threads = 1 if parent_process() is not None else len(os.sched_getaffinity(0))
    threads = min(threads, len(items))
    if threads < 2:
        return [work(one) for one in items]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(work, items))
