"""Emulate a link that loses, truncates, delays, duplicates or reorders datagrams."""

from dataclasses import dataclass, field
import heapq
from random import Random
from typing import final


@final
@dataclass(slots=True)
class LossyLink:
    """A lossy link in one direction."""

    # Fractions of datagrams that are lost, duplicated and truncated
    drop: float = 0.0
    double: float = 0.0
    torn: float = 0.0
    # Delay, and largest additional random delay, which may reorder datagrams [s]
    delay: float = 0.0
    jitter: float = 0.0
    silent: bool = False  # whether all datagrams are lost
    random: Random = field(default_factory=lambda: Random(1))  # random number generator
    _waiting: list[tuple[float, int, bytes]] = field(default_factory=list)
    _count: int = 0

    def send(self, datagram: bytes, now: float) -> None:
        """Send a datagram. [s]"""
        if self.silent or self.random.random() < self.drop:
            return
        for _ in range(2 if self.random.random() < self.double else 1):
            due = now + self.delay + self.jitter * self.random.random()
            self._count += 1
            if self.torn and self.random.random() < self.torn:
                datagram = datagram[: self.random.randrange(len(datagram) + 1)]
            # The counter keeps the order of datagrams with equal times
            heapq.heappush(self._waiting, (due, self._count, datagram))

    @property
    def has_pending(self) -> bool:
        """Whether any datagram is in transit."""
        return bool(self._waiting)

    def receive(self, now: float) -> list[bytes]:
        """Return the datagrams that have arrived by a time [s], in the order of arrival."""
        arrived = []
        while self._waiting and self._waiting[0][0] <= now:
            arrived.append(heapq.heappop(self._waiting)[2])
        return arrived
