"""
Run several nodes in one process, with one loop and messages handed over in memory.

Every node keeps its own rclpy node. The loop calls the readers of the queue in the order of
publication; between two rounds it looks for timers and messages of other processes, and more
rarely for services and actions. A node's `run` is a generator, so that it can wait without
stopping the others.

A node that raises an exception ends, as a process of its own would; the others go on or are
stopped, as the launch file says.
"""

from collections.abc import Callable, Generator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
import gc
from importlib import import_module
from importlib.metadata import distribution, PackageNotFoundError
import sys
import time
import traceback
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_graph.health import ENDS_RUN, HealthLevel
from lta_graph.interrupts import catch_stops
from lta_graph.launch_file import load_plan, ONE, parse_arguments
from lta_graph.launch_node import LaunchProcess
from lta_graph.ros.command_line import initialize_ros, reject_unknown_parameters
from lta_graph.ros.help.node_help import asks_for_help
from lta_graph.ros.node import GraphNode
from lta_graph.ros.process import describe_crash, run_process
from lta_graph.ros.shared.hand_over import HandOver, place_node, ServiceFault
from lta_graph.ros.spin import (
    count_entities,
    list_actions,
    OFTEN,
    Pause,
    RARELY,
    Spin,
    WAIT_NS,
    WatchfulExecutor,
)
from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.utilities import get_default_context

ROUND = 0.02  # wall seconds of handing over after which the loop looks at the middleware
BATCH = 20  # messages handed over between two looks at the clock
LOOK = 0.05  # wall seconds between two looks for services, the longest sleep of the loop
LAST = 2.0  # wall seconds for the messages under way when the run ends


@final
@dataclass(slots=True, eq=False)
class RunningNode:
    """A node of the process and where it is in its phases."""

    node: GraphNode
    process: LaunchProcess
    phases: Generator[Spin | Pause]
    phase: Spin | Pause
    since: float = 0.0  # begin of a pause, or last check of a phase [s]

    def is_in_phase(self, now: float) -> bool:
        """Return whether the present phase goes on."""
        if isinstance(self.phase, Pause):
            return now - self.since < self.phase.duration
        # A phase may count its checks, which its own process makes after each sleep
        if self.phase.wait_ns < WAIT_NS and now - self.since < 1e-9 * self.phase.wait_ns:
            return True
        self.since = now
        return self.phase.running()


USAGE = """Usage: ros2 run lta_graph one_process FILE [NAME:=VALUE] ...

Run the nodes of a launch file that share a process, such as one_process fly seed:=2. The arguments
are those of the launch file: ros2 launch lta_config fly.launch.yaml --show-args.
"""


def main() -> None:
    """Run the nodes of a launch file that share a process, or say how to."""
    if asks_for_help(sys.argv):
        sys.stdout.write(USAGE)
        sys.exit(0)
    run_process(partial(run_launch_file, sys.argv))


def run_launch_file(words: Sequence[str], teardown: ExitStack) -> int:
    """
    Run the nodes of a launch file as `run_nodes` does.

    `words`: program, launch file and its arguments. `teardown`: as for `run_nodes`. Raise
    `BadInput` if there is no such file, or it starts no node that can share a process.
    """
    program, *arguments = words
    if not arguments:
        raise BadInput('Give a launch file, such as fly, and its arguments as NAME:=VALUE.')
    path = find_file('launch file', arguments[0], '.launch.yaml')
    plan = load_plan(path, {**parse_arguments(arguments[1:]), 'processes': ONE})
    shared = [process for process in plan.processes if process.shared]
    if not shared:
        raise BadInput(f'{path} starts no node that can share a process; use lta launch.')
    return run_nodes(shared, program, teardown)


def load_node_class(process: LaunchProcess) -> type[GraphNode]:
    """
    Return the class of a node from the package and the executable that would start it.

    Raise `BadInput` if it is not a node of LTA.
    """
    try:
        points = distribution(process.package).entry_points
        (point,) = points.select(group='console_scripts', name=process.executable)
        module = import_module(point.module)
        (node_class,) = [
            item
            for item in vars(module).values()
            if isinstance(item, type)
            and issubclass(item, GraphNode)
            and item.__module__ == module.__name__
        ]
    except (PackageNotFoundError, ValueError):
        raise BadInput(
            f'{process.package}/{process.executable} is not a node of LTA that can share a '
            'process; remove processes:=one.'
        ) from None
    return node_class


def run_nodes(
    processes: Sequence[LaunchProcess],
    program: str,
    teardown: ExitStack,
) -> int:
    """
    Run nodes in this process until one of them or a stop signal ends the run.

    Parameters
    ----------
    processes : sequence of LaunchProcess
        The nodes, as processes that would run them.
    program : str
        Name of the program, for ROS.
    teardown : ExitStack
        Destroys the nodes after the caller has reported the result.

    Returns
    -------
    int
        The exit status: 0, 1 if a node has failed, or 128 + the number of a stop signal that came
        before all nodes existed.

    Raises
    ------
    BadInput
        If a node rejects its input.

    """
    held: list[int] = []
    catch_stops(lambda number, _: held.append(number))
    initialize_ros([program])
    group = NodeGroup(HandOver(), get_default_context())
    try:
        for process in processes:
            group.create_node(process, teardown)
            if held:
                return 128 + held[0]
        catch_stops(lambda *_: group.stop())
        if held:
            return 128 + held[0]
        group.run()
    finally:
        group.close_all()
    if group.refusal is not None:
        raise group.refusal
    return group.status


@final
class NodeGroup:
    """
    The nodes of one process.

    Parameters
    ----------
    hand_over : HandOver
        The messages under way between them.
    context : Context
        The ROS context that they share.

    Attributes
    ----------
    status : int
        1 once a node has failed.
    refusal : BadInput or None
        Why the first node has rejected its input.

    """

    def __init__(self, hand_over: HandOver, context: Context) -> None:
        self.status = 0
        self.refusal: BadInput | None = None
        self._hand_over = hand_over
        self._context = context
        self._running: dict[Node, RunningNode] = {}
        self._executor = WatchfulExecutor(context=context)
        self._stopping = False
        self._looked = self._served = 0.0

    def create_node(self, process: LaunchProcess, teardown: ExitStack) -> None:
        """Create a node with the command line of a process."""
        kind = load_node_class(process)
        words = [process.executable, *process.arguments]
        with place_node(self._hand_over, process.arguments):
            node = kind()  # type: ignore[call-arg]
        teardown.callback(node.destroy_node)
        self._running[node] = RunningNode(node, process, node.run(), Pause(0.0))
        reject_unknown_parameters(node, words)

    def stop(self) -> None:
        """Ask all nodes to end; for the second time, to hurry."""
        for each in self._running.values():
            each.node.hurried = not each.node.running
            each.node.running = False
        self._stopping = True

    def run(self) -> None:
        """Run all nodes until they have ended."""
        for each in self._running.values():
            robot = each.node.get_namespace()
            nodes = [other.node for other in self._running.values()]
            each.node.keep_for_late_readers(
                {node.role for node in nodes if node.get_namespace() == robot}
            )
            self._executor.add_node(each.node)
        # What start-up has left is not searched for garbage again and again
        gc.freeze()
        with self._context.handle:
            while self._running:
                for each in list(self._running.values()):
                    self._advance(each)
                self._deliver(ROUND)
                self._poll()

    def _advance(self, each: RunningNode) -> None:
        """Enter the next phase of a node if the present one is over; close the node at its end."""
        now = time.monotonic()
        try:
            while not each.is_in_phase(now):
                each.phase = next(each.phases)
                each.since = now
                self._executor.stale = True
        except StopIteration:
            self._end(each)
        except SystemExit as request:
            self.status = self.status or int(request.code or 0)
            self._end(each)
        except Exception as error:
            self._fail(each, error)

    def _end(self, each: RunningNode) -> None:
        """Close a node that has ended, and stop the others if it ends the run."""
        ends_run = each.process.on_exit_shutdown and not self._stopping
        if ends_run:
            # All answers to its last messages belong to the run
            self._deliver(LAST)
            if not each.process.planned:
                sys.stderr.write(f'{each.process.name} ended, which ends the run.\n')
                self.status = 1
        self._close(each)
        if ends_run:
            self.stop()

    def _fail(self, each: RunningNode, error: Exception) -> None:
        """Report and close a node that has raised an exception."""
        ends_run = each.process.on_exit_shutdown
        if isinstance(error, BadInput):
            why = str(error)
        else:
            traceback.print_exception(error)
            why = describe_crash(error)
        each.node.health.report('state', HealthLevel.ERROR, why, **{ENDS_RUN: ends_run})
        each.node.publish_health()
        if ends_run and isinstance(error, BadInput):
            self.refusal = self.refusal or error
        elif ends_run:
            self.status = 1
            sys.stderr.write(f'{each.process.name} {why}\n')
        else:
            sys.stderr.write(f'{each.process.name} ended ({why}); the others continue.\n')
        self._close(each)
        if ends_run and not self._stopping:
            self.stop()

    def _close(self, each: RunningNode) -> None:
        """Close a node and drop the messages that wait for it."""
        node = each.node
        del self._running[node]
        self._executor.stale = True
        self._executor.remove_node(node)
        try:
            each.phases.close()
            node.close()
        except BadInput as error:
            self.refusal = self.refusal or error
        except Exception:
            traceback.print_exc()
            self.status = 1
        for subscription in list(node.subscriptions):
            self._hand_over.remove_reader(subscription)

    def close_all(self) -> None:
        """Close the nodes that remain after a failed start."""
        for each in list(self._running.values()):
            self._close(each)
        self._executor.shutdown()

    def _deliver(self, duration: float) -> None:
        """Hand messages over until none is under way, or for a while. [s]"""
        queue = self._hand_over.queue
        deadline = time.monotonic() + duration
        left = BATCH
        while queue:
            reader, message = queue.popleft()
            try:
                reader.callback(message)
            except Exception as error:
                self._fail_node(reader.node, error)
            left -= 1
            if not left:
                left = BATCH
                if time.monotonic() > deadline:
                    return

    def _collect_entities(self) -> None:
        """Look up the entities of all nodes, which takes long, and make the wait sets."""
        self._executor.stale = False
        nodes = [each.node for each in self._running.values() if isinstance(each.phase, Spin)]
        self._readers = {
            item.handle.pointer: (node, item.handle, item.callback)
            for node in nodes
            for item in node.subscriptions
        }
        self._timers = [
            (node, timer.handle, timer.callback) for node in nodes for timer in node.timers
        ]
        self._services = [item.handle for node in nodes for item in node.services]
        self._clients = [item.handle for node in nodes for item in node.clients]
        self._actions = [item for node in nodes for item in list_actions(node)]
        handle = self._context.handle
        self._inputs = _rclpy.WaitSet(len(self._readers), 0, len(self._timers), 0, 0, 0, handle)
        size: tuple[int, ...] = (0, 0, 0, len(self._clients), len(self._services), 0)
        for action in self._actions:
            size = tuple(map(sum, zip(size, count_entities(action), strict=True)))
        self._requests = _rclpy.WaitSet(*size, handle)

    def _poll(self) -> None:
        """Look for messages of other processes, timers and services; sleep if nothing is due."""
        if not self._running:
            return
        if self._executor.stale:
            self._collect_entities()
        self._hand_over.rounds += 1
        now = time.monotonic()
        busy = bool(self._hand_over.queue)
        # Until the end of a pause, or the next check of a phase
        waits = [
            (each.phase.duration if isinstance(each.phase, Pause) else 1e-9 * each.phase.wait_ns)
            - (now - each.since)
            for each in self._running.values()
        ]
        sleep = 0.0 if busy else max(0.0, min([LOOK, *waits]))
        inputs = self._inputs
        inputs.clear_entities()
        for _, handle, _ in self._readers.values():
            inputs.add_subscription(handle)
        for _, timer, _ in self._timers:
            inputs.add_timer(timer)
        if not self._timers:  # all nodes pause, and nothing can wake them
            time.sleep(sleep)
            return
        inputs.wait(int(1e9 * sleep))
        for pointer in inputs.get_ready_entities('subscription'):
            node, handle, callback = self._readers[pointer]
            if self._executor.stale:  # an earlier callback may have destroyed what comes next
                return
            self._call(node, partial(self._take_all, handle, callback))
        for node, timer, tick in self._timers:
            if not self._executor.stale and timer.is_timer_ready():
                timer.call_timer()
                self._call(node, tick)
        self._serve()

    def _take_all(self, handle: Any, callback: Callable[[bytes], None]) -> None:  # noqa: ANN401
        """Take all messages that wait in a subscription, whose own callback may destroy it."""
        while not self._executor.stale and (taken := handle.take_message(None, True)) is not None:
            callback(taken[0])

    def _call(self, node: GraphNode, callback: Callable[[], object]) -> None:
        if node not in self._running:
            return  # closed by an earlier callback of this round
        try:
            callback()
        except Exception as error:
            self._fail_node(node, error)

    def _fail_node(self, node: Node, error: Exception) -> None:
        if (each := self._running.get(node)) is not None:
            self._fail(each, error)

    def _serve(self) -> None:
        """Serve services, actions and what else only rclpy's executor serves, when it is time."""
        now = time.monotonic()
        if now - self._looked < LOOK:
            return
        self._looked = now
        late = now - self._served > (OFTEN if self._actions else RARELY)
        if late or self._is_requested():
            self._served = now
            try:
                self._executor.spin_once(timeout_sec=0.0)  # serves one request
            except ServiceFault as fault:
                self._fail_node(fault.node, fault.error)
            # At once for the next, while there are some
            self._looked = 0.0 if self._is_requested() else now

    def _is_requested(self) -> bool:
        """Return whether a service, a client or an action has something to do."""
        if self._executor.stale:
            return False
        requests = self._requests
        requests.clear_entities()
        for service in self._services:
            requests.add_service(service)
        for client in self._clients:
            requests.add_client(client)
        for action in self._actions:
            action.add_to_wait_set(requests)
        requests.wait(0)
        return (
            bool(requests.get_ready_entities('service'))
            or bool(requests.get_ready_entities('client'))
            or any(action.is_ready(requests) for action in self._actions)
        )
