"""
When each message of a replay is due, whatever the recording looks like.

A played message is due when it was published: stamp plus latency, but not before its time in the
bag, and never before the one in front of it. An answer is due when it would have been published,
but not before what it answers. So nothing that is due at some time depends on anything later: a
replay that plays by time, and waits for the answers due, cannot stand still, with any gap, jitter
or jump of the stamps. Where the recording is whole, this is the table's own rule.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from lta_bridge.message_accounting import read_stamp
from lta_bridge.playback.node_selection import NodeSelection
from lta_bridge.playback.recording import RecordedMessage
from lta_config.topics import TopicTable


class DueTimes(NamedTuple):
    """Stamp of each message of a topic, and when it is due. [ns]"""

    stamps: list[int]
    due: list[int]

    def add(self, stamp_ns: int, due_ns: int) -> None:
        """Add a message; it is not due before the last one."""
        self.stamps.append(stamp_ns)
        self.due.append(max(due_ns, self.due[-1]) if self.due else due_ns)


def compute_due_times(
    messages: Iterable[RecordedMessage], table: TopicTable
) -> dict[str, DueTimes]:
    """Return when each of some played messages is due, by topic."""
    found: dict[str, DueTimes] = {}
    for name, time_ns, data in messages:
        row = table[name]
        stamp = (read_stamp(data) if row.stamped else None) or time_ns - row.latency_ns
        times = found.setdefault(name, DueTimes([], []))
        times.add(stamp, max(stamp + row.latency_ns, time_ns))
    return found


def compute_answer_times(
    played: Mapping[str, DueTimes], table: TopicTable, selection: NodeSelection
) -> dict[str, DueTimes]:
    """Return when each answer of the nodes is due, by topic."""
    found: dict[str, DueTimes] = {}

    def find_times(name: str) -> DueTimes:
        if name not in selection.answers:
            return played.get(name, DueTimes([], []))
        if name not in found:
            made = DueTimes([], [])
            row = table[name]
            for stamp, due in zip(*find_times(row.answers), strict=True):
                made.add(stamp, max(stamp + row.latency_ns, due))
            found[name] = made
        return found[name]

    for name in selection.answers:
        find_times(name)
    return found
