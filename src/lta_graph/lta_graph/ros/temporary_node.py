"""Join a running graph with a temporary node."""

from collections.abc import Iterator
from contextlib import contextmanager

from lta_graph.ros.command_line import initialize_ros
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


@contextmanager
def join_graph(name: str, namespace: str = '') -> Iterator[tuple[Node, SingleThreadedExecutor]]:
    """
    Yield a node without a role and its executor, in a separate context; leave at the end.

    `name`: name of the node. `namespace`: namespace of a robot, so that relative names are its
    topics.
    """
    context = Context()
    initialize_ros([], context)
    node = Node(
        name,
        namespace=namespace,
        context=context,
        # Fewer endpoints, so that discovery of the node takes less time
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
