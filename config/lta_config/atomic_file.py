"""Files that are whole or not there: what a kill or a full disk cuts short replaces nothing."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def replace_atomically(path: Path) -> Iterator[Path]:
    """
    Yield where to write a file; it takes its place, and that of an earlier one, when all is there.

    What is no file, as /dev/stdout, is written to as it is. Two writers of one file at a time are
    for the caller to keep apart.

    Raises
    ------
    OSError
        If it cannot be written; an earlier one stays.

    """
    if path.exists() and not path.is_file():
        yield path
        return
    target = path.resolve()  # a link stays one
    part = target.with_name(f'.{target.name}.part')
    try:
        yield part
        part.replace(target)
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
