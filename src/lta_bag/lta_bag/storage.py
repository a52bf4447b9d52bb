# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Append records to a file that never ends in a partial record, even if the disk fails."""

from contextlib import suppress
import errno
import os
from pathlib import Path
import shutil
from typing import final

DISK_MARGIN = 4_000_000  # bytes left free on the disk beyond what closing needs


class StorageFault(OSError):
    """The disk is full, over its quota or broken; everything written before stays readable."""

    def __str__(self) -> str:
        """Return the message for the user."""
        return (
            f"Cannot write to '{self.filename}' ({self.strerror}). The recording ends here; what "
            'was '
            'recorded so far stays readable. Free disk space, or record to another folder.'
        )


def to_storage_fault(error: OSError, path: Path) -> StorageFault:
    """Convert an error of the operating system."""
    return StorageFault(error.errno, error.strerror, str(path))


def free_space(path: Path) -> int:
    """
    Return the space available to this user on the disk of `path` [bytes].

    Raises
    ------
    FolderGone
        If the path no longer exists.

    """
    try:
        return shutil.disk_usage(path).free
    except OSError as error:
        raise FolderGone(error.errno, error.strerror, str(path)) from error


@final
class FolderGone(StorageFault):
    """The folder was removed, or its disk was."""

    def __str__(self) -> str:
        """Return the message for the user."""
        return (
            f"The folder '{self.filename}' of the recording is no longer available "
            f'({self.strerror}); do not remove the folder or its disk during a flight.'
        )


@final
class DiskNearlyFull(StorageFault):
    """The bag must be closed now, while its index still fits on the disk."""

    def __str__(self) -> str:
        """Return the message for the user."""
        return (
            f"The recording has ended, because the disk is nearly full. The bag '{self.filename}' "
            'is '
            'complete up to this time; free disk space before the next flight.'
        )


def check_room(path: Path, needed: int) -> None:
    """
    Check that the disk of `path` has the needed bytes and `MARGIN` left.

    Raises
    ------
    DiskNearlyFull
        If it has less.

    """
    if free_space(path) < needed + DISK_MARGIN:
        raise DiskNearlyFull(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))


def fsync_file(path: Path) -> None:
    """Sync a closed file to the disk, so that it survives a power cut."""
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
    Append-only file, to which a flush adds everything or nothing.

    What was flushed survives the death of the process, but not a power cut before `close`.

    Raises
    ------
    StorageFault
        If the file exists already or cannot be created.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.size = 0  # without what waits for a flush [bytes]
        self._waiting = bytearray()
        try:
            # O_EXCL: never overwrite a recording
            self._fd = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise to_storage_fault(error, path) from error

    def write(self, data: bytes) -> int:
        """Add `data` to what the next flush appends, and return its size [bytes]."""
        self._waiting += data
        return len(data)

    def tell(self) -> int:
        """Return where the next `write` will be in the file [bytes]."""
        return self.size + len(self._waiting)

    def flush(self) -> None:
        """
        Append what was written since the last flush.

        Raises
        ------
        StorageFault
            If not all of it could be written; it is lost, and the file ends where it ended before.

        """
        data, self._waiting = self._waiting, bytearray()
        left, end = memoryview(data), self.size + len(data)
        try:
            # pwrite may write less than asked for, such as on a nearly full disk
            while left:
                left = left[os.pwrite(self._fd, left, end - len(left)) :]
            self.size = end
        except OSError as error:
            raise to_storage_fault(error, self.path) from error
        finally:
            if self.size != end:  # Ctrl-C can interrupt a write as a full disk does
                with suppress(OSError):  # If this fails, the next flush overwrites the torn record
                    os.ftruncate(self._fd, self.size)

    def drop(self) -> None:
        """Forget what was written since the last flush."""
        self._waiting.clear()

    def close(self) -> None:
        """Close the file, and wait until it survives a power cut."""
        try:
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
