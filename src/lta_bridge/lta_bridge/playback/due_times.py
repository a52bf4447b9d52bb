"""
Compute when each message of a replay is due, also for imperfect recordings.

A played message is due at its publication: stamp plus latency, but not before its time in the bag
and not before the previous message. An answer is due when it would have been published, but not
before its trigger. So no due message depends on a later one, and a lockstep replay that waits for
due answers cannot deadlock at gaps, jitter or jumps of the stamps. For a complete recording these
are the times of the topic table.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from lta_bridge.log_time_assigner import read_stamp
from lta_bridge.playback.node_selection import NodeSelection
from lta_bridge.playback.recording import RecordedMessage
from lta_config.topics import TopicTable


class DueTimes(NamedTuple):
    """Stamps and due times of the messages of a topic. [ns]"""

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
