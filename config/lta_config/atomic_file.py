"""Write files atomically, so that a kill or a full disk never leaves a partial one."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def replace_atomically(path: Path) -> Iterator[Path]:
    """
    Yield a temporary path to write to; it replaces `path` once the block has succeeded.

    A path that is not a regular file, such as /dev/stdout, is yielded itself. Callers must prevent
    two concurrent writers of one file.

    Raises
    ------
    OSError
        If it cannot be written; an earlier file remains.

    """
    if path.exists() and not path.is_file():
        yield path
        return
    target = path.resolve()  # replace the file that a link points to, not the link
    # In the same folder, because a rename is atomic only within one file system
    part = target.with_name(f'.{target.name}.part')
    try:
        yield part
        part.replace(target)
    finally:
        # After a success there is nothing left to remove
        with suppress(OSError):
            part.unlink(missing_ok=True)
