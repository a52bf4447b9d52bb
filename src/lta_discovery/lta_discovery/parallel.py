"""
Run work on several flights in parallel threads.

Most of the work is compiled code that releases the GIL.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import parent_process
import os
from typing import TypeVar

Given = TypeVar('Given')
Result = TypeVar('Result')


def map_parallel(work: Callable[[Given], Result], items: Sequence[Given]) -> list[Result]:
    """
    Apply a function to each item in a thread pool and return the results in order.

    Child processes use a single thread, to leave the other processors to their siblings. NumPy's
    error state is per thread: `work` has to set its own, and must not change shared data.
    """
    # `sched_getaffinity` respects the cores that a container grants
    threads = 1 if parent_process() is not None else len(os.sched_getaffinity(0))
    threads = min(threads, len(items))
    if threads < 2:
        return [work(one) for one in items]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(work, items))
