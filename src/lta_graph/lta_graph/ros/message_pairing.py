"""Pair the messages of two topics that carry the same stamps."""

from collections.abc import Iterator, Sequence
from typing import Any, final

from lta_graph.ros.stamps import from_stamp


@final
class MessagePairing:
    """
    Pairs of messages with equal stamps, over successive steps.

    In real time a partner may come a step earlier or never; then the last one stands in.
    """

    def __init__(self) -> None:
        self._waiting: dict[int, Any] = {}
        self._last: Any = None

    def pair_messages(
        self, messages: Sequence[Any], partners: Sequence[Any]
    ) -> Iterator[tuple[Any, Any]]:
        """Yield each message with its partner; None before the first partner."""
        self._waiting.update({from_stamp(each.header.stamp): each for each in partners})
        for message in messages:
            stamp = from_stamp(message.header.stamp)
            self._last = self._waiting.pop(stamp, self._last)
            yield message, self._last
        if messages:
            newest = from_stamp(messages[-1].header.stamp)
            self._waiting = {at: each for at, each in self._waiting.items() if at > newest}
