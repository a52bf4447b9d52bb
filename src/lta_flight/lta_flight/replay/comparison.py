# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compare the outputs of a replay with the recording, bit by bit and channel by channel.

With a bag from the same machine and versions every bit must agree. Elsewhere libm and the vector
units of numpy differ in the last places. So numbers may differ by 1e-9 of a channel's largest
value, and by one step of single precision in a channel that is sent in it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final, NamedTuple

from lta_bag.reader import Bag
from lta_config.topics import Topic
from lta_data.bag.columns import extract_field_columns, extract_stamp, LAMP_PEAKS, stack_points
import numpy as np
from numpy.typing import NDArray


@final
class TopicMessages(NamedTuple):
    """The messages of one topic."""

    keys: NDArray[np.int64]  # identifies each message: its stamp, or its log time, shape (n,) [ns]
    # Columns by field path, shape (n,)
    numbers: Mapping[str, NDArray[Any]]
    texts: Mapping[str, NDArray[Any]]

    def select_rows(self, rows: NDArray[np.int64]) -> 'TopicMessages':
        """Return some of the messages."""
        return TopicMessages(
            self.keys[rows],
            {path: column[rows] for path, column in self.numbers.items()},
            {path: column[rows] for path, column in self.texts.items()},
        )


def read_topic(bag: Bag, name: str, row: Topic) -> TopicMessages:
    """
    Read a topic of a bag.

    `bag`: the recording. `name`: absolute name; a missing topic has no messages. `row`: its row of
    the table.
    """
    if name not in bag.topics:
        return TopicMessages(np.empty(0, np.int64), {}, {})
    keys: list[int] = []
    messages = []
    for _, log_time, data in bag.iterate_messages([name]):
        message = bag.decode(name, data)
        # The stamp survives a replay, the log time does not
        stamp = extract_stamp(message) if row.stamped else None
        keys.append(log_time if stamp is None else stamp)
        messages.append(message)
    numbers, texts = extract_field_columns(messages)
    if bag.topics[name].type_name == LAMP_PEAKS:
        numbers |= {
            f'{field}[{k}]': column
            for field, table in stack_points(messages).items()
            for k, column in enumerate(table.T)
        }
    topic_content = TopicMessages(np.array(keys, np.int64), numbers, texts)
    if not row.stamped:
        return topic_content.select_rows(np.argsort(topic_content.keys, kind='stable'))
    # Sort by stamp and drop repeated messages
    _, first = np.unique(topic_content.keys, return_index=True)
    return topic_content.select_rows(first)


def pair_messages(
    recorded: TopicMessages, again: TopicMessages, stamped: bool
) -> tuple[TopicMessages, TopicMessages]:
    """
    Return the corresponding messages of two runs, in the same order.

    Messages without a stamp are paired by order if both runs have the same number, else by log
    time.
    """
    if not stamped and len(recorded.keys) == len(again.keys):
        return recorded, again
    _, here, there = np.intersect1d(recorded.keys, again.keys, return_indices=True)
    return recorded.select_rows(here), again.select_rows(there)


TOLERANCE = 1e-9  # of a channel's largest value
SINGLE = 2.0**-23  # a step of single precision
PLACE_ENTRIES = ('platform', 'libraries', 'commit')  # provenance that may change the last bits


@final
@dataclass(frozen=True, slots=True)
class ChannelDifference:
    """One field that differs."""

    path: str  # the field
    count: int  # number of messages in which it differs
    first: int  # row of the first of them
    largest: float  # largest difference, in the field's unit; NaN for text
    # Both values at the first difference
    recorded: object
    again: object
    close: bool  # whether it agrees within the tolerance for a bag from elsewhere


@final
@dataclass(frozen=True, slots=True)
class TopicComparison:
    """The comparison of one topic."""

    topic: str  # relative name
    # The paired messages, row by row
    recorded: TopicMessages
    again: TopicMessages
    differing: int  # number of messages that differ in any field
    # Messages of the recording, and of the replay, without a counterpart
    unmatched: tuple[int, int]
    # The fields that differ, in the order of their first difference
    channels: tuple[ChannelDifference, ...]

    @property
    def count(self) -> int:
        """Return the number of message pairs."""
        return len(self.recorded.keys)

    @property
    def is_close(self) -> bool:
        """Whether all fields agree within the tolerance for a bag from elsewhere."""
        return all(channel.close for channel in self.channels)


def compare_topic(
    topic: str, recorded: TopicMessages, again: TopicMessages, stamped: bool
) -> TopicComparison:
    """
    Compare one topic of two runs.

    `topic`: relative name. `recorded`, `again`: all messages of the recording and of the replay.
    `stamped`: whether messages are paired by stamp.
    """
    a, b = pair_messages(recorded, again, stamped)
    unmatched = len(recorded.keys) - len(a.keys), len(again.keys) - len(b.keys)
    wrong = np.zeros(len(a.keys), dtype=bool)
    channels = []
    # A field that only one run has differs in every row
    for first, second, empty in ((a.numbers, b.numbers, np.nan), (a.texts, b.texts, '')):
        for path in dict.fromkeys((*first, *second)):
            x, y = (
                each[path] if path in each else np.full(len(a.keys), empty)
                for each in (first, second)
            )
            differs = find_differences(x, y)
            if differs.any():
                wrong |= differs
                channels.append(compare_channel(path, x, y, differs))
    channels.sort(key=lambda each: each.first)
    return TopicComparison(topic, a, b, int(wrong.sum()), unmatched, tuple(channels))


def find_differences(x: NDArray[Any], y: NDArray[Any]) -> NDArray[np.bool_]:
    """Return where two columns, shape (n,), differ in any bit; all NaN are equal."""
    if x.dtype.kind == 'f' and y.dtype.kind == 'f':
        # Compare the bits, so that 0.0 and -0.0 differ
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
        # A NaN in one run only is an infinite difference
        largest = float(np.max(np.where(np.isnan(gaps), np.inf, gaps)))
        close = 'f' in x.dtype.kind + y.dtype.kind and largest <= channel_tolerance(u, v)
    count = int(differs.sum())
    return ChannelDifference(
        path, count, first, float(largest), x[first].item(), y[first].item(), close
    )


def channel_tolerance(x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    """Return the tolerance of a channel between machines, in its unit."""
    both = np.concatenate((x, y))
    both = both[np.isfinite(both)]
    if not both.size:
        return 0.0
    with np.errstate(over='ignore'):
        # All values are exact in single precision, so the channel is sent in it
        single = bool((both.astype(np.float32).astype(np.float64) == both).all())
    return max(TOLERANCE, SINGLE if single else 0.0) * float(np.abs(both).max())


def find_origin_differences(provenance: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """Return the provenance entries in which a recording and this machine differ."""
    return [name for name in PLACE_ENTRIES if provenance.get(name) != here.get(name)]
