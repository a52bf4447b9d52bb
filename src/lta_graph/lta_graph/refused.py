"""What came from outside and could not be used: how often, and why the last time."""

from typing import Final, final

from lta_graph.health import Fact, Level

LONGEST: Final = 200  # characters of a reason: whoever sends nonsense decides how much of it


@final
class Refused:
    """
    A count of what was left out.

    Attributes
    ----------
    count : int
        How often.
    why : str
        Why, the last time; empty where nothing was.

    """

    def __init__(self) -> None:
        self.count = 0
        self.why = ''

    def add(self, why: str) -> None:
        """Count one that is left out."""
        self.count += 1
        self.why = why if len(why) <= LONGEST else f'{why[:LONGEST]} ...'

    def fact(self, task: str, fine: str) -> Fact:
        """Return how this stands, under the name of a task; a word for nothing was left out."""
        level = Level.WARN if self.count else Level.OK
        words = f'{self.count} left out, at last: {self.why}' if self.count else fine
        return Fact(task, level, words, {'left_out': str(self.count)})
