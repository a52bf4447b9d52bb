"""
A resumable log of long work: one line of JSON per finished item.

The first line identifies the work, so that a killed command can continue. A line that the end of
its writer cut short is removed, and its item is done again.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
import fcntl
import json
from pathlib import Path
from typing import Any, final, Generic, NamedTuple, TypeVar

from lta_config.errors import BadInput

Piece = TypeVar('Piece')


class LogKind(NamedTuple):
    """A kind of log: file name, key of the first line, name in messages, option of its folder."""

    file: str
    key: str
    word: str
    option: str


@final
class LineLog(Generic[Piece]):
    """
    Open or create the log in a folder, locked against other processes until closed.

    Parameters
    ----------
    folder : Path
        Created if missing.
    identity : str
        Hash of the work.
    read : callable
        Converts the content of a line to an item; raises `KeyError` or `TypeError` if it is
        invalid.

    Attributes
    ----------
    pieces : list
        The logged items in order.

    Raises
    ------
    BadInput
        If the file belongs to other work or is not a log, another process writes to it, or it
        cannot be used.

    """

    def __init__(
        self, folder: Path, kind: LogKind, identity: str, read: Callable[[Any], Piece]
    ) -> None:
        self.pieces: list[Piece] = []
        self._kind, self._path, self._identity = kind, folder / kind.file, identity
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Append mode: every write goes to the end, wherever the file was read
            self._file = self._path.open('a+b')
        except OSError as error:
            raise self._build_access_error(error) from None
        try:
            self._lock()
            self._resume(read)
        except OSError as error:
            self.close()
            raise self._build_access_error(error) from None
        except BadInput:
            self.close()
            raise

    def _lock(self) -> None:
        try:
            # The kernel releases the lock when the process ends
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise BadInput(
                f"Another {self._kind.word} is writing to '{self._path.parent}'; wait until it "
                'ends.'
            ) from None

    def _resume(self, read: Callable[[Any], Piece]) -> None:
        """Read existing items, cut off an incomplete line, and write a missing first line."""
        self._file.seek(0)
        first, begin = self._file.readline(), _encode_line({self._kind.key: self._identity})
        if first != begin and begin.startswith(first):  # empty, or cut within the first line
            self._file.truncate(0)
            self._write_line(begin)
            return
        self._check_owner(first)
        whole = len(first)
        for line in self._file:
            try:
                # Only the last line can lack its newline
                content = json.loads(line) if line.endswith(b'\n') else None
            except ValueError:
                break
            if content is None:
                break
            try:
                self.pieces.append(read(content))
            # Valid JSON of another shape: not our log, so do not cut anything
            except (KeyError, TypeError):
                raise self._build_format_error() from None
            whole += len(line)
        self._file.truncate(whole)

    def _check_owner(self, first: bytes) -> None:
        """Reject a log of other work without changing it."""
        content = None
        with suppress(ValueError):
            content = json.loads(first)
        if not (isinstance(content, dict) and self._kind.key in content):
            raise self._build_format_error()
        if content[self._kind.key] != self._identity:
            raise BadInput(
                f"'{self._path}' is the log of a {self._kind.word} with other settings; choose "
                f'another folder with {self._kind.option}.'
            )

    def _build_format_error(self) -> BadInput:
        return BadInput(
            f"'{self._path}' is not the log of a {self._kind.word}; choose another folder with "
            f'{self._kind.option}.'
        )

    def _build_access_error(self, error: OSError) -> BadInput:
        return BadInput(
            f"'{self._path}' cannot be written ({error.strerror}); free disk space, or choose "
            f'another folder with {self._kind.option}.'
        )

    def append(self, content: Mapping[str, Any]) -> bytes:
        """Write an item, which then survives the end of this process; return its line."""
        line = _encode_line(content)
        self._write_line(line)
        return line

    def _write_line(self, line: bytes) -> None:
        try:
            self._file.write(line)
            self._file.flush()
        except OSError as error:
            raise BadInput(
                f"'{self._path}' cannot be written ({error.strerror}); free disk space and start "
                f'the {self._kind.word} again; it continues where it stopped.'
            ) from None

    def close(self) -> None:
        """Close the file and release its lock."""
        with suppress(OSError):
            self._file.close()


def _encode_line(content: Mapping[str, Any]) -> bytes:
    # NaN and infinity become constants, which Python and pandas read
    return json.dumps(content).encode() + b'\n'
