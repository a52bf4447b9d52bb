"""Compute the age of stamped data; a stamp far in the future does not count as fresh."""

import math
from typing import Final

AHEAD: Final = 0.3  # s; a stamp further ahead of our clock means that a clock was changed


def stamp_age(stamp_ns: int | None, now_ns: int) -> float:
    """
    Return the age [s] of data stamped `stamp_ns` at graph time `now_ns` [ns].

    The age is infinite if there is no stamp, or if it is far in the future: otherwise such data
    would stay the newest long after its sender died.
    """
    if stamp_ns is None:
        return math.inf
    # Small negative ages come from the delay between clocks
    passed = 1e-9 * (now_ns - stamp_ns)
    return passed if passed >= -AHEAD else math.inf
