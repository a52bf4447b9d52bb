"""
What a search has flown so far, kept line by line, so that a stopped one goes on where it was.

The search draws the same candidates from the same seed, so that costs in their order are all it
needs.
"""

from contextlib import AbstractContextManager
import hashlib
import json
from pathlib import Path
from typing import Any, final, NamedTuple

from lta_report.line_log import LineLog, LogKind

KIND = LogKind('search.jsonl', 'tune', 'search', '--folder')


class CandidateCosts(NamedTuple):
    """One candidate: its numbers, and its costs by case."""

    numbers: list[float]
    costs: list[float]


def hash_search(content: Any) -> str:  # noqa: ANN401 - what JSON holds
    """Return a name for what a search is about."""
    text = json.dumps(content, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@final
class EvaluationLog(AbstractContextManager['EvaluationLog', None]):
    """
    The costs of a search; use it as a context manager.

    Parameters
    ----------
    folder : Path
        Where it is kept; made if missing.
    name : str
        Of the search, by `hash_search`.

    Raises
    ------
    BadInput
        If the folder holds another search, another process writes to it, or it cannot be written.

    """

    def __init__(self, folder: Path, name: str) -> None:
        self._lines = LineLog(folder, KIND, name, _parse_entry)
        self._entries = self._lines.pieces

    def find_costs(self, place: int, numbers: list[float]) -> list[float] | None:
        """Return the costs of the candidate at a place, by case; None if it was not flown."""
        if place >= len(self._entries) or self._entries[place].numbers != numbers:
            return None
        return self._entries[place].costs

    def add(self, numbers: list[float], costs: list[float]) -> None:
        """Keep the costs of one more candidate; they outlive this process from now on."""
        entry = CandidateCosts(numbers, costs)
        self._entries.append(entry)
        self._lines.append(entry._asdict())

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self._lines.close()


def _parse_entry(content: dict[str, Any]) -> CandidateCosts:
    return CandidateCosts(**content)
