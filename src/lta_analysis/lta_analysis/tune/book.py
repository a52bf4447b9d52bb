"""
What a search has flown so far, kept line by line, so that a stopped one goes on where it was.

The search draws the same candidates from the same seed, so that costs in their order are all it
needs.
"""

from contextlib import suppress
import hashlib
import json
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput

NAME = 'search.jsonl'


def identity(content: Any) -> str:  # noqa: ANN401 - what JSON holds
    """Return a name for what a search is about."""
    text = json.dumps(content, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@final
class Book:
    """
    The costs of a search.

    Parameters
    ----------
    folder : Path
        Where it is kept; made if missing.
    name : str
        Of the search, by `identity`.

    Raises
    ------
    BadInput
        If the folder holds another search, or cannot be written.

    """

    def __init__(self, folder: Path, name: str) -> None:
        self._path = folder / NAME
        self._costs: list[tuple[list[float], list[float]]] = []
        try:
            folder.mkdir(parents=True, exist_ok=True)
            text = self._path.read_text(encoding='utf-8') if self._path.is_file() else ''
        except OSError as error:
            raise BadInput(
                f"'{folder}' cannot be used ({error.strerror}); choose another --folder."
            ) from None
        # A line that a kill tore off has no end; what is behind it was never kept.
        lines = [line for line in text.splitlines(keepends=True) if line.endswith('\n')]
        if lines and json.loads(lines[0]).get('tune') != name:
            raise BadInput(f"'{self._path}' is of another search; choose another --folder.")
        for line in lines[1:]:
            with suppress(ValueError, KeyError):
                content = json.loads(line)
                self._costs.append((content['numbers'], content['costs']))
        begin = lines or [json.dumps({'tune': name}) + '\n']
        try:
            self._path.write_text(''.join(begin), encoding='utf-8')
        except OSError as error:
            raise BadInput(
                f"'{self._path}' cannot be written ({error.strerror}); make room or choose "
                'another --folder.'
            ) from None

    def known(self, place: int, numbers: list[float]) -> list[float] | None:
        """Return the costs of the candidate at a place, by case; None if it was not flown."""
        if place >= len(self._costs) or self._costs[place][0] != numbers:
            return None
        return self._costs[place][1]

    def add(self, numbers: list[float], costs: list[float]) -> None:
        """Keep the costs of one more candidate."""
        self._costs.append((numbers, costs))
        line = json.dumps({'numbers': numbers, 'costs': costs}, allow_nan=False)
        with self._path.open('a', encoding='utf-8') as file:
            file.write(line + '\n')

    def __len__(self) -> int:
        """Return how many candidates have been flown."""
        return len(self._costs)
