"""Convert between integer nanoseconds and ROS stamps."""

from builtin_interfaces.msg import Time
from lta_graph.blank_message import create_message


def to_stamp(stamp_ns: int) -> Time:
    """Return integer nanoseconds as a ROS stamp."""
    stamp = create_message(Time)
    stamp.sec, stamp.nanosec = divmod(stamp_ns, 1_000_000_000)
    return stamp


def from_stamp(stamp: Time) -> int:
    """Return a ROS stamp as integer nanoseconds."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
