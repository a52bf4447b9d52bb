"""
A log of long work: a line of JSON for each piece of it, written as it ends.

What was killed goes on where it was: the first line says of what work the log is, and a line that
was cut short by the end of its writer is cut off, so that its piece is done again.
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
    """A kind of log: its file, the key of its first line, its word, the option of its folder."""

    file: str
    key: str
    word: str
    option: str


@final
class LineLog(Generic[Piece]):
    """
    Open the log in a folder, or begin it; nobody else writes to it until it is closed.

    Parameters
    ----------
    folder : Path
        Made if missing.
    kind : Kind
        Of the log.
    identity : str
        Hash of the work.
    read : callable
        Returns a piece from what its line holds; `KeyError` or `TypeError` where it is none.

    Attributes
    ----------
    pieces : list
        What has been kept, in its order.

    Raises
    ------
    BadInput
        If the file is of other work or no log, another process writes to it, or it cannot be used.

    """

    def __init__(
        self, folder: Path, kind: LogKind, identity: str, read: Callable[[Any], Piece]
    ) -> None:
        self.pieces: list[Piece] = []
        self._kind, self._path, self._identity = kind, folder / kind.file, identity
        try:
            folder.mkdir(parents=True, exist_ok=True)
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
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise BadInput(
                f"Another {self._kind.word} writes to '{self._path.parent}'; wait for its end."
            ) from None

    def _resume(self, read: Callable[[Any], Piece]) -> None:
        """Take up what is there, cut a torn line off, and name the work if nobody has."""
        self._file.seek(0)
        first, begin = self._file.readline(), _encode_line({self._kind.key: self._identity})
        if first != begin and begin.startswith(first):  # nothing, or torn off at once
            self._file.truncate(0)
            self._write_line(begin)
            return
        self._check_owner(first)
        whole = len(first)
        for line in self._file:
            try:
                content = json.loads(line) if line.endswith(b'\n') else None
            except ValueError:
                break
            if content is None:
                break
            try:
                self.pieces.append(read(content))
            except (KeyError, TypeError):
                raise self._build_format_error() from None
            whole += len(line)
        self._file.truncate(whole)

    def _check_owner(self, first: bytes) -> None:
        """Refuse a log of something else, of which not a byte is changed."""
        content = None
        with suppress(ValueError):
            content = json.loads(first)
        if not (isinstance(content, dict) and self._kind.key in content):
            raise self._build_format_error()
        if content[self._kind.key] != self._identity:
            raise BadInput(
                f"'{self._path}' is of another {self._kind.word}; choose another "
                f'{self._kind.option}.'
            )

    def _build_format_error(self) -> BadInput:
        return BadInput(
            f"'{self._path}' is no log of a {self._kind.word}; choose another {self._kind.option}."
        )

    def _build_access_error(self, error: OSError) -> BadInput:
        return BadInput(
            f"'{self._path}' cannot be written ({error.strerror}); make room or choose another "
            f'{self._kind.option}.'
        )

    def append(self, content: Mapping[str, Any]) -> None:
        """Keep a piece; it outlives this process from now on."""
        self._write_line(_encode_line(content))

    def _write_line(self, line: bytes) -> None:
        try:
            self._file.write(line)
            self._file.flush()
        except OSError as error:
            raise BadInput(
                f'The results cannot be written ({error.strerror}); make room and start the '
                f'{self._kind.word} again, it goes on where it stopped.'
            ) from None

    def close(self) -> None:
        """Leave the log to others."""
        with suppress(OSError):
            self._file.close()


def _encode_line(content: Mapping[str, Any]) -> bytes:
    return json.dumps(content, allow_nan=False).encode() + b'\n'
