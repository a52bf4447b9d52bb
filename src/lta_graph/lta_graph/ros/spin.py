"""
A lean spin for one node.

rclpy's single-threaded executor rebuilds generators and tasks for every message; taking messages
straight from the wait set halves the time of a step through the graph (`make bench`).
Subscriptions are taken here; whatever else is ready goes through rclpy's executor.
"""

from collections.abc import Callable

from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node

WAIT_NS = 100_000_000  # an upper bound of the time to notice that the node should stop


def spin(node: Node, running: Callable[[], bool]) -> None:
    """
    Run a node's callbacks while it should run; entities must not be added meanwhile.

    Parameters
    ----------
    node : Node
        The node.
    running : callable
        Asked between callbacks, at least every `WAIT_NS`.

    """
    context = node.context
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    subscriptions = list(node.subscriptions)
    timers = [timer.handle for timer in node.timers]
    services = [service.handle for service in node.services]
    inputs = [(item.handle, item.callback, item.msg_type, item.raw) for item in subscriptions]
    size = (len(inputs), 0, len(timers), 0, len(services), 0)
    try:
        with context.handle:
            wait_set = _rclpy.WaitSet(*size, context.handle)
            while running():
                wait_set.clear_entities()
                indices = [wait_set.add_subscription(handle) for handle, *_ in inputs]
                for timer in timers:
                    wait_set.add_timer(timer)
                for service in services:
                    wait_set.add_service(service)
                wait_set.wait(WAIT_NS)
                for index, (handle, callback, kind, raw) in zip(indices, inputs, strict=True):
                    if wait_set.is_ready('subscription', index):
                        while (taken := handle.take_message(kind, raw)) is not None:
                            callback(taken[0])
                if wait_set.get_ready_entities('timer') or wait_set.get_ready_entities('service'):
                    executor.spin_once(timeout_sec=0.0)
    finally:
        executor.shutdown()
