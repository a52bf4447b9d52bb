"""Count the processor cores that this process may use."""

import os


def count_cores() -> int:
    """Return the number of processor cores that this process may use."""
    # Respects the limits of containers and taskset, unlike os.cpu_count
    return len(os.sched_getaffinity(0))
