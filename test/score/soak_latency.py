"""
How long a step takes through a graph in lockstep, by the times at which its nodes wrote.

DDS sends with each message when it was written: whoever looks on may get it late, and out of turn.
"""

import time
from typing import Final, Self

from lta_bridge.bookkeeping import stamp_of
from lta_config.topics import topic_table
from lta_graph.ros.command_line import join
from lta_graph.ros.message_types import message_type
from lta_graph.ros.qos import profile
import numpy as np
from numpy.typing import NDArray
from rclpy.context import Context
from rclpy.node import Node

TABLE: Final = topic_table()
ENDS: Final = ('imu', 'motors')  # of a step
NAP: Final = 0.001  # s


class Latency:
    """An onlooker: `with Latency() as latency: latency.during(10.0)`."""

    def __enter__(self) -> Self:
        """Join the graph."""
        self._context = Context()
        join([], self._context)
        self._node = Node(
            'onlooker',
            namespace='/lta1',
            context=self._context,
            enable_rosout=False,
            start_parameter_services=False,
        )
        for name in ENDS:
            row = TABLE[name]
            self._node.create_subscription(
                message_type(row), name, print, profile(row, lockstep=True), raw=True
            )
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the graph."""
        self._node.destroy_node()
        self._context.try_shutdown()

    def during(self, seconds: float) -> NDArray[np.float64]:
        """
        Return how long each step took in a while.

        Returns
        -------
        ndarray, shape (steps,)
            [s]

        """
        began, until = time.time_ns(), time.monotonic() + seconds
        written: dict[str, dict[int, int]] = {name: {} for name in ENDS}
        readers = [(each.handle, each.msg_type) for each in self._node.subscriptions]
        while time.monotonic() < until:
            found = 0
            for (handle, kind), name in zip(readers, ENDS, strict=True):
                while (taken := handle.take_message(kind, True)) is not None:
                    data, about = taken
                    written[name][stamp_of(data) or 0] = about['source_timestamp']
                    found += 1
            if not found:
                time.sleep(NAP)
        first, last = (written[name] for name in ENDS)
        both = [k for k in last if k in first and first[k] >= began]
        return np.array([1e-9 * (last[k] - first[k]) for k in both])
