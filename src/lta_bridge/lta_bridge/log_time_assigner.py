# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Assign log times to raw messages and count lost ones.

Only the first bytes of a message are read: a stamped message begins with its header's stamp, a
message on /tf with the number of its transforms and the first one's stamp.
"""

from collections.abc import Callable, Mapping, Sequence
import struct
import time
from typing import final

from lta_config.topics import TopicTable

_STAMP = {0: struct.Struct('>iI'), 1: struct.Struct('<iI')}  # by the CDR's endianness
_ENCAPSULATION = 4  # bytes of the CDR header
TRANSFORMS = 'tf2_msgs/msg/TFMessage'
LARGEST_JUMP_NS = 5_000_000_000  # largest plausible jump ahead of the newest stamp
AGREED = 1.0  # wall seconds; if all stamps stay ahead this long, graph time itself has jumped


def read_stamp(data: bytes, skipped: int = 0) -> int | None:
    """
    Return the header stamp of a serialised message; None if it is truncated [ns].

    `skipped` is the number of bytes before the header, which comes first in a stamped message.
    """
    begin = _ENCAPSULATION + skipped
    if len(data) < begin + 8:
        return None
    # The stamp comes first in the header
    seconds, nanoseconds = _STAMP[data[1] & 1].unpack_from(data, begin)
    return int(seconds) * 1_000_000_000 + int(nanoseconds)


@final
class LogTimeAssigner:
    """
    Assign each message's log time and count gaps.

    The log time is the graph time of publication, stamp plus latency. It does not depend on
    delays in transport, so a repeated flight gives the same times. An unstamped message gets its
    scheduled time, or the newest publication time. What is published once, such as /tf_static,
    gets the start of a flight in lockstep. Stamps far ahead of all others are rejected: they would
    stretch the whole bag.

    Parameters
    ----------
    table : TopicTable
        States which topics are stamped, and their periods.
    lockstep : bool
        Whether recording starts with the first message of every topic; in real time a recorder
        may join late.
    clock : callable
        Returns wall time. [s]
    begun_ns : int or None
        Graph time at the start, used before the first stamp; by default that of a simulated
        flight. [ns]

    Attributes
    ----------
    counts, lost, wild, torn : dict of str to int
        By topic: received messages, missed ones, implausible stamps, truncated messages.
    due : mapping of str to sequence of int
        By topic, the due time of each message as announced by the player of a replay. [ns]

    """

    def __init__(
        self,
        table: TopicTable,
        lockstep: bool,
        clock: Callable[[], float] = time.monotonic,
        begun_ns: int | None = None,
    ) -> None:
        self._clock = clock
        self._table = table
        self._lockstep = lockstep
        self._now = table.start_ns if begun_ns is None else begun_ns
        self._dated = lockstep  # whether the present graph time is known from a stamp
        self._begun = begun_ns is not None
        self._ahead_since: float | None = None
        self._last: dict[str, int] = {}
        # By periodic topic with a stamp: bytes before it, latency and period [ns]
        self._stamped = {
            name: (4 if topic.type == TRANSFORMS else 0, topic.latency_ns, topic.period_ns)
            for name, topic in table.topics.items()
            if topic.period_ns and (topic.stamped or topic.type == TRANSFORMS)
        }
        self.due: Mapping[str, Sequence[int]] = {}
        self.counts: dict[str, int] = {}
        self.lost: dict[str, int] = {}
        self.wild: dict[str, int] = {}
        self.torn: dict[str, int] = {}

    @property
    def now(self) -> int:
        """Time of the newest publication [ns]."""
        return self._now

    @property
    def knows_time(self) -> bool:
        """Whether the present graph time is known, from a stamp or from the start."""
        return self._dated or self._begun

    def assign_log_time(self, name: str, data: bytes) -> int:
        """
        Return the log time of a serialised message, in graph time [ns].

        A topic that is not in the table gets the newest publication time.
        """
        self.counts[name] = self.counts.get(name, 0) + 1
        if name not in self._stamped:
            return self._scheduled_time(name)
        skipped, latency, period = self._stamped[name]
        stamp = read_stamp(data, skipped)
        if stamp is None:
            self.torn[name] = self.torn.get(name, 0) + 1
        elif self._accept_time(stamp + latency):
            self._count_gap(name, stamp, period)
            return stamp + latency
        else:
            self.wild[name] = self.wild.get(name, 0) + 1
        return self._now

    def _scheduled_time(self, name: str) -> int:
        """Return the due time of the newest message of an unstamped topic, if known [ns]."""
        topic = self._table.topics.get(name)
        if topic is None or not topic.period_ns:
            once = topic is not None and topic.repeatable
            return self._table.start_ns if self._lockstep and once else self._now
        turn = self.counts[name] - 1
        if turn < len(due := self.due.get(name, ())):
            return due[turn]
        if not self._lockstep:
            return self._now
        # In lockstep message k of a periodic topic is due after k periods and its latency
        return self._table.start_ns + turn * topic.period_ns + topic.latency_ns

    def _accept_time(self, published: int) -> bool:
        """Advance the present to a publication time; return False if it is implausible [ns]."""
        if published < self._table.start_ns:
            return False  # earlier than any flight: the stamp was not set
        if self._dated and published > self._now + LARGEST_JUMP_NS:
            wall = self._clock()
            self._ahead_since = wall if self._ahead_since is None else self._ahead_since
            if wall - self._ahead_since < AGREED:
                return False
        self._dated = True
        self._ahead_since = None
        self._now = max(self._now, published)
        return True

    def _count_gap(self, name: str, stamp: int, period: int) -> None:
        """Count the messages missing between a topic's last stamp and this one, in ns."""
        # In real time the recorder may have joined late, so nothing counts before the first stamp
        first = self._table.start_ns if self._lockstep else stamp
        before = self._last.get(name, first - period)
        missing = (stamp - before) // period - 1
        if missing > 0:
            self.lost[name] = self.lost.get(name, 0) + missing
        # A late message must not make the next one look like a gap
        self._last[name] = max(before, stamp)
