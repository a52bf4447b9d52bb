"""Which of the messages that a live view hears it hands on, dated and counted."""

from collections.abc import Callable
import time
from typing import final

from lta_bridge.live.rate_limiter import RateLimiter
from lta_bridge.message_accounting import MessageAccounting, read_stamp
from lta_config.topics import TopicTable

FASTEST = 60.0  # Hz of wall time: as often as a screen changes
HEAVY = {'sensor_msgs/msg/Image': 10.0}  # Hz of what is large; a light block has 16 kB


@final
class LiveFeed:
    """
    The share of each topic that viewers get.

    Only a topic with a rhythm is thinned: of one without, such as /diagnostics, each message may
    be of somebody else.

    Parameters
    ----------
    table : TopicTable
        Says how often topics come.
    clock : callable
        Returns wall time. [s]

    Attributes
    ----------
    sent, left_out : dict of str to int
        By topic: messages handed on, and those between them that were not.

    """

    def __init__(self, table: TopicTable, clock: Callable[[], float] = time.monotonic) -> None:
        self._table = table
        self._clock = clock
        self._books = MessageAccounting(table, lockstep=False, clock=clock)
        self._paces = {
            name: RateLimiter(HEAVY.get(topic.type, FASTEST))
            for name, topic in table.topics.items()
            if topic.period_ns
        }
        self._last: dict[str, int] = {}
        self.sent: dict[str, int] = {}
        self.left_out: dict[str, int] = {}

    @property
    def now(self) -> int:
        """The newest publication that has been heard and believed. [ns]"""
        return self._books.now

    def admit_message(self, name: str, data: bytes, *, has_viewers: bool) -> int | None:
        """
        Return the log time of a message if it is to be handed on. [ns]

        Parameters
        ----------
        name : str
            Relative topic name.
        data : bytes
            The serialised message.
        wanted : bool
            Whether anybody looks at the topic.

        """
        when = self._books.assign_log_time(name, data)
        if not has_viewers:
            self._last.pop(name, None)  # nobody misses what comes until the next is sent
            return None
        if name in self._paces and not self._paces[name].try_acquire(self._clock()):
            return None
        self._count_message(name, data)
        return when

    def _count_message(self, name: str, data: bytes) -> None:
        """Count a message, and by its stamp those between it and the one before."""
        self.sent[name] = self.sent.get(name, 0) + 1
        topic = self._table[name]
        stamp = read_stamp(data) if topic.period_ns and topic.stamped else None
        if stamp is None:
            return
        before = self._last.get(name, stamp - topic.period_ns)
        between = (stamp - before) // topic.period_ns - 1
        if between > 0:
            self.left_out[name] = self.left_out.get(name, 0) + between
        self._last[name] = stamp
