"""
What a recorder knows of the raw messages it takes: their time, and which have been lost.

Only the first bytes of a message are read: a stamped message begins with its header's stamp.
"""

from collections.abc import Callable, Mapping, Sequence
import struct
import time
from typing import final

from lta_config.topics import TopicTable

_STAMP = {0: struct.Struct('>iI'), 1: struct.Struct('<iI')}  # by the CDR's endianness
_ENCAPSULATION = 4  # bytes before the message
_SHORTEST = _ENCAPSULATION + 8  # bytes of a message that has a stamp
JUMP_NS = 5_000_000_000  # by which a believable stamp can lie ahead of all others
AGREED = 1.0  # wall seconds of such stamps, with no nearer one: time itself has moved on


def read_stamp(data: bytes) -> int | None:
    """Return the header stamp of a serialised message, None if it is cut short. [ns]"""
    if len(data) < _SHORTEST:
        return None
    seconds, nanoseconds = _STAMP[data[1] & 1].unpack_from(data, _ENCAPSULATION)
    return int(seconds) * 1_000_000_000 + int(nanoseconds)


@final
class MessageAccounting:
    """
    Tell each message's log time and count the gaps.

    The log time is graph time: that of the message's own publication, stamp plus latency, so that
    players show together what belongs together, however late it was taken, and a repeated flight
    gives the same times. What has no stamp is dated by its turn, or by the newest publication
    heard. A stamp far ahead of all others is not believed: it would stretch the whole bag.

    Parameters
    ----------
    table : TopicTable
        Says which topics are stamped and how often they come.
    lockstep : bool
        Whether the first message of every topic is known: in real time a recorder may join late.
    clock : callable
        Returns wall time. [s]
    begun_ns : int or None
        Graph time at the start, which dates what is heard before any stamp; that of a simulated
        flight by default. [ns]

    Attributes
    ----------
    counts, lost, wild, torn : dict of str to int
        By topic: messages heard, missed on the way, with a stamp that cannot be, and too short.
    due : mapping of str to sequence of int
        By topic, when each of its messages is due, where the player of a replay has said so. [ns]

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
        self._dated = lockstep  # whether the present is known
        self._ahead_since: float | None = None
        self._last: dict[str, int] = {}
        self.due: Mapping[str, Sequence[int]] = {}
        self.counts: dict[str, int] = {}
        self.lost: dict[str, int] = {}
        self.wild: dict[str, int] = {}
        self.torn: dict[str, int] = {}

    @property
    def now(self) -> int:
        """The newest publication that has been heard. [ns]"""
        return self._now

    def assign_log_time(self, name: str, data: bytes) -> int:
        """
        Return when a message was published, in graph time, and remember it. [ns]

        Parameters
        ----------
        name : str
            Name in the table; what is not there is dated by the newest publication heard.
        data : bytes
            The serialised message.

        """
        topic = self._table.topics.get(name)
        self.counts[name] = self.counts.get(name, 0) + 1
        if topic is None or not topic.period_ns:
            return self._now
        if not topic.stamped:
            return self._scheduled_time(name)
        stamp = read_stamp(data)
        if stamp is None:
            self.torn[name] = self.torn.get(name, 0) + 1
        elif self._accept_time(stamp + topic.latency_ns):
            self._count_gap(name, stamp)
            return stamp + topic.latency_ns
        else:
            self.wild[name] = self.wild.get(name, 0) + 1
        return self._now

    def _scheduled_time(self, name: str) -> int:
        """Return when the newest message of a topic without stamps was due, if known. [ns]"""
        topic = self._table[name]
        turn = self.counts[name] - 1
        if turn < len(told := self.due.get(name, ())):
            return told[turn]
        if not self._lockstep:
            return self._now
        return self._table.start_ns + turn * topic.period_ns + topic.latency_ns

    def _accept_time(self, published: int) -> bool:
        """Move the present on to a time of publication, unless that cannot be. [ns]"""
        if published < self._table.start_ns:
            return False  # before time began: nobody has set this stamp
        if self._dated and published > self._now + JUMP_NS:
            wall = self._clock()
            self._ahead_since = wall if self._ahead_since is None else self._ahead_since
            if wall - self._ahead_since < AGREED:
                return False
        self._dated = True
        self._ahead_since = None
        self._now = max(self._now, published)
        return True

    def _count_gap(self, name: str, stamp: int) -> None:
        """Count what should have come between a topic's last stamp and this one."""
        period = self._table[name].period_ns
        first = self._table.start_ns if self._lockstep else stamp
        before = self._last.get(name, first - period)
        missing = (stamp - before) // period - 1
        if missing > 0:
            self.lost[name] = self.lost.get(name, 0) + missing
        self._last[name] = max(before, stamp)
