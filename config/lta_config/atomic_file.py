# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Create and write files and folders atomically: a kill or a full disk leaves no partial one.

What is written lies beside its target, in a part that its writer locks. The system releases the
lock of a dead process, so what a killed command left is told from what another one writes.
"""

import atexit
from collections.abc import Iterator
from contextlib import contextmanager, ExitStack, suppress
import fcntl
from itertools import count
import os
from pathlib import Path
import shutil
from typing import Final

from lta_config.errors import BadInput

# Name of a staging folder, and how a file ends that is being written
PART_SUFFIX: Final = '.lta.part'
_reserved: dict[Path, bool] = {}  # new folders, and whether their parent was made for them


def reserve_folder(folder: Path) -> Path:
    """
    Create a folder that no other command has, and return it: `folder`, or one with -2, -3 ...

    Where it cannot be created, the path is returned, and the error is left to what writes there.
    """
    new = not folder.parent.exists()
    for number in count(1):
        own = folder if number == 1 else folder.with_name(f'{folder.name}-{number}')
        try:
            own.mkdir(parents=True)
        except FileExistsError:
            continue
        except OSError:
            return folder
        _reserved[own] = new
        return own
    raise AssertionError  # the numbers do not end


@atexit.register
def release_folders() -> None:
    """Remove the reserved folders to which nothing was written."""
    while _reserved:
        folder, new = _reserved.popitem()
        with suppress(OSError):  # it has results, as it should
            folder.rmdir()
            if new:
                folder.parent.rmdir()


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
    part = target.with_name(f'.{target.name}{PART_SUFFIX}')
    lock = os.open(part, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        with suppress(OSError):  # a file system without locks
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield part
        part.replace(target)
    finally:
        # After a success there is nothing left to remove
        with suppress(OSError):
            part.unlink(missing_ok=True)
        os.close(lock)


@contextmanager
def create_part_folder(folder: Path) -> Iterator[Path]:
    """
    Yield a new staging folder within a folder; remove it at the end.

    It is inside because the parent of the folder may not be writable. Raise `BadInput` if another
    command is writing to the folder, and OSError if it cannot be created.
    """
    part = folder / PART_SUFFIX
    remove_dead_parts(folder)
    part.mkdir()
    lock = os.open(part, os.O_RDONLY)
    try:
        with suppress(OSError):  # a file system without locks
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield part
    finally:
        shutil.rmtree(part, ignore_errors=True)
        os.close(lock)


def create_folder(folder: Path) -> None:
    """Create a results folder, unless it exists; raise `BadInput` if that fails."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput(
            f"'{folder}' cannot be created ({error.strerror}); choose another folder with --out."
        ) from error


@contextmanager
def stage_results(folder: Path, last: str) -> Iterator[Path]:
    """
    Yield a staging folder; its files move to the results folder when all are written.

    `folder`: the results folder; if it is new it is removed after a failure. `last`: file to move
    last; if it exists, so do the others.
    """
    # An existing empty folder belongs to the user and stays
    new = not folder.exists()
    create_folder(folder)
    try:
        with ExitStack() as stack:
            try:
                part = stack.enter_context(create_part_folder(folder))
            except OSError as error:
                raise BadInput(
                    f"'{folder}' cannot be written ({error.strerror}); choose another folder with "
                    '--out.'
                ) from error
            yield part
            for one in sorted(part.iterdir(), key=lambda one: one.name == last):
                one.rename(folder / one.name)
    finally:
        if new:
            with suppress(OSError):  # fails if the folder has results, as it should
                folder.rmdir()


def remove_dead_parts(folder: Path) -> None:
    """
    Remove what killed commands were writing to a folder.

    Raise `BadInput` if a living one is writing to it, and OSError if it cannot be read.
    """
    for part in folder.glob(f'.*{PART_SUFFIX[1:]}'):
        if not _is_dead(part):
            raise BadInput(
                f"Another command is writing to '{folder}'; wait until it has ended, or choose "
                f"another folder. (If none is, remove '{part}'.)"
            )
        with suppress(OSError):
            if part.is_dir():
                shutil.rmtree(part)
            else:
                part.unlink()


def _is_dead(part: Path) -> bool:
    """Return whether the process that was writing a part has ended."""
    try:
        lock = os.open(part, os.O_RDONLY)
    except OSError:
        return not part.exists()
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    finally:
        os.close(lock)
    return True
