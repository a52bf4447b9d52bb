# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find out what this machine offers: processor cores, and a folder for a cache."""

from collections.abc import Iterator
from contextlib import suppress
import os
from pathlib import Path
import stat
import tempfile


def count_cores() -> int:
    """Return the number of processor cores that this process may use."""
    # Respects the limits of containers and taskset, unlike os.cpu_count
    return len(os.sched_getaffinity(0))


def find_cache_folder(name: str) -> Path:
    """
    Return the cache folder of a kind of files, created if missing.

    By the XDG base directory specification: $XDG_CACHE_HOME/lta, by default ~/.cache/lta. If
    neither is writable (no home, or a read-only one): a folder of this user among the temporary
    files.
    """
    for base in list_cache_bases():
        folder = base / 'lta' / name
        if is_writable(folder):
            return folder
    return make_temporary_cache() / name


def list_cache_bases() -> Iterator[Path]:
    """Yield the folders in which a user's caches may be, the preferred one first."""
    if chosen := os.environ.get('XDG_CACHE_HOME'):
        yield Path(chosen)
        return
    try:
        yield Path.home() / '.cache'
    except RuntimeError:
        # No HOME, and no entry in the password database
        return


def is_writable(folder: Path) -> bool:
    """Return whether files can be created in a folder, creating it if missing."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def make_temporary_cache() -> Path:
    """Return this user's folder among the temporary files; it lasts until they are removed."""
    folder = Path(tempfile.gettempdir()) / f'lta-cache-{os.getuid()}'
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    status = folder.lstat()
    # Compiled code is loaded from there: nobody else may be able to write it
    private = status.st_uid == os.getuid() and not status.st_mode & 0o022
    if stat.S_ISDIR(status.st_mode) and private:
        return folder
    return Path(tempfile.mkdtemp(prefix='lta-cache-'))
