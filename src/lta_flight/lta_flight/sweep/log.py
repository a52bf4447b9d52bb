"""The log of a sweep: one line a flight, written as it ends, so that a killed sweep goes on."""

from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput
from lta_flight.sweep.job_runner import FAILED, SweepRow
from lta_report.line_log import LineLog, LogKind

KIND = LogKind('flights.jsonl', 'sweep', 'sweep', '--out')


@final
class SweepLog(AbstractContextManager['SweepLog', None]):
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
        if _is_foreign(folder):
            raise BadInput(f"'{folder}' holds something else; choose another folder.")
        self._lines = LineLog(folder, KIND, identity, _parse_row)
        self.rows = {row.index: row for row in self._lines.pieces}
        if retry:
            self.rows = {k: row for k, row in self.rows.items() if row.outcome != FAILED}

    def add(self, row: SweepRow) -> None:
        """Keep a row; it outlives this process from now on."""
        self.rows[row.index] = row
        self._lines.append(row.to_dict())

    @property
    def sorted_rows(self) -> list[SweepRow]:
        """All rows by index."""
        return [self.rows[index] for index in sorted(self.rows)]

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self._lines.close()


def _is_foreign(folder: Path) -> bool:
    """Tell whether a folder holds something, and no log."""
    try:
        return folder.is_dir() and not (folder / KIND.file).exists() and any(folder.iterdir())
    except OSError:
        return False  # the log says why it cannot be used


def _parse_row(content: dict[str, Any]) -> SweepRow:
    return SweepRow(**content)
