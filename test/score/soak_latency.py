"""
How long a step takes through a graph in lockstep, by the times at which its nodes wrote.

DDS sends with each message when it was written: whoever looks on may get it late, and out of turn.
"""

from collections.abc import Sequence
import time
from typing import Final

from lta_bridge.log_time_assigner import read_stamp
from lta_config.topics import load_topic_table
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.qos import select_profile
from lta_graph.ros.temporary_node import join_graph
import numpy as np
from numpy.typing import NDArray
from rclpy.subscription import Subscription

TABLE: Final = load_topic_table()
ENDS: Final = ('imu', 'motors')  # of a step
NAP: Final = 0.001  # s


def latency(seconds: float) -> NDArray[np.float64]:
    """
    Look on for a while [s], and return how long each step took.

    The result has shape (steps,) [s].
    """
    with join_graph('onlooker', '/lta1') as (node, _):
        readers = []
        for name in ENDS:
            row = TABLE[name]
            kind, quality = find_message_type(row), select_profile(row, lockstep=True)
            readers.append(node.create_subscription(kind, name, taken_by_hand, quality, raw=True))
        return timed(readers, seconds)


def taken_by_hand(data: bytes) -> None:
    """Never called: nobody spins."""


def timed(readers: Sequence[Subscription], seconds: float) -> NDArray[np.float64]:
    """Return how long each step took [s] that the readers of the two ends hear in a while. [s]"""
    began, until = time.time_ns(), time.monotonic() + seconds
    written: dict[str, dict[int, int]] = {name: {} for name in ENDS}
    while time.monotonic() < until:
        found = 0
        for reader, name in zip(readers, ENDS, strict=True):
            while (taken := reader.handle.take_message(reader.msg_type, True)) is not None:
                data, about = taken
                written[name][read_stamp(data) or 0] = about['source_timestamp']
                found += 1
        if not found:
            time.sleep(NAP)
    first, last = (written[name] for name in ENDS)
    both = [k for k in last if k in first and first[k] >= began]
    return np.array([1e-9 * (last[k] - first[k]) for k in both])
