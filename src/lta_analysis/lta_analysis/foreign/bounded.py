"""Bounds around readers of others, which trust what a file says of its own size."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
import resource

from lta_config.errors import BadInput
from lta_config.limits import LOG_BYTES, READER_MEMORY


def refuse_large(path: Path) -> None:
    """Raise BadInput for a log that would be read whole and is too large for that."""
    if path.stat().st_size > LOG_BYTES:
        raise BadInput(f"'{path}' is larger than {LOG_BYTES} bytes; cut the log into parts.")


@contextmanager
def bounded_memory() -> Iterator[None]:
    """
    Let the inside take no more than `READER_MEMORY` beyond what is taken; then it is MemoryError.

    The bound is that of the whole process: what else needs memory meanwhile counts.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = taken() + READER_MEMORY
    bounds = [bound for bound in (soft, hard) if bound != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_AS, (min([wanted, *bounds]), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def taken() -> int:
    """Return the address space of this process. [bytes]"""
    pages = int(Path('/proc/self/statm').read_text(encoding='ascii').split()[0])
    return pages * resource.getpagesize()
