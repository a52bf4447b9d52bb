"""The log of a sweep: one line per finished flight, so that a killed sweep can resume."""

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
    Open or create the log in a folder; use it as a context manager.

    Parameters
    ----------
    folder : Path
        Results folder; created if missing.
    identity : str
        Hash of the sweep.
    retry : bool
        Whether to fly failed flights again.

    Attributes
    ----------
    rows : dict
        Finished flights by index.

    Raises
    ------
    BadInput
        If the folder has other contents, or another process writes to it.

    """

    def __init__(self, folder: Path, identity: str, retry: bool = False) -> None:
        if _is_foreign(folder):
            raise BadInput(
                f"'{folder}' contains files that do not belong to a sweep; choose another folder."
            )
        self._lines = LineLog(folder, KIND, identity, _parse_row)
        self.rows = {row.index: row for row in self._lines.pieces}
        # The failed rows stay in the file; a later line for the same flight replaces them
        if retry:
            self.rows = {k: row for k, row in self.rows.items() if row.outcome != FAILED}

    def add(self, row: SweepRow) -> None:
        """Log a row, which then survives the end of this process."""
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
    """Return whether a folder has contents but no log."""
    try:
        return folder.is_dir() and not (folder / KIND.file).exists() and any(folder.iterdir())
    except OSError:
        return False  # opening the log reports the reason


def _parse_row(content: dict[str, Any]) -> SweepRow:
    return SweepRow(**content)
