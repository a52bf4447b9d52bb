"""
Which messages must have come by when: by the topic table's grid, or by what a recording holds.

A simulated flight has every message of the table, so that counting periods tells what is due. A
recording may begin late, have gaps, or keep a rhythm of its own. Its player knows every message
beforehand and tells the nodes when each is due (`replay/due`).
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from typing import final, Protocol

from lta_config.topics import TopicTable


class MessageTurns(Protocol):
    """What an inbox asks."""

    def count_due(self, name: str, now_ns: int, lag: int) -> int:
        """Return how many messages of a topic must have come at a control step."""
        ...

    def find_turn(self, name: str, expected: int, stamp_ns: int) -> int:
        """Return the number of a message by its stamp; the expected one where it has none."""
        ...


@final
class GridTurns:
    """
    The turns of a whole flight from the table's first stamp on.

    Parameters
    ----------
    table : TopicTable
        Periods, latencies and the first stamp.

    """

    def __init__(self, table: TopicTable) -> None:
        self._table = table

    def count_due(self, name: str, now_ns: int, lag: int) -> int:
        """Return how many messages of a topic must have come at a control step."""
        return self._table.count_due(name, now_ns, lag)

    def find_turn(self, name: str, expected: int, stamp_ns: int) -> int:
        """Return the number of a message by its stamp; the expected one where it has none."""
        row = self._table[name]
        if not (row.stamped and row.period_ns):
            return expected
        return (stamp_ns - self._table.start_ns) // row.period_ns


@final
class RecordedTurns:
    """
    The turns of a replay: what its player said.

    Parameters
    ----------
    table : TopicTable
        The control period, in which lags are counted.
    due : mapping of str to sequence of int
        By topic, when each message is due, in order. A topic that is not there has none. [ns]

    """

    def __init__(self, table: TopicTable, due: Mapping[str, Sequence[int]]) -> None:
        self._due = {name: list(times) for name, times in due.items()}
        self._control_ns = table.control_ns

    def count_due(self, name: str, now_ns: int, lag: int) -> int:
        """Return how many messages of a topic must have come at a control step."""
        return bisect_right(self._due.get(name, ()), now_ns - lag * self._control_ns)

    def find_turn(self, _name: str, expected: int, _stamp_ns: int) -> int:
        """Return the expected number: a player sends no more than its nodes can keep."""
        return expected
