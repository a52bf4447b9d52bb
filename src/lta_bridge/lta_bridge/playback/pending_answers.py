"""Track the nodes' pending answers, which limit how far a recording may be played."""

from collections.abc import Mapping, Sequence
from typing import final

NEVER_NS = 2**63 - 1  # ns


@final
class PendingAnswers:
    """
    Pending answers of a lockstep replay.

    `due`: due times of the answers by topic, in order [ns]. Attribute `come`: number of received
    answers by topic.
    """

    def __init__(self, due: Mapping[str, Sequence[int]]) -> None:
        self._due = due
        self.come = dict.fromkeys(due, 0)

    def register_answer(self, topic: str) -> int | None:
        """Count an answer and return its due time; None if none was pending. [ns]"""
        turn = self.come[topic]
        self.come[topic] += 1
        return self._due[topic][turn] if turn < len(self._due[topic]) else None

    def oldest_due(self) -> int:
        """Return the due time of the oldest pending answer; `NEVER` without one. [ns]"""
        left = (
            times[self.come[name]] for name, times in self._due.items() if self.count_pending(name)
        )
        return min(left, default=NEVER_NS)

    def latest_play_time(self, ahead_ns: int) -> int:
        """Return the time up to which to play, for a given largest lag of the nodes. [ns]"""
        since = self.oldest_due()
        return NEVER_NS if since == NEVER_NS else since + ahead_ns

    def list_oldest_topics(self) -> list[str]:
        """Return the topics of the oldest pending answers."""
        since = self.oldest_due()
        return [
            name
            for name, times in self._due.items()
            if self.count_pending(name) and times[self.come[name]] == since
        ]

    def count_pending(self, topic: str) -> int:
        """Return the number of pending answers of a topic."""
        return max(0, len(self._due[topic]) - self.come[topic])

    @property
    def total(self) -> int:
        """Number of answers of the whole replay."""
        return sum(map(len, self._due.values()))

    @property
    def total_pending(self) -> int:
        """Number of pending answers."""
        return sum(map(self.count_pending, self._due))
