# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Run one node or several in a process, by rclpy's `EventsExecutor`: the `main` of executables.

A node's `run` is a generator, so that it can wait without stopping the others. A node that raises
an exception ends, as a process of its own would; the others go on or are stopped, as the launch
file says.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, ExitStack, suppress
from dataclasses import dataclass
import faulthandler
import gc
import inspect
import os
import signal
import sys
import threading
import time
import traceback
from typing import Final, final, NoReturn

from lta_config.errors import BadInput
from lta_config.limits import describe_shortage
from lta_graph.health import ENDS_RUN, HealthLevel
from lta_graph.interrupts import catch_stops
from lta_graph.ros.command_line import initialize_ros, reject_unknown_parameters
from lta_graph.ros.contained_node import ContainedNode
from lta_graph.ros.node import GraphNode
from lta_graph.terminal_streams import exit_process, guard_streams
from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.utilities import get_default_context, try_shutdown

POLL: Final = 0.02  # wall seconds between two steps of a node's `run`
TEARDOWN: Final = 5.0  # s for DDS to shut down; less than the launcher's grace
ANSWERS: Final = 10  # nodes that answer each other's last messages in turn when the run ends
HELP_OPTIONS: Final = ('-h', '--help')


def asks_for_help(words: Sequence[str]) -> bool:
    """Return whether a command line asks for help, before or after `--ros-args`."""
    return any(word in HELP_OPTIONS for word in words[1:])


def describe_node(node_class: type[GraphNode], program: str) -> str:
    """Return the help of a node: its task, and where its parameters and topics are listed."""
    task = inspect.cleandoc(sys.modules[node_class.__module__].__doc__ or node_class.__doc__ or '')
    return (
        f'Usage: {program} --ros-args [-p PARAMETER:=VALUE] [-r FROM:=TO] ...\n\n{task}\n\n'
        'docs/parameters.md lists the parameters, docs/topics.md the topics.\n'
    )


def run_node(node_class: type[GraphNode], args: list[str] | None = None) -> NoReturn:
    """Run one node, or print its help, and exit the process as `run_process` does."""
    words = sys.argv if args is None else args
    if asks_for_help(words):
        sys.stdout.write(describe_node(node_class, words[0]))
        exit_process(0)
    start = NodeStart(node_class, words)
    run_process(lambda teardown: run_nodes([start], words, teardown))


def run_process(run: Callable[[ExitStack], int]) -> NoReturn:
    """
    Run something with nodes and exit the process.

    Parameters
    ----------
    run : callable
        Runs until a stop signal and returns the exit status; what it adds to the stack is undone
        after its result has been reported.

    The exit status is 0 after a shutdown, 2 with one sentence after bad input, 128 + its number
    after a stop signal before the node exists (130 after Ctrl-C), and 1 with a traceback after a
    crash.

    """
    guard_streams()
    teardown = ExitStack()
    teardown.callback(try_shutdown)
    try:
        # The launcher and `lta run` block SIGINT while Python starts; one is delivered here
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        status = run(teardown)
    except KeyboardInterrupt:  # before the node was made
        # The convention of shells for a process ended by a signal
        status = 128 + signal.SIGINT
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        status = 2
    except Exception as error:
        if (shortage := describe_shortage(error)) is None:
            traceback.print_exc()
        else:
            sys.stderr.write(f'{shortage}\n')
        status = 1 if shortage is None else 2
    # After the report of the result, which must not be lost if DDS hangs
    limit = _limit_teardown(status)
    teardown.close()
    limit.cancel()
    exit_process(status)


@final
@dataclass(frozen=True, slots=True)
class NodeStart:
    """How to create a node, and what its end means."""

    create: Callable[[], GraphNode]
    words: Sequence[str]  # its command line
    name: str = ''  # how the process names it where it runs several
    ends_run: bool = True  # whether its end ends the others
    planned: bool = True  # whether its end, without a failure, is the planned end of the run


def run_nodes(starts: Sequence[NodeStart], words: Sequence[str], teardown: ExitStack) -> int:
    """
    Initialise ROS, and run nodes until one of them or a stop signal ends the run.

    Parameters
    ----------
    starts : sequence of NodeStart
        The nodes.
    words : sequence of str
        The command line for ROS.
    teardown : ExitStack
        Destroys the nodes after the caller has reported the result.

    Returns
    -------
    int
        The exit status: 0, 1 if a node has ended the run unplanned, or 128 + the number of a stop
        signal that came before all nodes existed.

    Raises
    ------
    Exception
        Why the first node has rejected its input, or the crash of a node that is alone, once all
        are closed.

    """
    held: list[int] = []
    # A C extension may swallow an exception, and the node would run on. So stop signals are only
    # recorded here, and take effect once the nodes can close
    catch_stops(lambda number, _: held.append(number))
    initialize_ros(words)
    with open_executor(get_default_context()) as executor:
        group = NodeGroup(executor)
        try:
            for start in starts:
                group.create_node(start, teardown)
                if held:  # while the node was created
                    return 128 + held[0]
            catch_stops(lambda *_: group.stop())
            if held:
                return 128 + held[0]
            group.run()
        finally:
            group.close_all()
    if group.error is not None:
        raise group.error
    return group.status


@final
class NodeGroup:
    """
    The nodes of one process.

    `executor` runs their callbacks.

    Attributes
    ----------
    status : int
        1 once a node has ended the run unplanned, or the status with which it has exited.
    error : Exception or None
        Why the first node has rejected its input, or the crash of a node that is alone.

    """

    def __init__(self, executor: Executor) -> None:
        self.status = 0
        self.error: Exception | None = None
        self._executor = executor
        # The steps of each node's `run`
        self._running: dict[GraphNode, tuple[NodeStart, Iterator[None]]] = {}
        self._stopping = False

    def create_node(self, start: NodeStart, teardown: ExitStack) -> None:
        """Create a node."""
        node = start.create()
        teardown.callback(node.destroy_node)
        self._running[node] = start, node.run()
        reject_unknown_parameters(node, start.words)

    def stop(self) -> None:
        """Ask all nodes to end; for the second time to skip, for example, a landing."""
        for node in self._running:
            node.hurried = not node.running
            node.running = False
        self._stopping = True

    def run(self) -> None:
        """Run all nodes until they have ended."""
        for node in self._running:
            self._executor.add_node(node)
        # What start-up has left is not searched for garbage again and again
        gc.freeze()
        while self._running:
            for node in list(self._running):
                self._advance(node)
            try:
                spin_for(self._executor, self._running)
            except Exception as error:
                # Outside of any callback, so that no single node is at fault
                for node in list(self._running):
                    self._fail(node, error)

    def _advance(self, node: GraphNode) -> None:
        """Let a node take a step; close it at its end."""
        try:
            if node.fault is not None:
                raise node.fault
            next(self._running[node][1])
        except StopIteration:
            self._end(node)
        except SystemExit as request:
            self.status = self.status or int(request.code or 0)
            self._end(node)
        except Exception as error:
            self._fail(node, error)

    def _end(self, node: GraphNode) -> None:
        """Close a node that has ended, and stop the others if it ends the run."""
        start, _ = self._running[node]
        ends_run = start.ends_run and not self._stopping
        if ends_run:
            # All answers to its last messages belong to the run
            for _ in range(ANSWERS):
                finish_waiting_events(self._executor, self._running)
            if not start.planned:
                sys.stderr.write(f'{start.name} ended, which ends the run.\n')
                self.status = 1
        self._close(node)
        if ends_run:
            self.stop()

    def _fail(self, node: GraphNode, error: Exception) -> None:
        """Report and close a node that has raised an exception."""
        start, _ = self._running[node]
        is_crash = not isinstance(error, BadInput)
        why = describe_crash(error) if is_crash else str(error)
        # The sentence of bad input is all that a process of one node says
        if is_crash or start.name:
            # Before `close`, which may take a landing; the recorder stores it
            shared = {ENDS_RUN: start.ends_run} if start.name else {}
            node.health.report('state', HealthLevel.ERROR, why, **shared)
            node.publish_health()
        if start.name and is_crash:
            # At once: the others may take longer to close than the process has
            traceback.print_exception(error)
            self.status = 1 if start.ends_run else self.status
        elif start.ends_run:
            self.error = self.error or error
        if start.name and not start.ends_run:
            sys.stderr.write(f'{start.name} ended ({why}); the others continue.\n')
        elif start.name and is_crash:
            sys.stderr.write(f'{start.name} {why}\n')
        self._close(node)
        if start.ends_run and not self._stopping:
            self.stop()

    def _close(self, node: GraphNode) -> None:
        """Close a node, which gets no further messages."""
        del self._running[node]
        self._executor.remove_node(node)
        try:
            node.close()
        except BadInput as error:
            self.error = self.error or error
        except Exception:
            traceback.print_exc()
            self.status = 1

    def close_all(self) -> None:
        """Close the nodes that remain after a failed start."""
        for node in list(self._running):
            self._close(node)


@contextmanager
def open_executor(context: Context) -> Iterator[Executor]:
    """Yield an executor, and shut it down: one that is destroyed before aborts the process."""
    executor = EventsExecutor(context=context)
    try:
        yield executor
    finally:
        executor.shutdown()


def spin_for(executor: Executor, nodes: Collection[ContainedNode], duration: float = POLL) -> None:
    """
    Run the callbacks of nodes for a while, or until one of them has failed [wall s].

    Time limits of the executor itself do not hold while events are waiting (rclpy 7.1.5), so each
    is run by itself.
    """
    end = time.monotonic() + duration
    while (left := end - time.monotonic()) > 0.0 and all(node.fault is None for node in nodes):
        _run_event(executor, left)


def finish_waiting_events(executor: Executor, nodes: Collection[ContainedNode]) -> None:
    """Run the callbacks of all events that wait now, unless a node fails."""
    # Events are served in their order, and a task is one of them
    task = executor.create_task(lambda: None)
    while not task.done() and all(node.fault is None for node in nodes):
        _run_event(executor, POLL)


def _run_event(executor: Executor, patience: float) -> None:
    """Run the callback of the next event, if one comes in time [wall s]."""
    # A callback may destroy a subscription of which another event waits, such as that of a
    # publisher with another quality of service. rclpy 7.1.5 raises this then; the event is gone
    with suppress(rclpy_implementation.InvalidHandle):
        executor.spin_once(patience)


def describe_crash(error: Exception) -> str:
    """Return what the health of a node says about an exception that has ended it."""
    return f'broke: {type(error).__name__}: {error}'.removesuffix(': ')


def _limit_teardown(status: int) -> threading.Timer:
    """
    Start a timer that exits the process if shutting down DDS hangs.

    A demodulator once hung there after a successful flight until the launcher killed it. The
    stacks of all threads on stderr show where.
    """

    def give_up() -> None:
        sys.stderr.write(f'DDS did not shut down within {TEARDOWN:g} s; the node exits anyway.\n')
        faulthandler.dump_traceback(sys.stderr, all_threads=True)
        sys.stdout.flush()
        os._exit(status)

    timer = threading.Timer(TEARDOWN, give_up)
    # Must not keep the process alive itself
    timer.daemon = True
    timer.start()
    return timer
