"""A node that lives only for a listener or a call, and calls of services by type name."""

from collections.abc import Iterator
from contextlib import contextmanager
import time
from typing import Any, Final, NamedTuple

from lta_config.errors import BadInput
from lta_graph.ros.command_line import initialize_ros
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger


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


SERVICE_TYPES: Final = {'std_srvs/srv/SetBool': SetBool, 'std_srvs/srv/Trigger': Trigger}
DISCOVERY_TIME: Final = 5.0  # wall seconds in which DDS finds a service on a busy machine
ANSWER_TIME: Final = 30.0  # wall seconds for the answer, on a busy machine
POLL_PERIOD: Final = 0.05  # wall seconds between polls of the discovered services


class ServiceResponse(NamedTuple):
    """The response of a service."""

    success: bool
    message: str


def call_service(name: str, data: bool | None) -> ServiceResponse:
    """
    Call a service of std_srvs, and return its response.

    `name`: absolute name, '/lta1/emergency_stop'. `data`: for a SetBool; None for a Trigger.
    Raise `BadInput` if the service does not exist, has another type, or does not respond.
    """
    with join_graph('lta_call') as (node, executor):
        kind = find_service_class(node, name)
        # A SetBool without a value, or a Trigger with one
        if (kind is SetBool) is (data is None):
            expected = (
                'needs a value after its name: true or false'
                if kind is SetBool
                else 'takes no value after its name; leave the value out'
            )
            raise BadInput(f"The service '{name}' {expected}.")
        client = node.create_client(kind, name)
        # The name was seen already, but the endpoints still have to match
        client.wait_for_service(DISCOVERY_TIME)
        request = kind.Request() if data is None else kind.Request(data=data)
        future = client.call_async(request)
        executor.spin_until_future_complete(future, ANSWER_TIME)
        if not future.done():
            raise BadInput(
                f"The service '{name}' did not answer within {ANSWER_TIME:.0f} s; check that its "
                'node still runs: a running node publishes its state on /diagnostics.'
            )
        answer = future.result()
        return ServiceResponse(bool(answer.success), str(answer.message))


def find_service_class(node: Node, name: str) -> Any:  # noqa: ANN401 - a generated class
    """Return the class of a service, waiting up to `PATIENCE` for discovery."""
    deadline = time.monotonic() + DISCOVERY_TIME
    while True:
        there = dict(node.get_service_names_and_types())
        kinds = [SERVICE_TYPES[kind] for kind in there.get(name, []) if kind in SERVICE_TYPES]
        if kinds:
            return kinds[0]
        if time.monotonic() > deadline:
            names = sorted(
                one for one, types in there.items() if set(types) & SERVICE_TYPES.keys()
            )
            words = (
                f'available: {", ".join(names)}'
                if names
                else 'none is available, so start the nodes first'
            )
            raise BadInput(f"No node offers the service '{name}'; {words}.")
        time.sleep(POLL_PERIOD)
