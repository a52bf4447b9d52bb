# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Receive raw messages for a bag: assign log times and count losses."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
import time
from typing import final

from lta_bag.background_writer import BackgroundWriter
from lta_bridge.log_time_assigner import LogTimeAssigner
from lta_config.topics import absolute_topic, TopicTable
from lta_graph.health import HealthLevel


@final
class MessageIntake:
    """
    Receive raw messages of one or several robots and hand them to a bag writer.

    Parameters
    ----------
    robots : sequence of str
        Namespaces, at least one; '' for a robot without a namespace.
    table, lockstep, begun_ns
        See `LogTimeAssigner`.

    Attributes
    ----------
    latest : float
        Arrival of the last message. [wall s]

    """

    def __init__(
        self,
        table: TopicTable,
        lockstep: bool,
        robots: Sequence[str],
        writer: BackgroundWriter,
        begun_ns: int | None = None,
    ) -> None:
        self._table = table
        self._robots = robots
        self._lockstep = lockstep
        # Messages sent once that came before any stamp: who joins late gets them first
        self._early: list[tuple[str, bytes]] = []
        self._books = {
            name: LogTimeAssigner(table, lockstep, begun_ns=begun_ns) for name in robots
        }
        self._common = LogTimeAssigner(table, lockstep, begun_ns=begun_ns)
        self._writer = writer
        self.latest = time.monotonic()

    def find_owner(self, name: str) -> tuple[str | None, str]:
        """Return the robot of an absolute topic (None if shared) and its name relative to it."""
        for robot in self._robots if name not in self._table.topics else ():
            prefix = absolute_topic(robot, '')
            if name.startswith(prefix):
                return robot, name.removeprefix(prefix)
        return None, name

    def covers_topic(self, name: str) -> bool:
        """Return whether an absolute topic belongs to a robot or has no namespace."""
        robot, relative = self.find_owner(name)
        # Any other namespace belongs to another graph
        return robot is not None or '/' not in relative.lstrip('/')

    def create_topic_callback(self, name: str) -> Callable[[bytes], None]:
        """Return the callback for the messages of an absolute topic."""
        robot, row = self.find_owner(name)
        topic = self._table.topics.get(row)
        once = topic is not None and topic.repeatable and not topic.period_ns
        write, clock = self._writer.write, time.monotonic
        log_time = (
            self._assign_common_time if robot is None else self._books[robot].assign_log_time
        )

        def receive_message(data: bytes) -> None:
            self.latest = clock()
            when = log_time(row, data)
            if not any(books.knows_time for books in self._books.values()):
                if once:
                    self._early.append((name, data))
                    return
            elif self._early:
                self.write_early_messages()
            write(name, data, when)

        return receive_message

    def write_early_messages(self) -> None:
        """Write the messages that were sent once before any stamp, at the present time."""
        now = max(books.now for books in self._books.values())
        for name, data in self._early:
            self._writer.write(name, data, now)
        self._early.clear()

    def _assign_common_time(self, name: str, data: bytes) -> int:
        """Return the log time of a shared topic's message: its own, or the newest of all [ns]."""
        when = self._common.assign_log_time(name, data)
        row = self._table.topics.get(name)
        if row is not None and row.repeatable and (row.period_ns or self._lockstep):
            return when
        # Never before a message that a robot has sent already
        return max(books.now for books in self._books.values())

    def set_due_times(self, robot: str, due: Mapping[str, Sequence[int]]) -> None:
        """Set the log times of a robot's unstamped messages by topic, from a replay [ns]."""
        self._books[robot].due = due

    def summarize_recording(
        self, lost: Mapping[str, int]
    ) -> tuple[HealthLevel, str, dict[str, object]]:
        """
        Return level, message and figures of a running recording.

        `lost` holds the messages lost by the middleware, by absolute topic.
        """
        wrong = {
            'lost': self._count_by_topic('lost'),
            'lost by the middleware': self._rename_topics(
                # A queue of depth 1 drops messages by design
                {name: count for name, count in lost.items() if not self._keeps_only_newest(name)}
            ),
            'dropped': self._rename_topics(self._writer.dropped),
            'with a wild stamp': self._count_by_topic('wild'),
            'cut short': self._count_by_topic('torn'),
        }
        words = [
            f'{by_topic.total()} messages {what}'
            for what, by_topic in wrong.items()
            if by_topic.total()
        ]
        figures: dict[str, object] = {
            'messages': self._count_by_topic('counts').total(),
            'waiting_bytes': self._writer.queued_bytes,
        }
        for what, by_topic in wrong.items():
            figures |= {f'{name} {what}': count for name, count in by_topic.items() if count}
        return (
            HealthLevel.WARN if words else HealthLevel.OK,
            ', '.join(words) or 'recording',
            figures,
        )

    def _keeps_only_newest(self, name: str) -> bool:
        """Return whether each message replaces the last, so that a loss is normal (`/clock`)."""
        topic = self._table.topics.get(self.find_owner(name)[1])
        return topic is not None and topic.qos == 'clock'

    def _count_by_topic(self, what: str) -> Counter[str]:
        """Return one of the counts over all robots, by topic."""
        total: Counter[str] = Counter(getattr(self._common, what))
        for robot, books in self._books.items():
            counts = getattr(books, what).items()
            total.update(
                {self._display_name(absolute_topic(robot, name)): count for name, count in counts}
            )
        return total

    def _rename_topics(self, counts: Mapping[str, int]) -> Counter[str]:
        """Return counts by absolute topic as `_count_by_topic` names them."""
        return Counter({self._display_name(name): count for name, count in counts.items()})

    def _display_name(self, name: str) -> str:
        """Return a topic's relative name, or the absolute one if there are several robots."""
        return name if len(self._robots) > 1 else self.find_owner(name)[1]
