"""Pair the messages of two topics that carry the same stamps."""

from collections.abc import Iterator, Sequence
from typing import Any, final

from lta_graph.ros.stamps import from_stamp

OLDEST_NS = 250_000_000  # ns; a partner whose stamp differs by more does not stand in


@final
class MessagePairing:
    """
    Pairs of messages with equal stamps, over successive steps.

    In real time a partner may come a step earlier or never; then the last one stands in for a
    while.
    """

    def __init__(self) -> None:
        self._waiting: dict[int, Any] = {}
        self._last: Any = None

    def pair_messages(
        self, messages: Sequence[Any], partners: Sequence[Any]
    ) -> Iterator[tuple[Any, Any]]:
        """Yield each message with its partner; None before the first partner, or if it is old."""
        self._waiting.update({from_stamp(each.header.stamp): each for each in partners})
        for message in messages:
            stamp = from_stamp(message.header.stamp)
            self._last = self._waiting.pop(stamp, self._last)
            yield message, None if self._is_old(stamp) else self._last
        if messages:
            newest = from_stamp(messages[-1].header.stamp)
            self._waiting = {at: each for at, each in self._waiting.items() if at > newest}

    def _is_old(self, stamp_ns: int) -> bool:
        """Return whether the last partner is too old to stand in."""
        return (
            self._last is not None
            and abs(from_stamp(self._last.header.stamp) - stamp_ns) > OLDEST_NS
        )
