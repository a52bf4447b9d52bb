"""
Determine which messages are due at a step in lockstep.

A simulated flight has every message of the topic table, so the due messages follow from the
periods. A recording may start late, have gaps or other periods; its player knows all messages in
advance and publishes their due times (`replay/due`).
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from typing import final, Protocol

from lta_config.topics import TopicTable


class MessageSchedule(Protocol):
    """Schedule of due messages, as an inbox uses it."""

    def count_due(self, name: str, now_ns: int, lag: int) -> int:
        """Return how many messages of a topic must have come at a control step."""
        ...

    def find_message_number(self, name: str, expected: int, stamp_ns: int) -> int:
        """Return the number of a message by its stamp; the expected one where it has none."""
        ...


@final
class GridSchedule:
    """Schedule of a complete flight, from the periods, latencies and first stamp of the table."""

    def __init__(self, table: TopicTable) -> None:
        self._table = table

    def count_due(self, name: str, now_ns: int, lag: int) -> int:
        """Return how many messages of a topic must have come at a control step."""
        return self._table.count_due(name, now_ns, lag)

    def find_message_number(self, name: str, expected: int, stamp_ns: int) -> int:
        """Return the number of a message by its stamp; the expected one where it has none."""
        row = self._table[name]
        if not (row.stamped and row.period_ns):
            return expected
        # Message 0 is stamped start_ns, and each later one a period more
        return (stamp_ns - self._table.start_ns) // row.period_ns


@final
class RecordedSchedule:
    """
    Schedule of a replay, as published by its player.

    `table`: gives the control period, the unit of lags. `due`: due time of each message by topic,
    sorted; a missing topic has no messages [ns].
    """

    def __init__(self, table: TopicTable, due: Mapping[str, Sequence[int]]) -> None:
        self._due = {name: list(times) for name, times in due.items()}
        self._control_ns = table.control_ns

    def count_due(self, name: str, now_ns: int, lag: int) -> int:
        """Return how many messages of a topic must have come at a control step."""
        # Sorted due times, so this counts the messages due by then
        return bisect_right(self._due.get(name, ()), now_ns - lag * self._control_ns)

    def find_message_number(self, _name: str, expected: int, _stamp_ns: int) -> int:
        """Return the expected number: a player never overruns the queues of its nodes."""
        return expected
