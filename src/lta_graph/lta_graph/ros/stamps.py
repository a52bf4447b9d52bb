"""Convert between integer nanoseconds and ROS stamps."""

from collections.abc import Iterable
import math
from typing import Any

from builtin_interfaces.msg import Time


def to_stamp(stamp_ns: int) -> Time:
    """Return integer nanoseconds as a ROS stamp."""
    return Time(sec=stamp_ns // 1_000_000_000, nanosec=stamp_ns % 1_000_000_000)


def from_stamp(stamp: Time) -> int:
    """Return a ROS stamp as integer nanoseconds."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def find_nearest_message(messages: Iterable[Any], time_ns: int) -> Any:  # noqa: ANN401 - generated classes
    """Return the message whose header stamp is nearest to a time, or None if there is none."""
    nearest, least = None, math.inf
    for message in messages:
        distance = abs(from_stamp(message.header.stamp) - time_ns)
        if distance < least:
            nearest, least = message, distance
    return nearest
