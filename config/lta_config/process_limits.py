"""
Resource limits of this process.

Readers of third parties trust the sizes that a file declares, so their memory is limited. If a
command fails because of a limit that the user has set, the error is explained.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import errno
from pathlib import Path
import resource
from typing import Final

from lta_config.errors import to_one_line
from lta_config.limits import READER_MEMORY

FILES: Final = 256  # open files that suffice for any command
SPACE: Final = 4 << 30  # address space that suffices for any command [bytes]
FULL: Final = {errno.EMFILE, errno.ENFILE}
# Of a library that cannot be loaded or a thread that cannot start, which do not say why
VAGUE: Final = (ImportError, OSError, RuntimeError, SystemError)
LONGEST: Final = 160  # characters of the error that are repeated


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


def describe_shortage(error: BaseException) -> str | None:
    """Return a sentence with the remedy if an error is due to a limit of this process."""
    chain = list(iterate_causes(error))
    numbers = {each.errno for each in chain if isinstance(each, OSError)}
    files, space = (
        soft for soft, _ in map(resource.getrlimit, (resource.RLIMIT_NOFILE, resource.RLIMIT_AS))
    )
    vague = isinstance(error, VAGUE)
    why = to_one_line(f'{type(error).__name__}: {error}')[:LONGEST]
    if numbers & FULL or (vague and 0 <= files < FILES):
        return (
            f'The command failed with a limit of {files} open files ({why}); raise it with '
            f'`ulimit -n {FILES}`, in a new shell if that is refused.'
        )
    full = errno.ENOMEM in numbers or any(isinstance(each, MemoryError) for each in chain)
    if space != resource.RLIM_INFINITY and (full or (vague and space < SPACE)):
        return (
            f'The command failed with a limit of {space >> 20} MB of memory ({why}); raise it '
            f'with `ulimit -v {SPACE >> 10}`, in a new shell if that is refused.'
        )
    if full:
        return (
            f'The memory of this machine does not suffice ({why}); close other programs, or use '
            'less data.'
        )
    return None


def iterate_causes(error: BaseException) -> Iterator[BaseException]:
    """Yield an error and those that it was raised from or during."""
    cause: BaseException | None = error
    while cause is not None:
        yield cause
        cause = cause.__cause__ or cause.__context__
