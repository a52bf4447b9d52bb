"""Count the invalid inputs of a node and keep the last reason."""

from typing import Final, final

from lta_graph.health import HealthFact, HealthLevel

LONGEST_REASON: Final = 200  # characters of a reason, whose length the faulty sender controls


@final
class RejectionCount:
    """
    A count of invalid inputs.

    Attribute `count`: number of invalid inputs. Attribute `why`: the last reason; empty if there
    was none.
    """

    def __init__(self) -> None:
        self.count = 0
        self.why = ''

    def add(self, why: str) -> None:
        """Count one invalid input."""
        self.count += 1
        self.why = why if len(why) <= LONGEST_REASON else f'{why[:LONGEST_REASON]} ...'

    def build_fact(self, task: str, fine: str = 'all valid') -> HealthFact:
        """Return the count as the fact of a task, with the message `fine` if it is 0."""
        level = HealthLevel.WARN if self.count else HealthLevel.OK
        words = f'{self.count} invalid inputs; the last one: {self.why}' if self.count else fine
        return HealthFact(task, level, words, {'count': str(self.count)})
