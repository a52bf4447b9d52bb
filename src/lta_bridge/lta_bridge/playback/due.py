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

from lta_bridge.bookkeeping import stamp_of
from lta_bridge.playback.cast import Cast
from lta_bridge.playback.recording import Recorded
from lta_config.topics import TopicTable


class Times(NamedTuple):
    """Stamp of each message of a topic, and when it is due. [ns]"""

    stamps: list[int]
    due: list[int]

    def add(self, stamp_ns: int, due_ns: int) -> None:
        """Add a message; it is not due before the last one."""
        self.stamps.append(stamp_ns)
        self.due.append(max(due_ns, self.due[-1]) if self.due else due_ns)


def survey(messages: Iterable[Recorded], table: TopicTable) -> dict[str, Times]:
    """Return when each of some played messages is due, by topic."""
    found: dict[str, Times] = {}
    for name, time_ns, data in messages:
        row = table[name]
        stamp = (stamp_of(data) if row.stamped else None) or time_ns - row.latency_ns
        times = found.setdefault(name, Times([], []))
        times.add(stamp, max(stamp + row.latency_ns, time_ns))
    return found


def answered(played: Mapping[str, Times], table: TopicTable, cast: Cast) -> dict[str, Times]:
    """Return when each answer of the nodes is due, by topic."""
    found: dict[str, Times] = {}

    def times(name: str) -> Times:
        if name not in cast.answers:
            return played.get(name, Times([], []))
        if name not in found:
            made = Times([], [])
            row = table[name]
            for stamp, due in zip(*times(row.answers), strict=True):
                made.add(stamp, max(stamp + row.latency_ns, due))
            found[name] = made
        return found[name]

    for name in cast.answers:
        times(name)
    return found
