"""Which answers the nodes still owe, and how far a recording may be played before they come."""

from collections.abc import Mapping, Sequence
from typing import final

NEVER = 2**63 - 1  # ns


@final
class PendingAnswers:
    """
    The answers of a replay in lockstep.

    Parameters
    ----------
    due : mapping of str to sequence of int
        By topic, when each answer is due, in order. [ns]

    Attributes
    ----------
    come : dict of str to int
        Answers that have come, by topic.

    """

    def __init__(self, due: Mapping[str, Sequence[int]]) -> None:
        self._due = due
        self.come = dict.fromkeys(due, 0)

    def take_answer(self, topic: str) -> int | None:
        """Take an answer, and return when it was due; None where none was owed. [ns]"""
        turn = self.come[topic]
        self.come[topic] += 1
        return self._due[topic][turn] if turn < len(self._due[topic]) else None

    def oldest_due(self) -> int:
        """Return when the oldest answer that has not come is due; `NEVER` without one. [ns]"""
        left = (
            times[self.come[name]] for name, times in self._due.items() if self.count_left(name)
        )
        return min(left, default=NEVER)

    def play_horizon(self, ahead_ns: int) -> int:
        """Return to which time to play, if nodes may be behind by so much. [ns]"""
        since = self.oldest_due()
        return NEVER if since == NEVER else since + ahead_ns

    def list_oldest_topics(self) -> list[str]:
        """Return the topics whose answers are the oldest that have not come."""
        since = self.oldest_due()
        return [
            name
            for name, times in self._due.items()
            if self.count_left(name) and times[self.come[name]] == since
        ]

    def count_left(self, topic: str) -> int:
        """Return how many answers of a topic have not come."""
        return max(0, len(self._due[topic]) - self.come[topic])

    @property
    def total(self) -> int:
        """How many answers are owed over the whole replay."""
        return sum(map(len, self._due.values()))

    @property
    def total_left(self) -> int:
        """How many answers have not come."""
        return sum(map(self.count_left, self._due))
