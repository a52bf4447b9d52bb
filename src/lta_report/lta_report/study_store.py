# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
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
from typing import Any, final, Generic, TypeVar

from lta_config.errors import BadInput
from lta_report.workers import ItemFailure
from pydantic import TypeAdapter, ValidationError

Result = TypeVar('Result')
FAILED_KEY, ITEM_KEY, RESULT_KEY = 'failed', 'key', 'result'  # keys of a line


@final
@dataclass(frozen=True, slots=True)
class StoreFormat(Generic[Result]):
    """How the results of a kind of study are stored."""

    file: str
    key: str  # of the first line
    word: str  # what the study is, in messages
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
            return {ITEM_KEY: key, FAILED_KEY: outcome.reason}
        # Python mode, because JSON mode replaces NaN by null in some places
        content = self.adapter.dump_python(outcome)
        return content if self.find_key is not None else {ITEM_KEY: key, RESULT_KEY: content}

    def from_line(self, content: Mapping[str, Any]) -> tuple[Hashable, Result | ItemFailure]:
        """Return the key and the outcome of a line; raise `BadInput` if it is invalid."""
        try:
            if content.keys() == {ITEM_KEY, FAILED_KEY}:
                key = content[ITEM_KEY]
                # JSON has no tuples
                return tuple(key) if isinstance(key, list) else key, ItemFailure(
                    content[FAILED_KEY]
                )
            result = self.adapter.validate_python(
                content if self.find_key is not None else content[RESULT_KEY]
            )
        except (AttributeError, KeyError, TypeError, ValidationError):
            raise BadInput('The line is of another form.') from None
        return (content[ITEM_KEY] if self.find_key is None else self.find_key(result)), result


@final
class StudyStore(AbstractContextManager['StudyStore[Any]', None], Generic[Result]):
    """
    Open or create the store in a folder, locked against other processes; a context manager.

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
        If the folder has other contents, another process writes to it, or it cannot be used.

    """

    def __init__(
        self,
        folder: Path,
        form: StoreFormat[Result],
        identity: str,
        retry_failed: bool = False,
    ) -> None:
        if not form.shares_folder:
            refuse_foreign_folder(folder, form.file, form.word)
        self._form, self._path = form, folder / form.file
        self.results: dict[Any, Result] = {}
        self.failures: dict[Any, ItemFailure] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Append mode: every write goes to the end, wherever the file was read
            self._file = self._path.open('a+b')
        except OSError as error:
            raise self._build_access_error(error) from None
        try:
            self._lock()
            self._resume(_encode_line({form.key: identity}))
        except OSError as error:
            self.__exit__()
            raise self._build_access_error(error) from None
        except BadInput:
            self.__exit__()
            raise
        if retry_failed:
            # They stay in the file, where later lines replace them
            self.failures.clear()
            if form.is_failed is not None:
                is_failed = form.is_failed
                self.results = {k: one for k, one in self.results.items() if not is_failed(one)}

    def _lock(self) -> None:
        try:
            # The kernel releases the lock when the process ends
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise BadInput(
                f"Another {self._form.word} is writing to '{self._path.parent}'; wait until it "
                'ends.'
            ) from None

    def _resume(self, begin: bytes) -> None:
        """Read existing items, cut off an incomplete line, and write a missing first line."""
        self._file.seek(0)
        first = self._file.readline()
        if first != begin and begin.startswith(first):  # empty, or cut within the first line
            self._file.truncate(0)
            self._write_line(begin)
            return
        self._check_owner(first, begin)
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
                self._remember(*self._form.from_line(content))
            # Valid JSON of another shape: not our store, so do not cut anything
            except BadInput:
                raise self._build_format_error() from None
            whole += len(line)
        self._file.truncate(whole)

    def _check_owner(self, first: bytes, begin: bytes) -> None:
        """Reject a store of other work without changing it."""
        content = None
        with suppress(ValueError):
            content = json.loads(first)
        if not (isinstance(content, dict) and self._form.key in content):
            raise self._build_format_error()
        if first != begin:
            raise BadInput(
                f"'{self._path}' is the log of a {self._form.word} with other settings; choose "
                'another folder with --out.'
            )

    def _build_format_error(self) -> BadInput:
        return BadInput(
            f"'{self._path}' is not the log of a {self._form.word}; choose another folder with "
            '--out.'
        )

    def _build_access_error(self, error: OSError) -> BadInput:
        return BadInput(
            f"'{self._path}' cannot be written ({error.strerror}); free disk space, or choose "
            'another folder with --out.'
        )

    def _write_line(self, line: bytes) -> None:
        try:
            self._file.write(line)
            self._file.flush()
        except OSError as error:
            raise BadInput(
                f"'{self._path}' cannot be written ({error.strerror}); free disk space and start "
                f'the {self._form.word} again; it continues where it stopped.'
            ) from None

    def __contains__(self, key: Hashable) -> bool:
        """Return whether an item has a result or has failed."""
        return key in self.results or key in self.failures

    def add(self, key: Hashable, outcome: Result | ItemFailure) -> None:
        """Store an outcome, which then survives the end of this process."""
        line = _encode_line(self._form.to_line(key, outcome))
        self._write_line(line)
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
        """Close the file and release its lock."""
        with suppress(OSError):
            self._file.close()


def _encode_line(content: Mapping[str, Any]) -> bytes:
    # NaN and infinity become constants, which Python and pandas read
    return json.dumps(content).encode() + b'\n'


def refuse_foreign_folder(folder: Path, own: str, word: str) -> None:
    """Raise `BadInput` for a folder that has contents, but not the entry of a kind of study."""
    try:
        foreign = folder.is_dir() and not (folder / own).exists() and any(folder.iterdir())
    except OSError:
        return  # opening the store reports the reason
    if foreign:
        raise BadInput(
            f"'{folder}' contains files that do not belong to a {word}; choose another folder."
        )
