"""
Run several nodes in one process, by one executor.

A node's `run` is a generator, so that it can wait without stopping the others. A node that raises
an exception ends, as a process of its own would; the others go on or are stopped, as the launch
file says.
"""

from collections.abc import Iterator, MutableMapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
import gc
from importlib import import_module
from importlib.metadata import distribution, PackageNotFoundError
import os
from pathlib import Path
import sys
from tempfile import TemporaryDirectory
import traceback
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.files import share_folder
from lta_graph.health import ENDS_RUN, HealthLevel
from lta_graph.interrupts import catch_stops
from lta_graph.launch_plan import LaunchProcess, parse_arguments
from lta_graph.launches import find_launch
from lta_graph.reach import PROFILE_VARIABLE
from lta_graph.ros.command_line import initialize_ros, reject_unknown_parameters
from lta_graph.ros.node import GraphNode
from lta_graph.ros.process import (
    asks_for_help,
    describe_crash,
    finish_waiting_events,
    open_executor,
    run_process,
    spin_for,
)
from rclpy.executors import Executor
from rclpy.utilities import get_default_context

DELIVERY: Final = 'intraprocess_delivery'  # element of a profile of Fast DDS
ANSWERS: Final = 10  # nodes that answer each other's last messages in turn when the run ends


@final
@dataclass(slots=True, eq=False)
class RunningNode:
    """A node of the process and the steps of its `run`."""

    node: GraphNode
    process: LaunchProcess
    steps: Iterator[None]


USAGE = """Usage: ros2 run lta_graph one_process FILE [NAME:=VALUE] ...

Run the nodes of a launch file that share a process, such as one_process fly seed:=2. The arguments
are those of the launch file: ros2 launch lta_bringup fly.launch.py --show-args.
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
    launch = find_launch(arguments[0])
    plan = launch.build_plan({**parse_arguments(arguments[1:]), 'processes': 'one'})
    shared = [process for process in plan.processes if process.shared]
    if not shared:
        raise BadInput(f'{launch.name} starts no node that can share a process; use lta launch.')
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
    deliver_in_memory(os.environ, teardown)
    initialize_ros([program])
    with open_executor(get_default_context()) as executor:
        group = NodeGroup(executor)
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


def deliver_in_memory(environment: MutableMapping[str, str], teardown: ExitStack) -> None:
    """
    Let Fast DDS hand messages over within this process, which our profiles switch off.

    There, one of several participants of a process may wait for ever for another. All nodes here
    have one participant. A profile of the user's stays as it is. `teardown` removes the file.
    """
    profile = Path(environment.get(PROFILE_VARIABLE, ''))
    if not profile.is_file() or profile.resolve() not in list_own_profiles():
        return
    # Of the same name, by which `describe_reach` knows it
    folder = Path(teardown.enter_context(TemporaryDirectory(prefix='lta-')))
    text = profile.read_text(encoding='utf-8')
    copy = folder / profile.name
    copy.write_text(text.replace(f'<{DELIVERY}>OFF<', f'<{DELIVERY}>FULL<'), encoding='utf-8')
    environment[PROFILE_VARIABLE] = str(copy)


def list_own_profiles() -> list[Path]:
    """Return the files with our settings of Fast DDS."""
    return [path.resolve() for path in (share_folder() / 'fastdds').glob('*.xml')]


@final
class NodeGroup:
    """
    The nodes of one process.

    `executor` runs their callbacks.

    Attributes
    ----------
    status : int
        1 once a node has failed.
    refusal : BadInput or None
        Why the first node has rejected its input.

    """

    def __init__(self, executor: Executor) -> None:
        self.status = 0
        self.refusal: BadInput | None = None
        self._executor = executor
        self._running: dict[GraphNode, RunningNode] = {}
        self._stopping = False

    def create_node(self, process: LaunchProcess, teardown: ExitStack) -> None:
        """Create a node with the command line of a process."""
        kind = load_node_class(process)
        own = list(process.arguments)
        node = kind(cli_args=own, use_global_arguments=False)  # type: ignore[call-arg]
        teardown.callback(node.destroy_node)
        self._running[node] = RunningNode(node, process, node.run())
        reject_unknown_parameters(node, [process.executable, *process.arguments])

    def stop(self) -> None:
        """Ask all nodes to end; for the second time, to hurry."""
        for each in self._running.values():
            each.node.hurried = not each.node.running
            each.node.running = False
        self._stopping = True

    def run(self) -> None:
        """Run all nodes until they have ended."""
        for node in self._running:
            self._executor.add_node(node)
        # What start-up has left is not searched for garbage again and again
        gc.freeze()
        while self._running:
            for each in list(self._running.values()):
                self._advance(each)
            spin_for(self._executor, self._running)

    def _advance(self, each: RunningNode) -> None:
        """Let a node take a step; close it at its end."""
        try:
            if each.node.fault is not None:
                raise each.node.fault
            next(each.steps)
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
            for _ in range(ANSWERS):
                finish_waiting_events(self._executor, self._running)
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
        """Close a node, which gets no further messages."""
        node = each.node
        del self._running[node]
        self._executor.remove_node(node)
        try:
            node.close()
        except BadInput as error:
            self.refusal = self.refusal or error
        except Exception:
            traceback.print_exc()
            self.status = 1

    def close_all(self) -> None:
        """Close the nodes that remain after a failed start."""
        for each in list(self._running.values()):
            self._close(each)
