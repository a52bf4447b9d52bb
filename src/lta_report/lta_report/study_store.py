"""
Store the results of a study while it runs, so that it can resume.

It is a text file with a line for each item. The first line identifies the work, so that a killed
command can continue. A line that the end of its writer cut short is removed, and its item is done
again.
"""

from collections.abc import Callable, Hashable, Mapping
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass
import fcntl
import json
from pathlib import Path
from typing import Any, final, Generic, NamedTuple, TypeVar

from lta_config.errors import BadInput
from lta_report.workers import ItemFailure
from pydantic import TypeAdapter, ValidationError

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


Result = TypeVar('Result')
FAILED, KEY, RESULT = 'failed', 'key', 'result'  # keys of a line


@final
@dataclass(frozen=True, slots=True)
class StoreFormat(Generic[Result]):
    """How the results of a kind of study are stored."""

    kind: LogKind  # file name and words for messages
    # Converts a result to JSON and back; NaN and infinity become the constants that Python, pandas
    # and JSON5 read
    adapter: TypeAdapter[Result]
    # Returns the key of a result that identifies its item. By default a line has the form {"key":
    # ..., "result": ...} with text as key.
    find_key: Callable[[Result], Hashable] | None = None
    # Returns whether a result is that of a failed item, for results that can express it
    is_failed: Callable[[Result], bool] | None = None
    shares_folder: bool = False  # whether the folder may contain other files

    def to_line(self, key: Hashable, outcome: Result | ItemFailure) -> Mapping[str, Any]:
        """Return the content of a line."""
        if isinstance(outcome, ItemFailure):
            return {KEY: key, FAILED: outcome.reason}
        # Python mode, because JSON mode replaces NaN by null in some places
        content = self.adapter.dump_python(outcome)
        return content if self.find_key is not None else {KEY: key, RESULT: content}

    def from_line(self, content: Mapping[str, Any]) -> tuple[Hashable, Result | ItemFailure]:
        """
        Return the key and the outcome of a line.

        Raises
        ------
        KeyError or TypeError
            If the line is invalid.

        """
        if content.keys() == {KEY, FAILED}:
            key = content[KEY]
            # JSON has no tuples
            return tuple(key) if isinstance(key, list) else key, ItemFailure(content[FAILED])
        try:
            result = self.adapter.validate_python(
                content if self.find_key is not None else content[RESULT]
            )
        except ValidationError as error:
            raise TypeError(str(error)) from None
        return (content[KEY] if self.find_key is None else self.find_key(result)), result


@final
class StudyStore(AbstractContextManager['StudyStore[Any]', None], Generic[Result]):
    """
    Open or create the store in a folder; use it as a context manager.

    Parameters
    ----------
    folder : Path
        Results folder; created if missing.
    form : StoreFormat
        How results are stored.
    identity : str
        Hash of everything that determines the results of the study, except what the keys tell.
    retry_failed : bool
        Whether to forget failed items, so that they are repeated.

    Attributes
    ----------
    results : dict
        Results by key; a later line of the file replaces an earlier one.
    failures : dict
        Failed items by key.

    Raises
    ------
    BadInput
        If the folder has other contents, or another process writes to it.

    """

    def __init__(
        self,
        folder: Path,
        form: StoreFormat[Result],
        identity: str,
        retry_failed: bool = False,
    ) -> None:
        if not form.shares_folder:
            refuse_foreign_folder(folder, form.kind.file, form.kind.word)
        self._form = form
        self._log = LineLog(folder, form.kind, identity, form.from_line)
        self.results: dict[Any, Result] = {}
        self.failures: dict[Any, ItemFailure] = {}
        for key, outcome in self._log.pieces:
            self._remember(key, outcome)
        if retry_failed:
            # They stay in the file, where later lines replace them
            self.failures.clear()
            if form.is_failed is not None:
                is_failed = form.is_failed
                self.results = {k: one for k, one in self.results.items() if not is_failed(one)}

    def __contains__(self, key: Hashable) -> bool:
        """Return whether an item has a result or has failed."""
        return key in self.results or key in self.failures

    def add(self, key: Hashable, outcome: Result | ItemFailure) -> None:
        """Store an outcome, which then survives the end of this process."""
        line = self._log.append(self._form.to_line(key, outcome))
        if self._form.find_key is None:
            # As if it were loaded, so that a resumed study returns exactly the same. Large sweeps,
            # whose rows consist of plain JSON data, save this time
            key, outcome = self._form.from_line(json.loads(line))
        self._remember(key, outcome)

    def _remember(self, key: Hashable, outcome: Result | ItemFailure) -> None:
        if isinstance(outcome, ItemFailure):
            self.failures[key] = outcome
            self.results.pop(key, None)
        else:
            self.results[key] = outcome
            self.failures.pop(key, None)

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self._log.close()


def refuse_foreign_folder(folder: Path, own: str, word: str) -> None:
    """Raise `BadInput` for a folder that has contents, but not the entry of a kind of study."""
    try:
        foreign = folder.is_dir() and not (folder / own).exists() and any(folder.iterdir())
    except OSError:
        return  # opening the log reports the reason
    if foreign:
        raise BadInput(
            f"'{folder}' contains files that do not belong to a {word}; choose another folder."
        )
