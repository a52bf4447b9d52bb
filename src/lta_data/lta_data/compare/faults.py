"""Find faults in the timing of a topic: gaps, duplicates, and time that runs backwards."""

from dataclasses import dataclass
from typing import Final, final, NamedTuple

from lta_data.compare.sampling import Array, GAP
import numpy as np

RHYTHM: Final = 3.0  # largest quartile ratio of the periods of a regular topic
SLOWER: Final = 1.02  # ratio of two periods from which rates count as different
LISTED: Final = 50  # intervals that are stored; all are counted


class FaultInterval(NamedTuple):
    """An interval of time. [s]"""

    begin: float
    end: float


@final
@dataclass(frozen=True, slots=True)
class TopicFaults:
    """The faults of one topic of one flight."""

    count: int  # messages
    period: float | None  # median period; None for fewer than two messages [s]
    rhythm: bool  # whether messages come regularly enough to define a gap
    gaps: tuple[FaultInterval, ...]  # without a message for longer than 2.5 periods; the first 50
    missing: float  # total length of the gaps [s]
    gap_count: int  # number of gaps
    same_stamp: int  # messages with the time of an earlier one
    repeated: int  # of these, those with the same bytes as the previous message
    # Where time decreases: from the later time to the earlier one that follows; the first 50
    backwards: tuple[FaultInterval, ...]
    backwards_count: int  # number of decreases
    unknown: dict[str, float]  # share of non-finite values, by channel, if any

    @property
    def is_clean(self) -> bool:
        """Whether there is no fault."""
        count = self.gap_count + self.same_stamp + self.backwards_count
        return count == 0 and not self.unknown


def find_topic_faults(
    time: Array, unknown: dict[str, float] | None = None, repeated: int = 0, gap: float = GAP
) -> TopicFaults:
    """
    Find the faults in the times of a topic's messages.

    Parameters
    ----------
    time : ndarray, shape (n,)
        In the order of recording. [s]
    unknown : dict of str to float, optional
        Shares of unknown values by channel.
    repeated : int
        Messages that repeat the previous one byte for byte, at the same time.
    gap : float
        Length of a gap in periods.

    """
    steps = np.diff(time)
    falls = np.flatnonzero(steps < 0.0)
    # Sorted and without duplicates, so that these do not count as gaps as well
    instants = np.unique(time)
    rising = np.diff(instants)
    usual = float(np.median(rising)) if len(rising) else None
    # Quartiles ignore single gaps.
    short, long = np.percentile(rising, [25.0, 75.0]) if len(rising) else (1.0, 1.0)
    rhythm = bool(long <= RHYTHM * short)
    # Irregular topics, such as events, have no gaps.
    limit = gap * usual if usual is not None and rhythm else np.inf
    holes = np.flatnonzero(rising > limit)
    return TopicFaults(
        count=len(time),
        period=usual,
        rhythm=rhythm,
        gaps=tuple(
            FaultInterval(float(instants[k]), float(instants[k + 1])) for k in holes[:LISTED]
        ),
        missing=float(sum(rising[k] for k in holes)),
        gap_count=len(holes),
        # Messages beyond the first of each stamp
        same_stamp=len(time) - len(instants),
        repeated=repeated,
        backwards=tuple(FaultInterval(float(time[k]), float(time[k + 1])) for k in falls[:LISTED]),
        backwards_count=len(falls),
        unknown={name: share for name, share in (unknown or {}).items() if share > 0.0},
    )
