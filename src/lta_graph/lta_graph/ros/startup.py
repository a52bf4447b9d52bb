"""Wait for a graph to come up, before a flight or a replay begins."""

from collections.abc import Callable, Sequence
import time

from lta_config.errors import BadInput
from lta_graph.health import HealthLevel
from lta_graph.ros.node import GraphNode
from lta_graph.ros.reader_links import ReaderLinks

LOOK = 0.02  # wall seconds between two looks
SETTLED = 1.0  # wall seconds without a newcomer after which a flight begins in real time


def wait_until_complete(
    node: GraphNode, list_missing: Callable[[], Sequence[str]], patience: float
) -> None:
    """
    Wait until nobody is missing.

    Parameters
    ----------
    node : GraphNode
        Who waits, as long as it runs.
    lonely : callable
        Returns whom it still waits for.
    patience : float
        Wall time. [s]

    Raises
    ------
    BadInput
        If somebody is still missing then.

    """
    deadline = time.monotonic() + patience
    while node.running and (missing := list_missing()):
        if time.monotonic() > deadline:
            raise BadInput(
                f'After {patience:g} s the {node.get_name()} still waits for '
                f'{", ".join(missing)}; start them, or see "lta doctor" on discovery between '
                'processes.'
            )
        time.sleep(LOOK)


def wait_until_settled(node: GraphNode, patience: float) -> None:
    """
    Wait until the graph has stayed as it is for a while, and all hear each other.

    A node that tells nothing of its readers, a user's own, is waited for in vain: then the flight
    begins, and says in `start` whom it may not reach.

    Parameters
    ----------
    node : GraphNode
        Who waits, as long as it runs.
    patience : float
        Wall time. [s]

    """
    deadline = time.monotonic() + patience
    seen, since = count_endpoints(node), time.monotonic()
    with ReaderLinks(node, node.table) as links:
        while node.running and time.monotonic() - since < SETTLED:
            time.sleep(LOOK)
            loose, now = links.find_unready_topics(node.count_readers()), count_endpoints(node)
            if time.monotonic() > deadline:
                words = f'begun before all readers of {", ".join(loose)} were found'
                node.health.report('start', HealthLevel.WARN, words)
                return
            if loose or now != seen:
                seen, since = now, time.monotonic()


def count_endpoints(node: GraphNode) -> list[tuple[int, int]]:
    """Return how many publish and how many read each topic of the table."""
    return [(node.count_publishers(n), node.count_subscribers(n)) for n in node.table.topics]
