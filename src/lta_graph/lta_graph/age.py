"""How old what is stamped is, where a stamp of the future makes nothing fresh."""

import math
from typing import Final

AHEAD: Final = 0.3  # s that a stamp may lie ahead of us; farther, its clock or ours was set


def stamp_age(stamp_ns: int | None, now_ns: int) -> float:
    """
    Return the age of what is stamped so. [s].

    Infinite for nothing, and for the far future: as the newest word of all it would be followed
    until its time has come, long after its sender died.

    Parameters
    ----------
    stamp_ns : int or None
        Graph time; None where nothing has come. [ns]
    now_ns : int
        Graph time. [ns]

    """
    if stamp_ns is None:
        return math.inf
    passed = 1e-9 * (now_ns - stamp_ns)
    return passed if passed >= -AHEAD else math.inf
