# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Look at a graph from outside: read /diagnostics, publish faults there, and call services."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, ExitStack
import time
from typing import Any, Final, final, NamedTuple, Self

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lta_config.errors import BadInput
from lta_graph.health import HealthFact, HealthLevel
from lta_graph.interrupts import hold_interrupts
from lta_graph.ros.command_line import initialize_ros
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Header
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


def find_service_class(node: Node, name: str) -> Any:
    """Return the class of a service, waiting up to `DISCOVERY_TIME`."""
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


LISTENER_DEPTH = 100  # messages of all nodes together that may wait until the next look
ALL_NODES_TIME = 10.0  # wall s after the first report for DDS to find all nodes of a busy machine
# Wall s for all to report once; compiling the model takes half a minute alone
LOADING_TIME = 300.0
LAUNCHER_TASK = 'launcher: processes'  # task under which the launcher reports faults of its nodes
RECEIPT_TIME = Duration(
    seconds=0.5
)  # for all readers to acknowledge an error; a dead one never does
NODE_SILENCE_TIME = 2.25  # wall s after which a node counts as silent: two reports and some delay


@final
class DiagnosticsListener:
    """
    Collect the newest fact of every task: `with DiagnosticsListener('lta1') as listener: ...`.

    `robots`: namespaces to listen to; /diagnostics is shared by all robots of a domain. Attribute
    `facts`: by 'NODE: TASK', or 'ROBOT/NODE: TASK' with several robots.
    """

    def __init__(self, *robots: str) -> None:
        names = robots or ('lta1',)
        self._robots, self._robot = set(names), names[0]
        # Of one robot, messages name its nodes alone
        self._common = f'{names[0]}/' if len(names) == 1 else ''
        self.facts: dict[str, HealthFact] = {}
        self._stamp = Time()  # of the newest report: the graph's time
        self._received_at: dict[str, float] = {}
        self._begun: float | None = None
        self._complete: float | None = None

    def __enter__(self) -> Self:
        """Join the graph."""
        # If a step fails the node is destroyed; otherwise `__exit__` does that
        with ExitStack() as stack:
            node, self._executor = stack.enter_context(join_graph('lta_listener'))
            self._subscription = node.create_subscription(
                DiagnosticArray, '/diagnostics', self._on_diagnostics, LISTENER_DEPTH
            )
            self._publisher = node.create_publisher(
                DiagnosticArray, '/diagnostics', LISTENER_DEPTH
            )
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the graph."""
        self._stack.close()

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        ours = [status for status in message.status if status.hardware_id in self._robots]
        if ours:
            # Time of the first report of any node; discovery is allowed ALL_NODES_TIME from then
            self._begun = self._begun or time.monotonic()
            self._stamp = message.header.stamp
        for status in ours:
            values = {item.key: item.value for item in status.values}
            # Any node may publish here: an undefined level is capped at the worst one
            level = HealthLevel(min(int.from_bytes(status.level, 'little'), HealthLevel.STALE))
            task = status.name.removeprefix(self._common)
            self.facts[task] = HealthFact(task, level, status.message, values)
            self._received_at[task.partition(':')[0]] = time.monotonic()

    def poll(self, timeout: float) -> dict[str, HealthFact]:
        """Listen for at most `timeout` [s] and return the newest fact of each task."""
        # A Ctrl-C raised within rclpy's C code could get lost
        with hold_interrupts():
            self._executor.spin_once(timeout_sec=timeout)
            # `spin_once` takes one message; take the others that have arrived too
            while (
                taken := self._subscription.handle.take_message(DiagnosticArray, False)
            ) is not None:
                self._on_diagnostics(taken[0])
        return self.facts

    def publish_error(self, sentence: str) -> None:
        """Report a fault of a node at level ERROR, so that the recorder stores it."""
        status = DiagnosticStatus(
            level=DiagnosticStatus.ERROR,
            name=f'{self._robot}/{LAUNCHER_TASK}'.strip('/'),
            message=sentence,
            hardware_id=self._robot,
        )
        header = Header(stamp=self._stamp)
        self._publisher.publish(DiagnosticArray(header=header, status=[status]))

    def wait_until_received(self) -> None:
        """
        Wait until the readers have acknowledged the published errors.

        The recorder closes its bag soon after SIGINT, and would miss an error that is under way.
        """
        self._publisher.wait_for_all_acked(RECEIPT_TIME)

    def find_silent_nodes(self, nodes: Iterable[str], required: bool = True) -> list[str]:
        """
        Return the nodes that no longer report, in alphabetical order.

        While nodes load, nobody is silent: a busy machine may delay the reports of the others.
        `required`: whether a node that never reports is silent in the end.
        """
        nodes = list(nodes)
        if not self._is_settled(nodes):
            return []
        now = time.monotonic()
        begun = self._begun or now
        pending = [] if required else self.find_pending_nodes(nodes)
        return sorted(
            name
            for name in nodes
            # A node that never reported counts as silent only once LOADING_TIME is over
            if now - self._received_at.get(name, begun + LOADING_TIME - NODE_SILENCE_TIME)
            > NODE_SILENCE_TIME
            and name not in pending
        )

    def find_pending_nodes(self, nodes: Iterable[str]) -> list[str]:
        """Return the nodes that have not reported yet: still loading, or not discovered."""
        return sorted(set(nodes) - self._received_at.keys())

    def _is_settled(self, nodes: Iterable[str]) -> bool:
        """
        Return whether silence of a node indicates a fault.

        A running node may get no processor time for a second while others still load. So all given
        nodes must have reported once, and have had time to report again.
        """
        now = time.monotonic()
        # After ALL_NODES_TIME a node that never reported no longer delays the others
        patient = self._begun is not None and now - self._begun > ALL_NODES_TIME
        if self._complete is None and (patient or not self.find_pending_nodes(nodes)):
            self._complete = now
        return self._complete is not None and now - self._complete > NODE_SILENCE_TIME
