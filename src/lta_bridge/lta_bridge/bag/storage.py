"""A file that ends on a whole record even when the disk does not play along."""

from contextlib import suppress
import errno
import os
from pathlib import Path
import shutil
from typing import final

MARGIN = 4_000_000  # bytes left free on the disk beyond what closing needs


class StorageFault(OSError):
    """The disk took no more: full, over a quota, or broken. What was written before stays."""

    def __str__(self) -> str:
        """Return the sentence for the user."""
        return (
            f"The disk took no more of '{self.filename}' ({self.strerror}); the recording ends "
            'here and stays readable, make room before the next one.'
        )


def to_storage_fault(error: OSError, path: Path) -> StorageFault:
    """Return the error to raise in place of the system's own."""
    return StorageFault(error.errno, error.strerror, str(path))


def free_space(path: Path) -> int:
    """
    Return the space left to us on the disk that holds `path`. [bytes]

    Raises
    ------
    FolderGone
        If it is not there any more.

    """
    try:
        return shutil.disk_usage(path).free
    except OSError as error:
        raise FolderGone(error.errno, error.strerror, str(path)) from error


@final
class FolderGone(StorageFault):
    """Somebody has removed the folder, or the disk that it was on."""

    def __str__(self) -> str:
        """Return the sentence for the user."""
        return (
            f"The folder '{self.filename}' cannot be reached any more ({self.strerror}), nor what "
            'was recorded in it; leave it alone during a flight.'
        )


@final
class DiskNearlyFull(StorageFault):
    """So little room is left that a bag must be closed while its index still fits."""

    def __str__(self) -> str:
        """Return the sentence for the user."""
        return (
            f"The disk is nearly full, so the bag '{self.filename}' ends here, whole; make room "
            'before the next flight.'
        )


def check_room(path: Path, needed: int) -> None:
    """
    Refuse to go on when the disk has little more room than closing needs.

    Parameters
    ----------
    path : Path
        A folder on the disk.
    needed : int
        What closing needs. [bytes]

    Raises
    ------
    NearlyFull
        If less than that and `MARGIN` is left.

    """
    if free_space(path) < needed + MARGIN:
        raise DiskNearlyFull(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))


def sync_file(path: Path) -> None:
    """Make a file that has been closed safe from a power cut."""
    try:
        fd = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
        try:
            os.fsync(fd)
        finally:
            os.close(fd)
    except OSError as error:
        raise to_storage_fault(error, path) from error


@final
class RecordFile:
    """
    Append-only file; each append is whole or leaves no trace.

    Writes go straight to the operating system: what `append` returned from survives the
    process, though not a power cut before `close`.

    Parameters
    ----------
    path : Path
        File to create; it must not exist.

    Raises
    ------
    StorageFault
        If it cannot be created.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.size = 0
        try:
            self._fd = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise to_storage_fault(error, path) from error

    def append(self, data: bytes) -> int:
        """
        Write `data` at the end and return the offset where it starts. [bytes]

        Raises
        ------
        StorageFault
            If not all of it could be written; the file ends where it ended before.

        """
        start = self.size
        left = memoryview(data)
        try:
            while left:
                left = left[os.pwrite(self._fd, left, start + len(data) - len(left)) :]
            self.size = start + len(data)
        except OSError as error:
            raise to_storage_fault(error, self.path) from error
        finally:
            if self.size == start:  # Ctrl-C tears a record as a full disk does.
                self._truncate_torn_record()
        return start

    def _truncate_torn_record(self) -> None:
        """End the file on its last whole record."""
        with suppress(OSError):  # Where even that fails, the next append overwrites the rest.
            os.ftruncate(self._fd, self.size)

    def close(self, *, sync: bool = True) -> None:
        """Close the file; where `sync`, only once it is safe from a power cut."""
        try:
            if sync:
                os.fsync(self._fd)
        except OSError as error:
            raise to_storage_fault(error, self.path) from error
        finally:
            os.close(self._fd)

    def discard(self) -> None:
        """Close the file and remove it; the disk may be broken already."""
        with suppress(OSError):
            os.close(self._fd)
        with suppress(OSError):
            self.path.unlink()
