"""Iterate over the messages of a section of a recording, once or in a loop."""

from collections.abc import Collection, Iterator
import struct
from typing import final

from lta_bridge.log_time_assigner import read_stamp
from lta_bridge.playback.recording import RecordedMessage, RobotBagRecording
from lta_config.errors import BadInput
from lta_config.topics import TopicTable

_STAMP = {0: struct.Struct('>iI'), 1: struct.Struct('<iI')}  # by the CDR's endianness
_AT = 4  # bytes before a message's header


def shift_stamp(data: bytes, by_ns: int) -> bytes:
    """Return a stamped message with a shifted header stamp. [ns]"""
    stamp = read_stamp(data)
    # The first round is passed on unchanged
    if stamp is None or not by_ns:
        return data
    seconds, nanoseconds = divmod(stamp + by_ns, 1_000_000_000)
    words = _STAMP[data[1] & 1].pack(seconds, nanoseconds)
    return data[:_AT] + words + data[_AT + len(words) :]


@final
class MessageIterator:
    """
    A section of a recording.

    Parameters
    ----------
    topics : collection of str
        What is played.
    table : TopicTable
        Says what is stamped, and how long a period is.
    start, end : float
        The section, from the bag's first message of these topics. [s]
    loop : bool
        Whether to begin again, with stamps that go on.

    Attributes
    ----------
    begin_ns : int
        Time of the first message of the section. [ns]

    Raises
    ------
    BadInput
        If there is nothing in it.

    """

    def __init__(
        self,
        recording: RobotBagRecording,
        topics: Collection[str],
        table: TopicTable,
        start: float = 0.0,
        end: float = float('inf'),
        loop: bool = False,
    ) -> None:
        if end < start:
            raise BadInput(
                f'Playback would end {end:g} s after the first message, before its start at '
                f'{start:g} s; choose a later end.'
            )
        self._recording, self._topics, self._table = recording, topics, table
        first = next(recording.iterate_messages(topics), None)
        if first is None:
            names = ', '.join(sorted(topics)) or 'that the nodes need'
            why = ''.join(f'; {each}' for each in recording.strange)
            raise BadInput(
                f"'{recording.path}' has no message on the topics {names}{why}; choose another "
                'bag.'
            )
        self._from = first.time_ns + round(start * 1e9)
        self._to = None if end == float('inf') else first.time_ns + round(end * 1e9)
        self._loop = loop
        self._shift = 0
        self._messages = self.iterate_section()
        self._next = next(self._messages, None)
        if self._next is None:
            raise BadInput(
                f"'{recording.path}' has no message later than {start:g} s, the start of the "
                'playback; choose an earlier start.'
            )
        self.begin_ns = self._newest = self._next.time_ns
        self.rounds = 0

    def iterate_section(self) -> Iterator[RecordedMessage]:
        """Yield the section's messages as they were recorded."""
        for item in self._recording.iterate_messages(self._topics, self._from):
            if self._to is not None and item.time_ns > self._to:
                return
            yield item

    @property
    def next_ns(self) -> int | None:
        """Time of the next message; None at the end. [ns]"""
        return None if self._next is None else self._next.time_ns + self._shift

    def pop_message(self) -> RecordedMessage:
        """Return the next message and advance."""
        item = self._next
        if item is None:
            raise IndexError('there are no more messages to play')
        self._newest = item.time_ns
        # Before rewinding, which changes the shift for the next message
        by_ns, stamped = self._shift, self._table[item.topic].stamped
        self._next = next(self._messages, None)
        if self._next is None and self._loop:
            self._rewind()
        data = shift_stamp(item.data, by_ns) if stamped else item.data
        return RecordedMessage(item.topic, item.time_ns + by_ns, data)

    def _rewind(self) -> None:
        """Restart the section; shifted stamps continue on the common grid of all periods."""
        grid = max(self._table[name].period_ns for name in self._topics) or self._table.control_ns
        span = self._newest - self.begin_ns
        # The next multiple of the grid behind the last message, so that time always increases
        self._shift += (span // grid + 1) * grid
        self.rounds += 1
        self._messages = self.iterate_section()
        self._next = next(self._messages, None)
