"""One node as a process: the `main` of every executable, and every way out of it."""

import signal
import sys

from lta_config.errors import BadInput
from lta_graph.health import Level
from lta_graph.ros.command_line import join, refuse_unknown
from lta_graph.ros.node import GraphNode
import rclpy


def run(node_class: type[GraphNode], args: list[str] | None = None) -> None:
    """
    Run one node as a process.

    Exit status 0 after a shut-down, 2 with one sentence on bad input, 130 after Ctrl-C before the
    node was made; anything else is a crash with its traceback.
    """
    words = sys.argv if args is None else args
    try:
        # `lta run` holds Ctrl-C back while Python starts; one that came meanwhile comes now.
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        join(words)
        live(node_class, words)
    except KeyboardInterrupt:  # before the handlers were there
        sys.exit(128 + signal.SIGINT)
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        sys.exit(2)
    finally:
        rclpy.try_shutdown()


def live(node_class: type[GraphNode], words: list[str]) -> None:
    """Make a node, let it work until it should stop, and close it whatever happens."""
    node = node_class()  # type: ignore[call-arg]
    try:
        refuse_unknown(node, words)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: setattr(node, 'running', False))
        node.work()
    except BadInput:
        raise
    except Exception as error:
        # Leaving in order may take a landing; and who records must hear why.
        words = f'broke: {type(error).__name__}: {error}'.removesuffix(': ')
        node.health.report('state', Level.ERROR, words)
        node.publish_health()
        raise
    finally:
        try:
            node.close()
        finally:
            node.destroy_node()
