"""When messages were recorded: steps back in time and long silences, by the index alone."""

from collections.abc import Iterator
from dataclasses import dataclass, field
import struct
from typing import final, Self

import numpy as np
from numpy.typing import NDArray

INDEX = struct.Struct('<BQHI')  # opcode, length, channel, bytes of entries
ENTRY = np.dtype([('time', '<u8'), ('offset', '<u8')])
LATEST = (1 << 63) - 1  # a time beyond is an error; held here so that differences stay numbers

SILENCE = 5_000_000_000  # Shorter ones are never named. [ns]
MANY_STEPS = 50  # A silence is long if it is so many mean steps.
MOST_KEPT = 1000


@final
@dataclass(slots=True)
class MessageRhythm:
    """
    The steps from message to message, in the order of recording; times in ns.

    `backwards` counts the messages before their predecessor, `worst` is the longest such step,
    `worst_of` and `worst_topic` whose it was, by channel or name. `silences` are (start, end) of
    steps of at least `SILENCE`.
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
        """Take note of the next messages; arrays of shape (n,)."""
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
        """Take note of what follows; `worst_topic` is whose its worst step is, if known."""
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
        """Keep a silence; of very many the first."""
        if len(self.silences) < MOST_KEPT:
            self.silences.append((start, end))

    def find_long_silences(self) -> list[tuple[int, int]]:
        """Return the silences that are long beside the mean other step, longest first. [ns]"""
        if self.first is None or self.last is None or self.count < 3:
            return []
        whole, others = self.last - self.first, self.count - 2
        found = sorted(self.silences, key=lambda silence: silence[0] - silence[1])
        return [
            (start, end)
            for start, end in found
            if (end - start) * others > MANY_STEPS * (whole - (end - start))
        ]


def iterate_index_entries(region: bytes) -> Iterator[tuple[int, NDArray[np.void]]]:
    """
    Yield channel and entries of the message indexes in a stretch of a file.

    Parameters
    ----------
    region : bytes
        The records behind a chunk; what is no whole message index ends them.

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
    """Return times and channels of a chunk's messages as they lie in it; arrays of shape (n,)."""
    found = list(iterate_index_entries(region))
    if not found:
        return np.empty(0, np.uint64), np.empty(0, np.uint16)
    listed = np.concatenate([listed for _, listed in found])
    channels = np.repeat(
        np.array([channel for channel, _ in found], np.uint16), [len(some) for _, some in found]
    )
    order = np.argsort(listed['offset'], kind='stable')
    return listed['time'][order], channels[order]
