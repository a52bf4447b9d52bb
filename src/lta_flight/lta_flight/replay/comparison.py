"""
What the nodes answered now against what was recorded: bit by bit, channel by channel.

Where a bag was made on the same machine with the same versions, every bit must agree. Elsewhere
libm and numpy's vector units differ in the last places, so that numbers may differ by 1e-9 of a
channel's largest value; a channel that is sent in single precision by one such step.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from lta_flight.replay.topic_messages import pair_messages, TopicMessages
import numpy as np
from numpy.typing import NDArray

TOLERANCE = 1e-9  # of a channel's largest value
SINGLE = 2.0**-23  # a step of single precision
PLACE = ('platform', 'libraries', 'commit')  # of the origin: the same results to the last bit


@final
@dataclass(frozen=True, slots=True)
class ChannelDifference:
    """
    One field that differs.

    Attributes
    ----------
    path : str
        The field.
    count : int
        Messages in which it differs.
    first : int
        Row of the first of them.
    largest : float
        Largest difference, in the field's unit; NaN for text.
    recorded, again : object
        The two values of the first.
    close : bool
        Whether it agrees within the tolerance for a bag made elsewhere.

    """

    path: str
    count: int
    first: int
    largest: float
    recorded: object
    again: object
    close: bool


@final
@dataclass(frozen=True, slots=True)
class TopicComparison:
    """
    One topic compared.

    Attributes
    ----------
    topic : str
        Relative name.
    recorded, again : Heard
        The messages that belong together, row by row.
    differing : int
        Messages that differ in any field.
    unmatched : tuple of int
        Messages of the recording, and of the replay, without a partner.
    channels : tuple of Channel
        What differs, what differed first in front.

    """

    topic: str
    recorded: TopicMessages
    again: TopicMessages
    differing: int
    unmatched: tuple[int, int]
    channels: tuple[ChannelDifference, ...]

    @property
    def count(self) -> int:
        """Pairs of messages."""
        return len(self.recorded.keys)

    @property
    def is_close(self) -> bool:
        """Whether all agrees within the tolerance for a bag made elsewhere."""
        return all(channel.close for channel in self.channels)


def compare_topic(
    topic: str, recorded: TopicMessages, again: TopicMessages, stamped: bool
) -> TopicComparison:
    """
    Compare one topic of two runs.

    Parameters
    ----------
    topic : str
        Relative name.
    recorded, again : Heard
        All messages of the recording and of the replay.
    stamped : bool
        Whether they belong together by stamp.

    """
    a, b = pair_messages(recorded, again, stamped)
    unmatched = len(recorded.keys) - len(a.keys), len(again.keys) - len(b.keys)
    wrong = np.zeros(len(a.keys), dtype=bool)
    channels = []
    for first, second, empty in ((a.numbers, b.numbers, np.nan), (a.texts, b.texts, '')):
        for path in dict.fromkeys((*first, *second)):
            x, y = (select_column(each, path, len(a.keys), empty) for each in (first, second))
            differs = find_differences(x, y)
            if differs.any():
                wrong |= differs
                channels.append(compare_channel(path, x, y, differs))
    channels.sort(key=lambda each: each.first)
    return TopicComparison(topic, a, b, int(wrong.sum()), unmatched, tuple(channels))


def select_column(
    columns: Mapping[str, NDArray[Any]], path: str, length: int, empty: object
) -> NDArray[Any]:
    """Return a column; one that a run does not have is empty in every row."""
    return columns[path] if path in columns else np.full(length, empty)


def find_differences(x: NDArray[Any], y: NDArray[Any]) -> NDArray[np.bool_]:
    """Return where two columns, shape (n,), differ in any bit; one NaN is as another."""
    if x.dtype.kind == 'f' and y.dtype.kind == 'f':
        bits = x.astype(np.float64).view(np.int64) != y.astype(np.float64).view(np.int64)
        return np.asarray(bits & ~(np.isnan(x) & np.isnan(y)), dtype=bool)
    return np.asarray(x != y, dtype=bool)


def compare_channel(
    path: str, x: NDArray[Any], y: NDArray[Any], differs: NDArray[np.bool_]
) -> ChannelDifference:
    """Return how a field differs."""
    first = int(np.argmax(differs))
    largest, close = np.nan, False
    if {x.dtype.kind, y.dtype.kind} <= set('iufb'):
        u, v = x.astype(np.float64), y.astype(np.float64)
        with np.errstate(invalid='ignore'):
            gaps = np.abs(u - v)[differs]
        largest = float(np.max(np.where(np.isnan(gaps), np.inf, gaps)))
        close = 'f' in x.dtype.kind + y.dtype.kind and largest <= channel_tolerance(u, v)
    count = int(differs.sum())
    return ChannelDifference(
        path, count, first, float(largest), x[first].item(), y[first].item(), close
    )


def channel_tolerance(x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    """Return by how much a channel may differ between machines, in the channel's unit."""
    both = np.concatenate((x, y))
    both = both[np.isfinite(both)]
    if not both.size:
        return 0.0
    with np.errstate(over='ignore'):
        single = bool((both.astype(np.float32).astype(np.float64) == both).all())
    return max(TOLERANCE, SINGLE if single else 0.0) * float(np.abs(both).max())


def find_origin_differences(provenance: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """Return in what a recording's origin differs from here, of what may move the last bit."""
    return [name for name in PLACE if provenance.get(name) != here.get(name)]
