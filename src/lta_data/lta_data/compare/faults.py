"""What is wrong with the messages of a topic: gaps, duplicates, time that runs backwards."""

from dataclasses import dataclass
from typing import Final, final, NamedTuple

from lta_data.compare.sampling import Array, GAP
import numpy as np

RHYTHM: Final = 3.0  # ratio of the quartiles of the steps of a topic that still has a rhythm
SLOWER: Final = 1.02  # ratio of two periods that count as different
LISTED: Final = 50  # intervals that are kept; all are counted


class FaultInterval(NamedTuple):
    """From one instant to another. [s]"""

    begin: float
    end: float


@final
@dataclass(frozen=True, slots=True)
class TopicFaults:
    """
    What is wrong with one topic of one flight.

    Attributes
    ----------
    count : int
        Messages.
    period : float or None
        Usual time between them; None where there are fewer than two. [s]
    rhythm : bool
        Whether they come evenly enough for a gap to mean something.
    gaps : tuple of Interval
        Without a message for longer than 2.5 periods; the first 50.
    missing : float
        Length of all gaps together. [s]
    gap_count : int
        How many gaps there are.
    same_stamp : int
        Messages with the time of an earlier one.
    repeated : int
        Of these, those that are the message before once more, byte for byte.
    backwards : tuple of Interval
        Where time falls: from the later time to the earlier one that follows it; the first 50.
    backwards_count : int
        How often it does.
    unknown : dict of str to float
        Share of values that are no finite numbers, by channel, where there are any.

    """

    count: int
    period: float | None
    rhythm: bool
    gaps: tuple[FaultInterval, ...]
    missing: float
    gap_count: int
    same_stamp: int
    repeated: int
    backwards: tuple[FaultInterval, ...]
    backwards_count: int
    unknown: dict[str, float]

    @property
    def is_clean(self) -> bool:
        """Whether nothing is wrong."""
        found = self.gap_count + self.same_stamp + self.backwards_count
        return found == 0 and not self.unknown


def find_topic_faults(
    time: Array, unknown: dict[str, float] | None = None, repeated: int = 0, gap: float = GAP
) -> TopicFaults:
    """
    Return what is wrong with the times of a topic's messages.

    Parameters
    ----------
    time : ndarray, shape (n,)
        In the order of recording. [s]
    unknown : dict of str to float, optional
        Shares of unknown values by channel.
    repeated : int
        Messages that are the one before once more, byte for byte, at the same time.
    gap : float
        Periods without a message that make a gap.

    """
    steps = np.diff(time)
    falls = np.flatnonzero(steps < 0.0)
    instants = np.unique(time)
    rising = np.diff(instants)
    usual = float(np.median(rising)) if len(rising) else None
    short, long = np.percentile(rising, [25.0, 75.0]) if len(rising) else (1.0, 1.0)
    rhythm = bool(long <= RHYTHM * short)
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
        same_stamp=len(time) - len(instants),
        repeated=repeated,
        backwards=tuple(FaultInterval(float(time[k]), float(time[k + 1])) for k in falls[:LISTED]),
        backwards_count=len(falls),
        unknown={name: share for name, share in (unknown or {}).items() if share > 0.0},
    )
