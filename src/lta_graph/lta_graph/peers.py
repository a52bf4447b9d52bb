"""
How far robots of one launch may drift apart in time, and when all of them have ended.

Each says in a pulse, every `lead_ns`, where in time it is, and waits before it would be further
than that ahead of the newest pulse of any other. The one that is last in time never waits: all
pulses of the others are at most one period older than its own.
"""

from collections.abc import Sequence
from typing import final


@final
class Peers:
    """
    The other robots of a launch.

    Parameters
    ----------
    names : sequence of str
        Their namespaces.
    start_ns : int
        The first stamp of every robot. [ns]
    lead_ns : int
        Period of the pulse, and by how much one may be ahead of it. [ns]

    """

    def __init__(self, names: Sequence[str], start_ns: int, lead_ns: int) -> None:
        self._start_ns, self._lead_ns = start_ns, lead_ns
        self._newest: dict[str, int] = {}
        self._flying = list(names)

    @property
    def active(self) -> list[str]:
        """Those that have not ended."""
        return list(self._flying)

    def record_pulse(self, name: str, stamp_ns: int) -> None:
        """Take a pulse. [ns]"""
        self._newest[name] = max(stamp_ns, self._newest.get(name, self._start_ns))

    def mark_ended(self, name: str) -> None:
        """Take note that one has ended; nobody waits for it any more."""
        if name in self._flying:
            self._flying.remove(name)

    def find_lagging(self, stamp_ns: int) -> list[str]:
        """Return those for whom a robot that is about to be at a time has to wait. [ns]"""
        limit = stamp_ns - self._lead_ns
        return [name for name in self._flying if self._newest.get(name, self._start_ns) < limit]

    def has_started(self, name: str) -> bool:
        """Tell whether one has been heard at all."""
        return name in self._newest

    def launch_time(self, own_ns: int) -> int:
        """Return the time of the launch once one's own has stopped; it never goes back. [ns]"""
        others = [self._newest.get(name, self._start_ns) for name in self._flying]
        return max(own_ns, min(others, default=own_ns))
