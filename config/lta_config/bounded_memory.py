"""Limit the memory of third-party readers, which trust the sizes that a file declares."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
import resource

from lta_config.limits import READER_MEMORY


@contextmanager
def limit_memory() -> Iterator[None]:
    """
    Limit the block to `READER_MEMORY` more than is used now; beyond that it gets a MemoryError.

    The limit is that of the whole process, so memory used by other threads counts.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = address_space() + READER_MEMORY
    # Keep a stricter limit that the user or the container has set
    bounds = [bound for bound in (soft, hard) if bound != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_AS, (min([limit, *bounds]), hard))
    try:
        yield
    finally:
        # Only the soft limit was changed, so it can be raised again
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def address_space() -> int:
    """Return the address space of this process. [bytes]"""
    # The first number of statm is the total program size in pages, proc(5)
    pages = int(Path('/proc/self/statm').read_text(encoding='ascii').split()[0])
    return pages * resource.getpagesize()
