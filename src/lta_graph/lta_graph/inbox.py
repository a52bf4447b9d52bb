"""
When a node may answer: only after every input that the topic table makes due has come.

DDS keeps the order within a topic but not between topics. In lockstep each message of a periodic
topic has a known turn, so a node can tell what is missing, wait for it, and give the same answers
in every run. In real time nobody waits: a node takes what has come, and of what it does not take
only the newest is kept.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from lta_config.topics import TopicTable
from lta_graph.lockstep import GridTurns, MessageTurns

BACKLOG_NS = 2_000_000_000  # of graph time: what is kept for a trigger that has stopped
BACKLOG = 100  # messages of a topic without a rhythm


@final
@dataclass(frozen=True, slots=True)
class InboxStep:
    """
    What a node answers at once.

    Attributes
    ----------
    stamp_ns : int
        Stamp of the message that triggered the step; the answer keeps it. [ns]
    messages : mapping
        New messages by topic, oldest first; empty lists where nothing new has come.

    """

    stamp_ns: int
    messages: Mapping[str, list[Any]]

    def last_message(self, topic: str) -> Any:  # noqa: ANN401 - a message of whatever type the topic has
        """Return the newest new message of a topic, or None."""
        messages = self.messages[topic]
        return messages[-1] if messages else None


class Inbox:
    """
    Collect one node's inputs and hand them out step by step.

    Parameters
    ----------
    table : TopicTable
        Says what is due when.
    role : str
        Whose inbox this is; gives the lag of each input.
    topics : list of str
        The inputs.
    trigger : str
        The periodic topic that the node answers, message by message.
    lockstep : bool
        Whether to wait for everything that is due.
    replayed : bool
        Whether what is due is still to be told, in `turns`; nothing is handed out before.

    Attributes
    ----------
    turns : Turns or None
        What is due when, in lockstep.

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
        self.turns: MessageTurns | None = None if replayed else GridTurns(table)
        self._table = table
        self._trigger = trigger
        self._lockstep = lockstep
        self._others = {
            name: table[name].subscribers.get(role, 0) for name in topics if name != trigger
        }
        self._rhythmic = {name for name in topics if table[name].period_ns}
        self._queues: dict[str, deque[Any]] = {
            name: deque(maxlen=None if lockstep or name == trigger else self._backlog_limit(name))
            for name in topics
        }
        self._taken = dict.fromkeys(topics, 0)
        self.gaps = dict.fromkeys(topics, 0)
        self._turn = dict.fromkeys(topics, 0)
        self._trigger_stamps: deque[int] = deque()

    def _backlog_limit(self, name: str) -> int:
        """Return how many messages of a topic are kept in real time until they are taken."""
        period = self._table[name].period_ns
        return max(1, BACKLOG_NS // period) if period else BACKLOG

    def put(self, topic: str, stamp_ns: int, message: Any) -> None:  # noqa: ANN401
        """
        Add a message.

        Parameters
        ----------
        topic : str
            Relative topic name.
        stamp_ns : int
            The header's stamp; ignored where the topic has none. [ns]
        message : Any
            The message itself, handed out unchanged.

        """
        if self._lockstep:
            self._count_gap(topic, stamp_ns)
        self._queues[topic].append(message)
        if topic == self._trigger:
            self._trigger_stamps.append(stamp_ns)

    def _count_gap(self, topic: str, stamp_ns: int) -> None:
        """Count messages that were lost on the way, by the turn that this one should have."""
        expected = self._turn[topic]
        arrived = self.turns.find_turn(topic, expected, stamp_ns) if self.turns else expected
        self.gaps[topic] += max(0, arrived - expected)
        self._turn[topic] = arrived + 1

    def _count_due(self, name: str, lag: int, now: int) -> int:
        """Return how many messages must have come; of a topic without rhythm, all that have."""
        if name not in self._rhythmic:
            return self._taken[name] + len(self._queues[name])
        return 0 if self.turns is None else self.turns.count_due(name, now, lag)

    def _list_missing(self) -> list[str]:
        now = self._trigger_stamps[0] + self._table[self._trigger].latency_ns
        return [
            name
            for name, lag in self._others.items()
            if self._taken[name] + len(self._queues[name]) < self._count_due(name, lag, now)
        ]

    def pop(self) -> InboxStep | None:
        """Return the next step if all it needs has come, else None."""
        if not self._trigger_stamps:
            return None
        if self._lockstep and (self.turns is None or self._list_missing()):
            return None
        stamp = self._trigger_stamps.popleft()
        now = stamp + self._table[self._trigger].latency_ns
        messages = {self._trigger: [self._queues[self._trigger].popleft()]}
        self._taken[self._trigger] += 1
        for name, lag in self._others.items():
            queue = self._queues[name]
            count = len(queue)
            if self._lockstep:
                # A recording whose time goes back asks for less than has been taken already.
                count = max(0, self._count_due(name, lag, now) - self._taken[name])
            messages[name] = [queue.popleft() for _ in range(count)]
            self._taken[name] += count
        return InboxStep(stamp, messages)

    def list_missing_topics(self) -> list[str]:
        """Return the topics that keep a begun step from being answered."""
        return self._list_missing() if self._lockstep and self._trigger_stamps else []
