"""Iterate over the messages of a section of a recording."""

from collections.abc import Collection, Iterator
from typing import final

from lta_bridge.playback.recording import RecordedMessage, RobotBagRecording
from lta_config.errors import BadInput


@final
class MessageIterator:
    """
    A section of a recording.

    Parameters
    ----------
    topics : collection of str
        What is played.
    start, end : float
        The section, from the bag's first message of these topics. [s]

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
        start: float = 0.0,
        end: float = float('inf'),
    ) -> None:
        if end < start:
            raise BadInput(
                f'Playback would end {end:g} s after the first message, before its start at '
                f'{start:g} s; choose a later end.'
            )
        self._recording, self._topics = recording, topics
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
        self._messages = self.iterate_section()
        self._next = next(self._messages, None)
        if self._next is None:
            raise BadInput(
                f"'{recording.path}' has no message later than {start:g} s, the start of the "
                'playback; choose an earlier start.'
            )
        self.begin_ns = self._next.time_ns

    def iterate_section(self) -> Iterator[RecordedMessage]:
        """Yield the section's messages as they were recorded."""
        for item in self._recording.iterate_messages(self._topics, self._from):
            if self._to is not None and item.time_ns > self._to:
                return
            yield item

    @property
    def next_ns(self) -> int | None:
        """Time of the next message; None at the end. [ns]"""
        return None if self._next is None else self._next.time_ns

    def pop_message(self) -> RecordedMessage:
        """Return the next message and advance."""
        item = self._next
        if item is None:
            raise IndexError('there are no more messages to play')
        self._next = next(self._messages, None)
        return item
