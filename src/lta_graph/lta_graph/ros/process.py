"""Run one node as a process, the `main` of every executable, by rclpy's `EventsExecutor`."""

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, ExitStack, suppress
import faulthandler
import inspect
import os
import signal
import sys
import threading
import time
import traceback
from typing import Final, NoReturn

from lta_config.errors import BadInput
from lta_config.limits import describe_shortage
from lta_graph.health import HealthLevel
from lta_graph.interrupts import catch_stops
from lta_graph.ros.command_line import initialize_ros, reject_unknown_parameters
from lta_graph.ros.contained_node import ContainedNode
from lta_graph.ros.node import GraphNode
from lta_graph.terminal_streams import exit_process, guard_streams
from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.utilities import try_shutdown

POLL: Final = 0.02  # wall seconds between two steps of a node's `run`
TEARDOWN: Final = 5.0  # s for DDS to shut down; less than the launcher's grace
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
    run_process(lambda teardown: run_until_stopped(node_class, words, teardown))


def run_process(run: Callable[[ExitStack], int]) -> NoReturn:
    """
    Run one node or several and exit the process.

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


def run_until_stopped(node_class: type[GraphNode], words: list[str], teardown: ExitStack) -> int:
    """
    Initialise ROS, create a node, run it until a stop signal, and close it in any case.

    `teardown` destroys the node after the caller has reported the result. The status is 0, or
    128 + the number of a stop signal that came before the node existed.
    """
    held: list[int] = []
    # A C extension may swallow an exception, and the node would run on. So stop signals are only
    # recorded here, and take effect once the node can close
    catch_stops(lambda number, _: held.append(number))
    initialize_ros(words)
    node = node_class()  # type: ignore[call-arg]

    def stop(*_: object) -> None:
        # A second signal during the shutdown asks to skip, for example, a landing
        node.hurried = not node.running
        node.running = False

    try:
        reject_unknown_parameters(node, words)
        catch_stops(stop)
        if held:  # while the node was created
            return 128 + held[0]
        spin_node(node)
    # Reported by the caller in one sentence; it is not a crash
    except BadInput:
        raise
    except Exception as error:
        # Publish the reason before `close`, which may take a landing; the recorder stores it
        node.health.report('state', HealthLevel.ERROR, describe_crash(error))
        node.publish_health()
        raise
    finally:
        try:
            node.close()
        finally:
            teardown.callback(node.destroy_node)
    return 0


def spin_node(node: GraphNode) -> None:
    """Run a node that has the process for itself, until it ends or a callback raises."""
    with open_executor(node.context) as executor:
        executor.add_node(node)
        for _ in node.run():
            spin_for(executor, [node])
            if node.fault is not None:
                raise node.fault


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
    Run the callbacks of nodes for a while, or until one of them has failed. [wall s]

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
    """Run the callback of the next event, if one comes in time. [wall s]"""
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
