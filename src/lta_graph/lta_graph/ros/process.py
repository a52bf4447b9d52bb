"""One node as a process: the `main` of every executable, and every way out of it."""

from contextlib import ExitStack
import faulthandler
import os
import signal
import sys
import threading
import traceback
from typing import Final, NoReturn

from lta_config.errors import BadInput
from lta_graph.health import HealthLevel
from lta_graph.interrupts import STOPS
from lta_graph.process_end import exit_process
from lta_graph.ros.command_line import initialize_ros, reject_unknown_parameters
from lta_graph.ros.node import GraphNode
import rclpy

TEARDOWN: Final = 5.0  # s for DDS to shut down; less than the launcher's grace


def run_node(node_class: type[GraphNode], args: list[str] | None = None) -> NoReturn:
    """
    Run one node as a process, and end that.

    Exit status 0 after a shut-down, 2 with one sentence on bad input, 130 after Ctrl-C before the
    node was made, 1 after a crash with its traceback.
    """
    words = sys.argv if args is None else args
    status = 0
    teardown = ExitStack()
    teardown.callback(rclpy.try_shutdown)
    try:
        # `lta run` holds Ctrl-C back while Python starts; one that came meanwhile comes now.
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        run_until_stopped(node_class, words, teardown)
    except KeyboardInterrupt:  # before the node was made
        status = 128 + signal.SIGINT
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        status = 2
    except Exception:
        traceback.print_exc()
        status = 1
    limit = _limit_teardown(status)
    teardown.close()
    limit.cancel()
    exit_process(status)


def run_until_stopped(node_class: type[GraphNode], words: list[str], teardown: ExitStack) -> None:
    """
    Join the graph, make a node, let it work until it should stop, and close it in any case.

    The node is destroyed by `teardown`, after the caller has reported how it ended.
    """
    held: list[int] = []
    # A C extension may drop a KeyboardInterrupt raised within it, and the node would run on:
    # a Ctrl-C is only noted here, and acts once the node can close.
    signal.signal(signal.SIGINT, lambda number, _: held.append(number))
    initialize_ros(words)
    node = node_class()  # type: ignore[call-arg]

    def stop(*_: object) -> None:
        node.hurried = not node.running
        node.running = False

    try:
        reject_unknown_parameters(node, words)
        for number in STOPS:
            if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:  # by nohup
                signal.signal(number, stop)
        if held:
            raise KeyboardInterrupt
        node.run()
    except BadInput:
        raise
    except Exception as error:
        # Leaving in order may take a landing; and who records must hear why.
        words = f'broke: {type(error).__name__}: {error}'.removesuffix(': ')
        node.health.report('state', HealthLevel.ERROR, words)
        node.publish_health()
        raise
    finally:
        try:
            node.close()
        finally:
            teardown.callback(node.destroy_node)


def _limit_teardown(status: int) -> threading.Timer:
    """
    Start a timer that ends the process with its status if shutting down DDS hangs.

    A demodulator once hung there after a flight that had reached its goal, until the launcher
    killed it. The stacks of all threads on stderr show where it hung.
    """

    def give_up() -> None:
        sys.stderr.write(f'DDS did not shut down within {TEARDOWN:g} s; the node exits anyway.\n')
        faulthandler.dump_traceback(sys.stderr, all_threads=True)
        sys.stdout.flush()
        os._exit(status)

    timer = threading.Timer(TEARDOWN, give_up)
    timer.daemon = True
    timer.start()
    return timer
