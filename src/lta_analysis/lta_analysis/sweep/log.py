"""
The log of a sweep: one line a flight, written as it ends, so that a killed sweep goes on.

The first line names the sweep by its hash. A line that was cut short by the end of its writer is
left out and flown again.
"""

from contextlib import suppress
import fcntl
import json
from pathlib import Path
from types import TracebackType
from typing import final, Self

from lta_analysis.sweep.flown import FAILED, Row
from lta_config.errors import BadInput

NAME = 'flights.jsonl'


@final
class Log:
    """
    Open the log in a folder, or begin it; use it as a context manager.

    Parameters
    ----------
    folder : Path
        Of the sweep's results; made if missing.
    identity : str
        Hash of the sweep.
    retry : bool
        Whether flights that failed count as not flown.

    Attributes
    ----------
    rows : dict
        What has been flown, by index.

    Raises
    ------
    BadInput
        If the folder holds something else, or another process writes to it.

    """

    def __init__(self, folder: Path, identity: str, retry: bool = False) -> None:
        self.rows: dict[int, Row] = {}
        path = folder / NAME
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if not path.exists() and any(folder.iterdir()):
                raise BadInput(f"'{folder}' holds something else; choose another folder.")
            self._file = path.open('a+b')
        except OSError as error:
            raise BadInput(
                f"'{folder}' cannot be written ({error.strerror}); choose another folder."
            ) from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise BadInput(f"Another sweep writes to '{folder}'; wait for its end.") from None
        self._read(identity, path)
        if retry:
            self.rows = {k: row for k, row in self.rows.items() if row.outcome != FAILED}

    def _read(self, identity: str, path: Path) -> None:
        """Take up what is there, cut a torn line off, and name the sweep if nobody has."""
        self._file.seek(0)
        whole = 0
        found = None
        for line in self._file:
            content = None
            with suppress(ValueError):
                content = json.loads(line) if line.endswith(b'\n') else None
            if content is None:
                break
            whole += len(line)
            if found is None:
                found = content.get('sweep')
                if found != identity:
                    self._file.close()
                    raise BadInput(f"'{path}' is of another sweep; choose another --out.")
                continue
            row = Row(**content)
            self.rows[row.index] = row
        self._file.truncate(whole)
        if found is None:
            self._append({'sweep': identity})

    def add(self, row: Row) -> None:
        """Keep a row; it outlives this process from now on."""
        self.rows[row.index] = row
        self._append(row.to_dict())

    def _append(self, content: dict[str, object]) -> None:
        try:
            self._file.write(json.dumps(content, allow_nan=False).encode() + b'\n')
            self._file.flush()
        except OSError as error:
            raise BadInput(
                f'The results cannot be written ({error.strerror}); make room and start the sweep '
                'again, it goes on where it stopped.'
            ) from None

    @property
    def ordered(self) -> list[Row]:
        """All rows by index."""
        return [self.rows[index] for index in sorted(self.rows)]

    def __enter__(self) -> Self:
        """Return the log."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close it."""
        with suppress(OSError):
            self._file.close()
