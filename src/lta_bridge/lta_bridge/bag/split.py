"""When the next file of a bag begins."""

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True, slots=True)
class SplitLimits:
    """
    When the next file of a bag begins.

    Attributes
    ----------
    size : int
        Once this much has gone to the disk; a file grows beyond it by one chunk at most. 0 is
        never. [bytes]
    duration_ns : int
        Once a message is this much later than the first of the file, by log time. 0 is never. [ns]

    """

    size: int = 0
    duration_ns: int = 0

    def is_exceeded(self, size: int, age_ns: int) -> bool:
        """Tell whether a file of a size [bytes] and an age [ns] is full."""
        return 0 < self.size <= size or 0 < self.duration_ns <= age_ns


WHOLE = SplitLimits()
