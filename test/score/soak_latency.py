"""How long a step takes through a graph in lockstep, as an onlooker sees it."""

import struct
import time
from typing import Final, Self

from lta_config.topics import topic_table
from lta_graph.ros.command_line import join
from lta_graph.ros.message_types import message_type
from lta_graph.ros.qos import profile
import numpy as np
from numpy.typing import NDArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

TABLE: Final = topic_table()
ENDS: Final = ('imu', 'motors')  # of a step
STAMP: Final = struct.Struct('<iI')  # of a header, behind the four bytes that tell the encoding
NAP: Final = 0.001  # s


def stamp_of(data: bytes) -> int:
    """Return the stamp of a message that begins with a header. [ns]"""
    seconds, nanoseconds = STAMP.unpack_from(data, 4)
    return int(seconds) * 1_000_000_000 + int(nanoseconds)


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
        self._came: dict[str, dict[int, float]] = {name: {} for name in ENDS}
        for name in ENDS:
            hear = lambda data, name=name: self._hear(name, data)  # noqa: E731
            row = TABLE[name]
            self._node.create_subscription(
                message_type(row), name, hear, profile(row, lockstep=True), raw=True
            )
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the graph."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def _hear(self, name: str, data: bytes) -> None:
        self._came[name].setdefault(stamp_of(data), time.monotonic())

    def during(self, seconds: float) -> NDArray[np.float64]:
        """
        Return how long each step took in a while.

        Returns
        -------
        ndarray, shape (steps,)
            [s]

        """
        until = time.monotonic() + seconds
        handles = [(item.handle, item.callback) for item in self._node.subscriptions]
        kinds = [item.msg_type for item in self._node.subscriptions]
        caught_up = 0.0
        while (now := time.monotonic()) < until:
            found = 0
            for (handle, callback), kind in zip(handles, kinds, strict=True):
                while (taken := handle.take_message(kind, True)) is not None:
                    callback(taken[0])
                    found += 1
            if not found:
                caught_up = caught_up or now  # what was kept for us has come at once
                time.sleep(NAP)
        first, last = (self._came[name] for name in ENDS)
        return np.array(
            [last[k] - first[k] for k in last if k in first and first[k] > caught_up > 0.0]
        )
