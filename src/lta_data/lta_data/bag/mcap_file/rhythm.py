"""Track the times of messages: backward steps and long silences, from the index alone."""

from collections.abc import Iterator
from dataclasses import dataclass, field
import struct
from typing import final, Self

import numpy as np
from numpy.typing import NDArray

INDEX = struct.Struct('<BQHI')  # opcode, length, channel, bytes of entries
ENTRY = np.dtype([('time', '<u8'), ('offset', '<u8')])
LATEST = (1 << 63) - 1  # ns; larger times are errors, clipped so that differences fit int64

SILENCE = 5_000_000_000  # shortest silence that is reported [ns]
MANY_STEPS = 50  # least length of a silence, in mean steps
MOST_KEPT = 1000  # silences that are stored


@final
@dataclass(slots=True)
class MessageIntervals:
    """
    The time steps between messages, in the order of recording; times in ns.

    `backwards` counts the messages earlier than their predecessor; `worst` is the largest such
    step, `worst_of` and `worst_topic` its channel and topic. `silences` are (start, end) of steps
    of at least `SILENCE`.
    """

    count: int = 0
    first: int | None = None
    last: int | None = None
    backwards: int = 0
    worst: int = 0
    worst_of: int | None = None
    worst_topic: str | None = None
    silences: list[tuple[int, int]] = field(default_factory=list)

    def add_times(self, times: NDArray[np.uint64], channels: NDArray[np.uint16]) -> None:
        """Add the next messages; arrays of shape (n,)."""
        if not len(times):
            return
        held = np.minimum(times, np.uint64(LATEST)).astype(np.int64)
        before = held[0] if self.last is None else self.last
        steps = np.diff(held, prepend=np.int64(before))
        self.first = int(held[0]) if self.first is None else self.first
        self.last = int(held[-1])
        self.count += len(held)
        self.backwards += int(np.count_nonzero(steps < 0))
        lowest = int(np.argmin(steps))
        if -int(steps[lowest]) > self.worst:
            self.worst, self.worst_of = -int(steps[lowest]), int(channels[lowest])
        for at in np.flatnonzero(steps >= SILENCE).tolist():
            self._add_silence(int(held[at] - steps[at]), int(held[at]))

    def join(self, following: Self, worst_topic: str | None = None) -> None:
        """Append the rhythm that follows; `worst_topic` is the topic of its worst step."""
        if following.first is None or following.last is None:
            return
        if self.last is not None:
            step = following.first - self.last
            self.backwards += step < 0
            if -step > self.worst:
                self.worst, self.worst_topic = -step, None
            if step >= SILENCE:
                self._add_silence(self.last, following.first)
        if following.worst > self.worst:
            self.worst, self.worst_topic = following.worst, worst_topic
        self.first = following.first if self.first is None else self.first
        self.last = following.last
        self.count += following.count
        self.backwards += following.backwards
        for silence in following.silences:
            self._add_silence(*silence)

    def _add_silence(self, start: int, end: int) -> None:
        """Store a silence, up to `MOST_KEPT`."""
        if len(self.silences) < MOST_KEPT:
            self.silences.append((start, end))

    def find_long_silences(self) -> list[tuple[int, int]]:
        """Return the silences that are long relative to the mean step, longest first. [ns]"""
        if self.first is None or self.last is None or self.count < 3:
            return []
        whole, others = self.last - self.first, self.count - 2
        longest = sorted(self.silences, key=lambda silence: silence[0] - silence[1])
        return [
            (start, end)
            for start, end in longest
            if (end - start) * others > MANY_STEPS * (whole - (end - start))
        ]


def iterate_index_entries(region: bytes) -> Iterator[tuple[int, NDArray[np.void]]]:
    """
    Yield channel and entries of the message indexes behind a chunk.

    Stops at the first record that is not a complete message index.
    """
    at = 0
    while at + INDEX.size <= len(region):
        opcode, length, channel, size = INDEX.unpack_from(region, at)
        start = at + INDEX.size
        at = start + size
        if opcode != 7 or length != size + 6 or size % ENTRY.itemsize or at > len(region):
            return
        yield channel, np.frombuffer(region, ENTRY, size // ENTRY.itemsize, start)


def read_ordered_times(region: bytes) -> tuple[NDArray[np.uint64], NDArray[np.uint16]]:
    """Return times and channels of a chunk's messages in file order; arrays of shape (n,)."""
    entries = list(iterate_index_entries(region))
    if not entries:
        return np.empty(0, np.uint64), np.empty(0, np.uint16)
    listed = np.concatenate([listed for _, listed in entries])
    channels = np.repeat(
        np.array([channel for channel, _ in entries], np.uint16),
        [len(some) for _, some in entries],
    )
    order = np.argsort(listed['offset'], kind='stable')
    return listed['time'][order], channels[order]
