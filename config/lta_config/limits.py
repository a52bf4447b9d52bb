# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Limits on untrusted input and on this process.

Files, recordings and shapes of unknown origin: each limit is far above what a real file needs, and
low enough for a machine with 4 GB. Beyond it a command ends with one sentence. docs/security.md
explains the limits.

Readers of third parties trust the sizes that a file declares, so their memory is limited. If a
command fails because of a limit that the user has set, the error is explained.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import errno
from pathlib import Path
import resource
from typing import Final

from lta_config.errors import BadInput, to_one_line

# YAML files
YAML_BYTES: Final = 1_000_000  # hand-written files are far smaller
YAML_DEPTH: Final = 50  # levels; thousands of them overflow the C stack of the YAML reader
YAML_DIGITS: Final = 400  # of a number; the largest double has 309
# Recordings
CHUNK_BYTES: Final = 1 << 27  # of a chunk or message, unpacked
NOTE_BYTES: Final = 1 << 24  # of a schema, channel or metadata record
MOST_CHANNELS: Final = 4000  # of a recording; the largest robots have hundreds
SUMMARY_BYTES: Final = 1 << 28  # of the directory at the end of a recording
GRID_POINTS: Final = (
    150_000  # points of a time grid, 25 min at 100 Hz; more if a recording has more
)
DEFINITION_BYTES: Final = 250_000  # of the text that defines a message type
ARRAY_PARTS: Final = 4096  # elements of its fixed arrays, which the reader unrolls into code
# Logs of others
LOG_BYTES: Final = 1 << 29  # of a log that is read whole: text, ULog, Crazyflie's card
LOG_WIDTH: Final = 5000  # of a log; an autopilot's export has hundreds
INFLATION: Final = 200  # bytes out of one byte of gzip or zstd; text with columns has up to 20
INFLATED_FREELY: Final = 1 << 26  # bytes after which the ratio is checked
READER_MEMORY: Final = 1 << 31  # bytes that a third-party reader may allocate
# Shapes
STL_BYTES: Final = 150_000_000  # text; a binary file of as many triangles has a fifth
STL_TRIANGLES: Final = 500_000


def check_column_count(path: Path, count: int) -> None:
    """Raise BadInput for a log with more columns than the limit."""
    if count > LOG_WIDTH:
        raise BadInput(
            f"'{path}' has {count} columns, and LTA reads up to {LOG_WIDTH}; save only those that "
            'you need.'
        )


def check_log_size(path: Path) -> None:
    """Raise BadInput for a log above the size limit."""
    if path.stat().st_size > LOG_BYTES:
        raise BadInput(
            f"'{path}' is larger than {LOG_BYTES} bytes, the limit of an import; split the log."
        )


ENOUGH_FILES: Final = 256  # open files that suffice for any command
ENOUGH_ADDRESS_SPACE: Final = 4 << 30  # address space that suffices for any command [bytes]
FULL_TABLES: Final = {errno.EMFILE, errno.ENFILE}
# Of a library that cannot be loaded or a thread that cannot start, which do not say why
VAGUE_ERRORS: Final = (ImportError, OSError, RuntimeError, SystemError)
REASON_LENGTH: Final = 160  # characters of the error that are repeated


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
    """Return the address space of this process [bytes]."""
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
    vague = isinstance(error, VAGUE_ERRORS)
    why = to_one_line(f'{type(error).__name__}: {error}')[:REASON_LENGTH]
    if numbers & FULL_TABLES or (vague and 0 <= files < ENOUGH_FILES):
        return (
            f'The command failed with a limit of {files} open files ({why}); raise it with '
            f'`ulimit -n {ENOUGH_FILES}`, in a new shell if that is refused.'
        )
    full = errno.ENOMEM in numbers or any(isinstance(each, MemoryError) for each in chain)
    if space != resource.RLIM_INFINITY and (full or (vague and space < ENOUGH_ADDRESS_SPACE)):
        return (
            f'The command failed with a limit of {space >> 20} MB of memory ({why}); raise it '
            f'with `ulimit -v {ENOUGH_ADDRESS_SPACE >> 10}`, in a new shell if that is refused.'
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
