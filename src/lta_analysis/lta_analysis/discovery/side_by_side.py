"""
Independent pieces of work on all cores.

In threads: compiled replays and matrix products let others run meanwhile, and nothing has to be
copied. What comes out does not depend on how many there are: each piece of work has its own
arrays, and answers keep the order of the questions.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
import os
from typing import TypeVar

Item = TypeVar('Item')
Answer = TypeVar('Answer')


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0))


def side_by_side(
    work: Callable[[Item], Answer], items: Iterable[Item], workers: int | None = None
) -> list[Answer]:
    """
    Return the answer to each item.

    Parameters
    ----------
    work : callable
        Called with each item, several at a time; it must change nothing that another reads.
    items : iterable
        What to work on.
    workers : int, optional
        How many at a time; as many as there are cores if not given.

    Returns
    -------
    list
        Answers in the order of the items, the same for any number of workers.

    Raises
    ------
    Exception
        That of the first item, in their order, whose work failed; what has not begun by then is
        left out.

    """
    known = list(items)
    count = min(workers or cores(), len(known))
    if count < 2:
        return [work(item) for item in known]
    pool = ThreadPoolExecutor(count)
    try:
        return list(pool.map(work, known))
    finally:
        pool.shutdown(cancel_futures=True)
