"""The messages of one topic as columns, and their pairing between two runs."""

from collections.abc import Mapping
from typing import Any, final, NamedTuple

from lta_config.topics import Topic
from lta_data.bag.columns import extract_field_columns, extract_stamp, LAMP_PEAKS, stack_points
from lta_data.bag.reader import Bag
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
