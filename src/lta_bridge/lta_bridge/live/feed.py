"""Select, stamp and count the messages that a live view forwards to viewers."""

from collections.abc import Callable
import time
from typing import final

from lta_bridge.log_time_assigner import LogTimeAssigner, read_stamp
from lta_config.topics import TopicTable


@final
class RateLimiter:
    """
    Limit events to a mean rate. [Hz]

    Events at exactly this rate all pass despite jitter: one may be early by half an interval, and
    the next interval counts from when it was due.
    """

    def __init__(self, rate: float) -> None:
        self._interval = 1.0 / rate
        self._due = -float('inf')

    def try_acquire(self, now: float) -> bool:
        """Return whether an event at a wall time passes; count it if so. [s]"""
        if now < self._due - 0.5 * self._interval:
            return False
        self._due = max(self._due, now - 0.5 * self._interval) + self._interval
        return True


SCREEN_RATE = 60.0  # Hz of wall time: a usual screen rate
LARGE_MESSAGES = {'lta_msgs/msg/LightBlock': 10.0}  # Hz, limits of large messages; this has 16 kB


@final
class TopicThrottle:
    """
    Limit the rate of each topic for viewers.

    Only periodic topics with a stamp are thinned. On others, such as /diagnostics and /tf, each
    message may be from another node. `clock` returns the wall time. [s]

    Attributes `sent`, `left_out`: by topic: forwarded messages, and those dropped between them.
    """

    def __init__(self, table: TopicTable, clock: Callable[[], float] = time.monotonic) -> None:
        self._table = table
        self._clock = clock
        self._books = LogTimeAssigner(table, lockstep=False, clock=clock)
        self._paces = {
            name: RateLimiter(LARGE_MESSAGES.get(topic.type, SCREEN_RATE))
            for name, topic in table.topics.items()
            if topic.period_ns and topic.stamped
        }
        self._last: dict[str, int] = {}
        self.sent: dict[str, int] = {}
        self.left_out: dict[str, int] = {}

    @property
    def now(self) -> int:
        """Time of the newest plausible publication. [ns]"""
        return self._books.now

    def admit_message(self, name: str, data: bytes, *, has_viewers: bool) -> int | None:
        """
        Return the log time of a message to forward, None for one to drop. [ns]

        `name` is the relative topic name.
        """
        when = self._books.assign_log_time(name, data)
        if not has_viewers:
            self._last.pop(name, None)  # without viewers, messages do not count as dropped
            return None
        if name in self._paces and not self._paces[name].try_acquire(self._clock()):
            return None
        self._count_message(name, data)
        return when

    def _count_message(self, name: str, data: bytes) -> None:
        """Count a forwarded message, and by its stamp those dropped before it."""
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
