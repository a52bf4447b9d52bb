# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute when each message of a replay is due, also for imperfect recordings, and track answers.

A played message is due at its publication: stamp plus latency, but not before its time in the bag
and not before the previous message. An answer is due when it would have been published, but not
before its trigger. So no due message depends on a later one, and a lockstep replay that waits for
due answers cannot deadlock at gaps, jitter or jumps of the stamps. For a complete recording these
are the times of the topic table.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import final, NamedTuple

from lta_bridge.log_time_assigner import read_stamp
from lta_bridge.playback.node_selection import NodeSelection
from lta_bridge.playback.recording import RecordedMessage
from lta_config.topics import TopicTable


class DueTimes(NamedTuple):
    """Stamps and due times of the messages of a topic [ns]."""

    stamps: list[int]
    due: list[int]

    def add(self, stamp_ns: int, due_ns: int) -> None:
        """Add a message; its due time is not earlier than the last one's."""
        self.stamps.append(stamp_ns)
        self.due.append(max(due_ns, self.due[-1]) if self.due else due_ns)


def compute_due_times(
    messages: Iterable[RecordedMessage], table: TopicTable
) -> dict[str, DueTimes]:
    """Return the due times of the played messages, by topic."""
    due_times: dict[str, DueTimes] = {}
    for name, time_ns, data in messages:
        row = table[name]
        stamp = (read_stamp(data) if row.stamped else None) or time_ns - row.latency_ns
        times = due_times.setdefault(name, DueTimes([], []))
        times.add(stamp, max(stamp + row.latency_ns, time_ns))
    return due_times


def compute_answer_times(
    played: Mapping[str, DueTimes], table: TopicTable, selection: NodeSelection
) -> dict[str, DueTimes]:
    """Return the due times of the nodes' answers, by topic."""
    due_times: dict[str, DueTimes] = {}

    def find_due_times(name: str) -> DueTimes:
        if name not in selection.answers:
            return played.get(name, DueTimes([], []))
        if name not in due_times:
            answers = DueTimes([], [])
            row = table[name]
            for stamp, due in zip(*find_due_times(row.answers), strict=True):
                answers.add(stamp, max(stamp + row.latency_ns, due))
            due_times[name] = answers
        return due_times[name]

    for name in selection.answers:
        find_due_times(name)
    return due_times


def compute_schedule(
    messages: Iterable[RecordedMessage], table: TopicTable, selection: NodeSelection
) -> tuple[dict[str, list[int]], dict[str, list[int]]]:
    """Return the due times of the nodes' inputs and of their answers, by topic [ns]."""
    read = {name for node in selection.nodes for name in table.read_by(node)}
    # The trigger determines when a node answers, so its times are needed too
    topics = read | {table.trigger_topic(node) for node in selection.nodes}
    played = compute_due_times((item for item in messages if item.topic in topics), table)
    answers = compute_answer_times(played, table, selection)
    inputs = {name: times.due for name, times in (played | answers).items() if name in read}
    return inputs, {name: times.due for name, times in answers.items()}


NEVER_NS = 2**63 - 1  # ns


@final
class PendingAnswers:
    """
    Pending answers of a lockstep replay.

    `due`: due times of the answers by topic, in order [ns]. Attribute `come`: number of received
    answers by topic.
    """

    def __init__(self, due: Mapping[str, Sequence[int]]) -> None:
        self._due = due
        self.come = dict.fromkeys(due, 0)

    def register_answer(self, topic: str) -> int | None:
        """Count an answer and return its due time; None if none was pending [ns]."""
        turn = self.come[topic]
        self.come[topic] += 1
        return self._due[topic][turn] if turn < len(self._due[topic]) else None

    def oldest_due(self) -> int:
        """Return the due time of the oldest pending answer; `NEVER` without one [ns]."""
        left = (
            times[self.come[name]] for name, times in self._due.items() if self.count_pending(name)
        )
        return min(left, default=NEVER_NS)

    def latest_play_time(self, ahead_ns: int) -> int:
        """Return the time up to which to play, for a given largest lag of the nodes [ns]."""
        since = self.oldest_due()
        return NEVER_NS if since == NEVER_NS else since + ahead_ns

    def list_oldest_topics(self) -> list[str]:
        """Return the topics of the oldest pending answers."""
        since = self.oldest_due()
        return [
            name
            for name, times in self._due.items()
            if self.count_pending(name) and times[self.come[name]] == since
        ]

    def count_pending(self, topic: str) -> int:
        """Return the number of pending answers of a topic."""
        return max(0, len(self._due[topic]) - self.come[topic])

    @property
    def total(self) -> int:
        """Return the number of answers of the whole replay."""
        return sum(map(len, self._due.values()))

    @property
    def total_pending(self) -> int:
        """Return the number of pending answers."""
        return sum(map(self.count_pending, self._due))
