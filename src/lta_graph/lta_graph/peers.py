"""
Synchronise the simulation time of several robots in one launch.

Each robot publishes a pulse with its time every `lead_ns`, and waits before it would get further
ahead of the newest pulse of any other. There is no deadlock, because the slowest robot never
waits: the pulses of the others are at most one period older than its own.
"""

from collections.abc import Sequence
from typing import final


@final
class Peers:
    """
    The other robots of a launch.

    `names`: their namespaces. `start_ns`: the first stamp of every robot [ns]. `lead_ns`: pulse
    period and largest lead over a pulse [ns].
    """

    def __init__(self, names: Sequence[str], start_ns: int, lead_ns: int) -> None:
        self._start_ns, self._lead_ns = start_ns, lead_ns
        self._newest: dict[str, int] = {}
        self._flying = list(names)

    @property
    def active_robots(self) -> list[str]:
        """Robots that have not ended."""
        return list(self._flying)

    def record_pulse(self, name: str, stamp_ns: int) -> None:
        """Record a pulse. [ns]"""
        # A late or repeated pulse must not move time back
        self._newest[name] = max(stamp_ns, self._newest.get(name, self._start_ns))

    def mark_ended(self, name: str) -> None:
        """Mark a robot as ended; others stop waiting for it."""
        if name in self._flying:
            self._flying.remove(name)

    def find_lagging(self, stamp_ns: int) -> list[str]:
        """Return the robots to wait for before advancing to a time. [ns]"""
        # A robot without a pulse counts as being at the start
        limit = stamp_ns - self._lead_ns
        return [name for name in self._flying if self._newest.get(name, self._start_ns) < limit]

    def has_started(self, name: str) -> bool:
        """Return whether a robot has sent a pulse."""
        return name in self._newest

    def common_time(self, own_ns: int) -> int:
        """Return the common time after the own robot has stopped; it never decreases. [ns]"""
        others = [self._newest.get(name, self._start_ns) for name in self._flying]
        return max(own_ns, min(others, default=own_ns))
