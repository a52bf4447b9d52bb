"""What came from outside and cannot be meant: how often, and why the last time."""

from typing import Final, final

from lta_graph.health import HealthFact, HealthLevel

LONGEST: Final = 200  # characters of a reason, whose length the faulty sender controls


@final
class RejectionCount:
    """
    A count of what cannot be meant.

    Attributes
    ----------
    count : int
        How often it came.
    why : str
        What was wrong, the last time; empty where nothing was.

    """

    def __init__(self) -> None:
        self.count = 0
        self.why = ''

    def add(self, why: str) -> None:
        """Count one."""
        self.count += 1
        self.why = why if len(why) <= LONGEST else f'{why[:LONGEST]} ...'

    def build_fact(self, task: str, fine: str = 'all can be meant') -> HealthFact:
        """Return how this stands, under the name of a task; in a word where nothing was wrong."""
        level = HealthLevel.WARN if self.count else HealthLevel.OK
        words = f'{self.count} cannot be meant, at last: {self.why}' if self.count else fine
        return HealthFact(task, level, words, {'count': str(self.count)})
