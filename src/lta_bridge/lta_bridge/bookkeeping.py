"""
What a recorder knows of the raw messages it takes: their time, and which have been lost.

Only the first bytes of a message are read: a stamped message begins with its header's stamp.
"""

import struct
from typing import final

from lta_config.topics import TopicTable

_STAMP = {0: struct.Struct('>iI'), 1: struct.Struct('<iI')}  # by the CDR's endianness
_ENCAPSULATION = 4  # bytes before the message


def stamp_of(data: bytes) -> int:
    """Return the header stamp of a serialised message. [ns]."""
    seconds, nanoseconds = _STAMP[data[1] & 1].unpack_from(data, _ENCAPSULATION)
    return int(seconds) * 1_000_000_000 + int(nanoseconds)


@final
class Bookkeeping:
    """
    Tell each message's log time and count the gaps.

    The log time is graph time: the newest time of publication (stamp plus latency) heard so far,
    which never runs backwards and is the same whatever the pace of the flight.

    Parameters
    ----------
    table : TopicTable
        Says which topics are stamped and how often they come.

    """

    def __init__(self, table: TopicTable) -> None:
        self._table = table
        self._now = table.start_ns
        self._last: dict[str, int] = {}
        self.counts: dict[str, int] = {}
        self.lost: dict[str, int] = {}

    def log_time(self, name: str, data: bytes) -> int:
        """
        Return when a message was heard, and remember it.

        Parameters
        ----------
        name : str
            Relative topic name.
        data : bytes
            The serialised message.

        """
        topic = self._table[name]
        self.counts[name] = self.counts.get(name, 0) + 1
        if topic.stamped and topic.period_ns:
            stamp = stamp_of(data)
            self._now = max(self._now, stamp + topic.latency_ns)
            before = self._last.get(name, stamp - topic.period_ns)
            missing = (stamp - before) // topic.period_ns - 1
            if missing > 0:
                self.lost[name] = self.lost.get(name, 0) + missing
            self._last[name] = stamp
        return self._now
