"""Limits at which a bag is split into files."""

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True, slots=True)
class SplitLimits:
    """Limits of one file of a bag; 0 means no limit."""

    size: int = 0  # size on the disk; a file exceeds it by one chunk at most [bytes]
    duration_ns: int = 0  # log time since the first message of the file [ns]

    def is_exceeded(self, size: int, age_ns: int) -> bool:
        """Return whether a file of a size [bytes] and an age [ns] is full."""
        return 0 < self.size <= size or 0 < self.duration_ns <= age_ns


WHOLE = SplitLimits()
