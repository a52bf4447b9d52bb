# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert between integer nanoseconds and ROS stamps, and pair messages of equal stamps."""

from collections.abc import Sequence
from typing import Any, final

from builtin_interfaces.msg import Time


def to_stamp(stamp_ns: int) -> Time:
    """Return integer nanoseconds as a ROS stamp."""
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    return Time(sec=seconds, nanosec=nanoseconds)


def from_stamp(stamp: Time) -> int:
    """Return a ROS stamp as integer nanoseconds."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


OLDEST_STAND_IN_NS = 250_000_000  # ns; a partner whose stamp differs by more does not stand in


@final
class MessagePairing:
    """
    Pairs of messages with equal stamps, over successive steps.

    In real time a partner may come a step earlier or never; then the last one stands in for a
    while.
    """

    def __init__(self) -> None:
        self._waiting: dict[tuple[int, int], Any] = {}  # by seconds and nanoseconds
        self._last: Any = None

    def pair_messages(
        self, messages: Sequence[Any], partners: Sequence[Any]
    ) -> list[tuple[int, Any, Any]]:
        """
        Return the stamp [ns] of each message, the message, and its partner.

        The partner is None before the first one, and if it is old.
        """
        for partner in partners:
            at = partner.header.stamp
            self._waiting[at.sec, at.nanosec] = partner
        pairs = []
        for message in messages:
            at = message.header.stamp
            stamp_ns, match = from_stamp(at), self._waiting.pop((at.sec, at.nanosec), None)
            self._last = match or self._last
            pairs.append((stamp_ns, message, match or self._find_stand_in(stamp_ns)))
        if self._waiting and messages:
            newest = at.sec, at.nanosec
            self._waiting = {each: late for each, late in self._waiting.items() if each > newest}
        return pairs

    def _find_stand_in(self, stamp_ns: int) -> Any:
        """Return the last partner, or None if it is too old."""
        if self._last is None:
            return None
        apart = abs(from_stamp(self._last.header.stamp) - stamp_ns)
        return self._last if apart <= OLDEST_STAND_IN_NS else None
