"""Store the results of a study while it runs, so that it can resume."""

from collections.abc import Callable, Hashable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
import json
from pathlib import Path
from typing import Any, final, Generic, TypeVar

from lta_config.errors import BadInput
from lta_report.line_log import LineLog, LogKind
from lta_report.workers import ItemFailure
from pydantic import TypeAdapter, ValidationError

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
