"""A bound around readers of others, which trust what a file says of its own size."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
import resource

from lta_config.limits import READER_MEMORY


@contextmanager
def limit_memory() -> Iterator[None]:
    """
    Let the inside take no more than `READER_MEMORY` beyond what is taken; then it is MemoryError.

    The bound is that of the whole process: what else needs memory meanwhile counts.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = address_space() + READER_MEMORY
    bounds = [bound for bound in (soft, hard) if bound != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_AS, (min([wanted, *bounds]), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def address_space() -> int:
    """Return the address space of this process. [bytes]"""
    pages = int(Path('/proc/self/statm').read_text(encoding='ascii').split()[0])
    return pages * resource.getpagesize()
