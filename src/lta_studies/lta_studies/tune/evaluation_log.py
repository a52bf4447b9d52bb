"""
Log the evaluations of a gain search, so that an interrupted search can resume.

The same seed draws the same candidates, so the costs in their order are enough to resume.
"""

from contextlib import AbstractContextManager
import hashlib
import json
from pathlib import Path
from typing import Any, final, NamedTuple

from lta_report.line_log import LineLog, LogKind

KIND = LogKind('search.jsonl', 'tune', 'search', '--out')


class CandidateCosts(NamedTuple):
    """The parameter values of one candidate and its cost in each case."""

    numbers: list[float]
    costs: list[float]


def hash_search(content: Any) -> str:  # noqa: ANN401 - what JSON holds
    """Return a hash that identifies a search by its inputs."""
    # Sorted keys: the hash must not depend on the order in which the inputs were built.
    text = json.dumps(content, sort_keys=True)
    # 64 bits are enough to tell the searches of one folder apart.
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@final
class EvaluationLog(AbstractContextManager['EvaluationLog', None]):
    """
    The costs of a search; use it as a context manager.

    Parameters
    ----------
    folder : Path
        Created if missing.
    name : str
        Hash of the search, from `hash_search`.

    Raises
    ------
    BadInput
        If the folder holds another search, another process writes to it, or it cannot be written.

    """

    def __init__(self, folder: Path, name: str) -> None:
        self._lines = LineLog(folder, KIND, name, _parse_entry)
        self._entries = self._lines.pieces

    def find_costs(self, place: int, numbers: list[float]) -> list[float] | None:
        """Return the costs by case of the candidate at an index; None if it was not flown."""
        # Exact comparison of floats is right: JSON restores them exactly, and the seed fixes them.
        if place >= len(self._entries) or self._entries[place].numbers != numbers:
            return None
        return self._entries[place].costs

    def add(self, numbers: list[float], costs: list[float]) -> None:
        """Append the costs of a candidate and write them to disk."""
        entry = CandidateCosts(numbers, costs)
        self._entries.append(entry)
        self._lines.append(entry._asdict())

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self._lines.close()


def _parse_entry(content: dict[str, Any]) -> CandidateCosts:
    return CandidateCosts(**content)
