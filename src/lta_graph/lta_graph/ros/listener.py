"""Hear /diagnostics from outside the graph: for progress bars and for naming faults."""

from collections.abc import Iterable
import time
from types import TracebackType
from typing import final, Self

from diagnostic_msgs.msg import DiagnosticArray
from lta_config.topics import topic_table
from lta_graph.health import Fact, Level
from lta_graph.ros.qos import profile
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

SILENCE = 0.85  # wall seconds after which a node that reports twice as often is missed


@final
class DiagnosticsListener:
    """Collect the newest fact of every task: `with DiagnosticsListener() as listener: ...`."""

    def __init__(self) -> None:
        self.facts: dict[str, Fact] = {}
        self._heard: dict[str, float] = {}
        self._context = Context()

    def __enter__(self) -> Self:
        """Join the graph."""
        options = SignalHandlerOptions.NO
        rclpy.init(context=self._context, signal_handler_options=options)
        self._node = Node(
            'lta_listener',
            context=self._context,
            enable_rosout=False,
            start_parameter_services=False,
        )
        topic = topic_table()['/diagnostics']
        self._node.create_subscription(
            DiagnosticArray, '/diagnostics', self._hear, profile(topic, lockstep=False)
        )
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave the graph."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            values = {item.key: item.value for item in status.values}
            level = Level(int.from_bytes(status.level, 'little'))
            self.facts[status.name] = Fact(status.name, level, status.message, values)
            self._heard[status.name.partition(':')[0]] = time.monotonic()

    def poll(self, timeout: float) -> dict[str, Fact]:
        """Listen for a while and return the newest fact of each 'NODE: TASK'."""
        self._executor.spin_once(timeout_sec=timeout)
        return self.facts

    def silent(self, nodes: Iterable[str]) -> list[str]:
        """Return which of some nodes were heard once and no longer are, in alphabetical order."""
        limit = time.monotonic() - SILENCE
        return sorted(name for name in nodes if self._heard.get(name, limit) < limit)

    def hears(self, nodes: Iterable[str]) -> bool:
        """Tell whether all of some nodes have been heard: DDS may take seconds to find them."""
        return self._heard.keys() >= set(nodes)
