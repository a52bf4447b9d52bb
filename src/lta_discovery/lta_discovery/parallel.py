# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Run work on several flights in parallel threads.

Most of the work is compiled code that releases the GIL.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import parent_process
from typing import TypeVar

from lta_config.machine import count_cores

Given = TypeVar('Given')
Result = TypeVar('Result')


def map_parallel(work: Callable[[Given], Result], items: Sequence[Given]) -> list[Result]:
    """
    Apply a function to each item in a thread pool and return the results in order.

    Child processes use a single thread, to leave the other processors to their siblings. NumPy's
    error state is per thread: `work` has to set its own, and must not change shared data.
    """
    threads = 1 if parent_process() is not None else count_cores()
    threads = min(threads, len(items))
    if threads < 2:
        return [work(one) for one in items]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(work, items))
