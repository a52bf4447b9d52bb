# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Play a section of a recording: its messages in order, each when it is due."""

from collections.abc import Collection, Iterator
import time
from typing import Final, final

from lta_bridge.playback.answer_times import NEVER_NS, PendingAnswers
from lta_bridge.playback.recording import RecordedMessage, RobotBagRecording
from lta_config.errors import BadInput

LARGEST_LAG_NS: Final = 1_000_000_000  # largest lag of a node in lockstep; queues hold 20 s
MESSAGES_PER_TICK: Final = 2000  # messages per tick at most, so that services are answered
# Wall seconds to wait for answers after the last message in real time
LAST_ANSWER_TIME: Final = 0.5


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
        """Time of the next message; None at the end [ns]."""
        return None if self._next is None else self._next.time_ns

    def pop_message(self) -> RecordedMessage:
        """Return the next message and advance."""
        item = self._next
        if item is None:
            raise IndexError('there are no more messages to play')
        self._next = next(self._messages, None)
        return item


@final
class Playback:
    """
    Progress of a replay.

    Parameters
    ----------
    section : MessageIterator
        What is played.
    pending : PendingAnswers
        What the nodes answer.
    rate : float or None
        Seconds of the bag per wall second; None plays as fast as the nodes answer, in lockstep.

    Attributes
    ----------
    now_ns : int
        Time of the newest message. [ns]
    has_begun : bool
        Whether `begin` was called; no message is due before.
    ended : str
        'played' or 'unanswered'; empty before the end.

    """

    def __init__(
        self, section: MessageIterator, pending: PendingAnswers, rate: float | None
    ) -> None:
        self._section, self.pending, self._rate = section, pending, rate
        self.now_ns, self.has_begun, self.ended = section.begin_ns, False, ''
        self._messages = 0
        self._began = self._news = 0.0

    def begin(self) -> None:
        """Start the clock."""
        self._began, self.has_begun = time.monotonic(), True
        self._news = self._began

    @property
    def is_running(self) -> bool:
        """Whether it has begun and not ended."""
        return self.has_begun and not self.ended

    def receive_answer(self, topic: str) -> int | None:
        """Count an answer, and return its due time; None if none was pending [ns]."""
        self._news = time.monotonic()
        return self.pending.register_answer(topic)

    def iterate_due(self) -> Iterator[RecordedMessage]:
        """Yield the messages that are due now, and notice the end."""
        if not self.is_running:
            return
        # Neither ahead of the playback clock nor too far ahead of an unanswered input
        until = min(self._playback_time_ns(), self.pending.latest_play_time(LARGEST_LAG_NS))
        for _ in range(MESSAGES_PER_TICK):
            due = self._section.next_ns
            if due is None or due > until:
                break
            item = self._section.pop_message()
            # The recording may contain reordered messages, but /clock must not go back
            self.now_ns = max(self.now_ns, item.time_ns)
            self._messages += 1
            yield item
            self._news = self._news if self._rate is None else time.monotonic()
        # In real time the number of answers is unknown: wait until they cease
        late = self._rate is not None and time.monotonic() - self._news < LAST_ANSWER_TIME
        if self._section.next_ns is None and not self.pending.total_pending and not late:
            self.ended = 'played'

    def end_unanswered(self, patience: float) -> None:
        """End a replay in lockstep if an answer is overdue by so many wall seconds."""
        if not self.is_running or self._rate is not None:
            return
        if time.monotonic() - self._news >= patience:
            self.ended = 'unanswered'

    def bag_time_ns(self) -> int:
        """Return the time of the bag now [ns]."""
        return self.now_ns if self._rate is None else max(self.now_ns, self._playback_time_ns())

    def _playback_time_ns(self) -> int:
        """Return the time of the bag up to which to play, apart from the answers [ns]."""
        if self._rate is None:
            return NEVER_NS
        passed = time.monotonic() - self._began if self.has_begun else 0.0
        return self._section.begin_ns + round(self._rate * 1e9 * passed)

    def summarize(self, running: bool) -> dict[str, str]:
        """Return the progress in figures; `running` is False where the player stops."""
        elapsed = (self.now_ns - self._section.begin_ns) * 1e-9
        wall = time.monotonic() - self._began if self._began else 0.0
        return {
            'outcome': self.ended or ('playing' if running else 'stopped'),
            'time_s': f'{elapsed:.3f}',
            'messages': str(self._messages),
            'answers': str(sum(self.pending.come.values())),
            'owed': str(self.pending.total),
            'unanswered': str(self.pending.total_pending),
            'pace': f'{elapsed / wall:.2f}' if wall else '0.00',
        }
