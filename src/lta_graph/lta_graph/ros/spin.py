"""
A fast spin for one node.

rclpy's single-threaded executor rebuilds generators and tasks for every message, and wakes up for
each one even if the node cannot step yet. Here messages are taken straight from their
subscriptions, and only those that can complete a step wake the node up. Timers are called directly
too. A round trip is 1.3 to 2.5 times as fast (`make bench`).

Services, actions and responses to clients are rare and go through rclpy's executor. So does, once
a second, what else it serves, such as warnings of incompatible quality of service. Coroutines are
served only in a node with action servers, every 0.05 s.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
import time
from typing import final

from rclpy.context import Context
from rclpy.event_handler import EventHandler
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.subscription import Subscription
from rclpy.waitable import Waitable

RARELY = 1.0  # s between runs of rclpy's executor, for events that only it serves
OFTEN = 0.05  # the same for the coroutines of action servers
WAIT_NS = 100_000_000  # upper bound of the time to notice that the node should stop


@final
@dataclass(frozen=True, slots=True)
class Spin:
    """A phase of a node in which its callbacks run; the parameters are those of `spin_node`."""

    running: Callable[[], bool]
    awaited: Callable[[], Iterable[Subscription]] = list
    wait_ns: int = WAIT_NS


@final
@dataclass(frozen=True, slots=True)
class Pause:
    """A phase of a node in which its callbacks do not run. [s]"""

    duration: float


def spin_phases(node: Node, phases: Iterable[Spin | Pause]) -> None:
    """Run the phases of a node that has the process for itself."""
    for phase in phases:
        if isinstance(phase, Pause):
            time.sleep(phase.duration)
        else:
            spin_node(node, phase.running, phase.awaited, phase.wait_ns)


@final
class WatchfulExecutor(SingleThreadedExecutor):
    """
    rclpy's executor, which notes that its nodes have added or destroyed entities.

    Attribute `stale`: whether that happened since a loop looked them up, and set it to False.
    Until it looks again, a handle that it keeps may be invalid.
    """

    def __init__(self, *, context: Context) -> None:
        super().__init__(context=context)
        self.stale = True

    def wake(self) -> None:
        """Note the change; rclpy calls this at each one, in whatever callback it happens."""
        self.stale = True
        super().wake()


def list_actions(node: Node) -> list[Waitable]:
    """Return the action servers and clients of a node."""
    # The events of publishers and subscriptions are waitables too. They are rare, and waiting for
    # them costs more than all messages: rclpy's executor serves them (see RARELY)
    return [item for item in node.waitables if not isinstance(item, EventHandler)]


def count_entities(action: Waitable) -> tuple[int, ...]:
    """Return how many entities of each kind an action server adds to a wait set."""
    n = action.get_num_entities()
    return (
        n.num_subscriptions,
        n.num_guard_conditions,
        n.num_timers,
        n.num_clients,
        n.num_services,
        n.num_events,
    )


def spin_node(
    node: Node,
    running: Callable[[], bool],
    awaited: Callable[[], Iterable[Subscription]],
    wait_ns: int = WAIT_NS,
) -> None:
    """
    Run a node's callbacks until `running` returns False.

    `running`: called between callbacks, at least every `wait_ns`. `awaited`: returns the
    subscriptions to wake up for. Each wake-up takes the messages of all subscriptions, of the
    newest first. `wait_ns`: longest sleep [ns].
    """
    context = node.context
    executor = WatchfulExecutor(context=context)
    executor.add_node(node)
    looked = 0.0
    try:
        with context.handle:
            while running():
                if executor.stale:
                    executor.stale = False
                    # Attribute access on the node's entities is slow, so look everything up once
                    timers = [(timer.handle, timer.callback) for timer in node.timers]
                    services = [service.handle for service in node.services]
                    clients = [client.handle for client in node.clients]
                    inputs = [
                        (item.handle, item.callback, item.msg_type, item.raw)
                        for item in node.subscriptions
                    ][::-1]
                    actions = list_actions(node)
                    # Subscriptions, guard conditions, timers, clients, services, events
                    size = (len(inputs), 0, len(timers), len(clients), len(services), 0)
                    for action in actions:
                        size = tuple(map(sum, zip(size, count_entities(action), strict=True)))
                    wait_set = _rclpy.WaitSet(*size, context.handle)
                    pause = OFTEN if actions else RARELY
                # rcl clears what is not ready, so the set is filled anew for each wait
                wait_set.clear_entities()
                for subscription in awaited():
                    wait_set.add_subscription(subscription.handle)
                for timer, _ in timers:
                    wait_set.add_timer(timer)
                for service in services:
                    wait_set.add_service(service)
                for client in clients:
                    wait_set.add_client(client)
                for action in actions:
                    action.add_to_wait_set(wait_set)
                wait_set.wait(wait_ns)
                # A callback may destroy what comes next; what is left stays ready
                for handle, callback, kind, raw in inputs:
                    while (
                        not executor.stale
                        and (taken := handle.take_message(kind, raw)) is not None
                    ):
                        callback(taken[0])
                for timer, tick in timers:
                    if not executor.stale and timer.is_timer_ready():
                        timer.call_timer()
                        tick()
                if executor.stale:
                    continue
                requests = wait_set.get_ready_entities('service')
                responses = wait_set.get_ready_entities('client')
                requested = any(action.is_ready(wait_set) for action in actions)
                late = time.monotonic() - looked > pause
                if requests or responses or requested or late:
                    looked = time.monotonic()
                    executor.spin_once(timeout_sec=0.0)
    finally:
        executor.shutdown()
