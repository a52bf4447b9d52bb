"""What the link does to datagrams: loses, tears, delays, doubles, swaps them, or says nothing."""

from dataclasses import dataclass, field
import heapq
from random import Random
from typing import final


@final
@dataclass(slots=True)
class LossyLink:
    """
    A bad link in one direction.

    Parameters
    ----------
    drop, double, torn : float
        Share of the datagrams that are lost, that come twice, that end somewhere in the middle.
    delay, jitter : float
        Time on the way, and how much more at most; with more jitter than the time between two,
        datagrams overtake each other. [s]
    silent : bool
        Whether nothing comes through.
    random : Random
        Of all chance.

    """

    drop: float = 0.0
    double: float = 0.0
    torn: float = 0.0
    delay: float = 0.0
    jitter: float = 0.0
    silent: bool = False
    random: Random = field(default_factory=lambda: Random(1))
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
            heapq.heappush(self._waiting, (due, self._count, datagram))

    @property
    def has_pending(self) -> bool:
        """Whether anything is on the way."""
        return bool(self._waiting)

    def receive(self, now: float) -> list[bytes]:
        """Return what has arrived by a time [s], in the order of arrival."""
        arrived = []
        while self._waiting and self._waiting[0][0] <= now:
            arrived.append(heapq.heappop(self._waiting)[2])
        return arrived
