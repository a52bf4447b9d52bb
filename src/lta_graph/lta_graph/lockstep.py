# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Synchronise the inputs of a node.

DDS keeps the order within a topic but not between topics. In lockstep a node waits for all
messages that are due at a step, so every run gives the same outputs. In real time a node never
waits: it uses the messages that have arrived, and a bounded queue drops the oldest.

A simulated flight has every message of the topic table, so the due messages follow from the
periods. A recording may start late, have gaps or other periods; its player knows all messages in
advance and publishes their due times (`replay/due`).
"""

from bisect import bisect_right
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final, Protocol

from lta_config.topics import TopicTable


class MessageSchedule(Protocol):
    """Schedule of due messages, as an inbox uses it."""

    def count_due(self, name: str, now_ns: int, lag: int) -> int:
        """Return how many messages of a topic are due by a control step."""
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
        """Return how many messages of a topic are due by a control step."""
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
        """Return how many messages of a topic are due by a control step."""
        # Sorted due times, so this counts the messages due by then
        return bisect_right(self._due.get(name, ()), now_ns - lag * self._control_ns)

    def find_message_number(self, _name: str, expected: int, _stamp_ns: int) -> int:
        """Return the expected number: a player never overruns the queues of its nodes."""
        return expected


BACKLOG_NS = 2_000_000_000  # graph time; queue length in real time while the trigger is silent
APERIODIC_QUEUE = 100  # messages; queue length of an aperiodic topic


@final
@dataclass(frozen=True, slots=True)
class InboxStep:
    """The inputs of one step of a node."""

    stamp_ns: int  # stamp of the triggering message; outputs reuse it [ns]
    # New messages by topic, oldest first; an empty list if there are none
    messages: Mapping[str, list[Any]]
    # The same without those that `lta_graph.ros.message_validation` rejects
    valid: Mapping[str, list[Any]]
    # The newest message of each topic since the start; None before the first
    latest: Mapping[str, Any]

    def last_message(self, topic: str) -> Any:
        """Return the newest new message of a topic, or None."""
        messages = self.messages[topic]
        return messages[-1] if messages else None

    def last_valid(self, topic: str) -> Any:
        """Return the newest new message of a topic if it is valid, or None."""
        messages, valid = self.messages[topic], self.valid[topic]
        return messages[-1] if valid and valid[-1] is messages[-1] else None


class Inbox:
    """
    Collect a node's inputs and return them step by step.

    Parameters
    ----------
    table : TopicTable
        Defines which messages are due at each step.
    role : str
        Role of the node; determines the lag of each input.
    topics : list of str
        The inputs.
    trigger : str
        The periodic topic; each of its messages triggers a step.
    lockstep : bool
        Whether to wait for all messages that are due.
    replayed : bool
        Whether the due times come from a player; no step is returned until `turns` is set.

    Attributes
    ----------
    turns : MessageSchedule or None
        Due messages in lockstep.
    gaps : dict
        Lost messages of each topic in lockstep.

    """

    def __init__(
        self,
        table: TopicTable,
        role: str,
        topics: list[str],
        trigger: str,
        lockstep: bool,
        replayed: bool = False,
    ) -> None:
        self.turns: MessageSchedule | None = None if replayed else GridSchedule(table)
        self._table = table
        self.trigger = trigger
        self._latency_ns = table[trigger].latency_ns
        self._lockstep = lockstep
        # How many steps each input lags behind the trigger by design, from the table
        self._others = {
            name: table[name].subscribers.get(role, 0) for name in topics if name != trigger
        }
        # Only periodic topics have a known number of due messages
        self._rhythmic = {name for name in topics if table[name].period_ns}
        # Messages, each with whether it is valid
        self._queues: dict[str, deque[tuple[Any, bool]]] = {
            # A dropped trigger would be a skipped step, so its queue is unbounded in real time too
            name: deque(maxlen=None if lockstep or name == trigger else self._backlog_limit(name))
            for name in topics
        }
        self._taken = dict.fromkeys(topics, 0)
        self.gaps = dict.fromkeys(topics, 0)
        # Sequence number of the next message of each topic, from its stamps
        self._turn = dict.fromkeys(topics, 0)
        self._trigger_stamps: deque[int] = deque()
        self._latest: dict[str, Any] = dict.fromkeys(topics)

    def _backlog_limit(self, name: str) -> int:
        """Return the queue length of a topic in real time."""
        period = self._table[name].period_ns
        return max(1, BACKLOG_NS // period) if period else APERIODIC_QUEUE

    def put(self, topic: str, stamp_ns: int, message: Any, valid: bool = True) -> None:
        """Add a message; `stamp_ns` is ignored for topics without a header."""
        if self._lockstep:
            self._count_gap(topic, stamp_ns)
        self._queues[topic].append((message, valid))
        if topic == self.trigger:
            self._trigger_stamps.append(stamp_ns)

    def _count_gap(self, topic: str, stamp_ns: int) -> None:
        """Count lost messages from the sequence number that the stamp implies."""
        expected = self._turn[topic]
        arrived = (
            self.turns.find_message_number(topic, expected, stamp_ns) if self.turns else expected
        )
        self.gaps[topic] += max(0, arrived - expected)
        self._turn[topic] = arrived + 1

    def _count_due(self, name: str, lag: int, now: int) -> int:
        """Return the number of messages due so far; for aperiodic topics, all that arrived."""
        if name not in self._rhythmic:
            return self._taken[name] + len(self._queues[name])
        return 0 if self.turns is None else self.turns.count_due(name, now, lag)

    def _list_due_counts(self) -> dict[str, int]:
        """Return how many messages of each other input are due at the next step in lockstep."""
        now = self._trigger_stamps[0] + self._latency_ns
        return {name: self._count_due(name, lag, now) for name, lag in self._others.items()}

    def _list_missing(self, due: Mapping[str, int]) -> list[str]:
        taken, queues = self._taken, self._queues
        return [name for name, count in due.items() if taken[name] + len(queues[name]) < count]

    def pop(self) -> InboxStep | None:
        """Return the next step, or None while an input is missing."""
        if not self._trigger_stamps:
            return None
        if self._lockstep and self.turns is None:
            return None
        due = self._list_due_counts() if self._lockstep else {}
        if self._list_missing(due):
            return None
        stamp = self._trigger_stamps.popleft()
        taken = {self.trigger: [self._queues[self.trigger].popleft()]}
        self._taken[self.trigger] += 1
        for name in self._others:
            queue = self._queues[name]
            # In a recording whose time runs backwards, fewer are due than were taken already
            count = max(0, due[name] - self._taken[name]) if self._lockstep else len(queue)
            taken[name] = [queue.popleft() for _ in range(count)]
            self._taken[name] += count
        messages = {name: [each for each, _ in queue] for name, queue in taken.items()}
        valid = {name: [each for each, good in queue if good] for name, queue in taken.items()}
        self._latest.update({name: queue[-1] for name, queue in messages.items() if queue})
        return InboxStep(stamp, messages, valid, dict(self._latest))

    def list_missing_topics(self) -> list[str]:
        """Return the topics for which a triggered step is waiting."""
        if not self._lockstep or not self._trigger_stamps:
            return []
        return self._list_missing(self._list_due_counts())
