"""Join a running graph from outside it, and leave it again."""

from collections.abc import Iterator
from contextlib import contextmanager

from lta_graph.ros.command_line import initialize_ros
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


@contextmanager
def join_graph(name: str, namespace: str = '') -> Iterator[tuple[Node, SingleThreadedExecutor]]:
    """
    Join the graph as a node of no role, in a context of its own, and leave it.

    Parameters
    ----------
    name : str
        What the node is called.
    namespace : str
        Of a robot, so that relative names are its topics.

    """
    context = Context()
    initialize_ros([], context)
    node = Node(
        name,
        namespace=namespace,
        context=context,
        enable_rosout=False,
        start_parameter_services=False,
    )
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    try:
        yield node, executor
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
