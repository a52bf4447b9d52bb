"""Wait until all nodes of a graph are ready, before a flight or a replay begins."""

from collections.abc import Callable, Collection, Iterator, Sequence
import os
import time

from lta_config.errors import BadInput
from lta_graph.health import HealthLevel
from lta_graph.reach import RANGE_VARIABLE
from lta_graph.ros.node import GraphNode
from lta_graph.ros.reader_links import ReaderLinks

SETTLED_TIME = 1.0  # wall seconds without a new endpoint after which a real-time flight begins


def wait_until_complete(
    node: GraphNode, list_missing: Callable[[], Sequence[str]], patience: float
) -> Iterator[None]:
    """
    Wait, in steps of the node's `run`, until no subscriber is missing.

    `node`: the waiting node; a stop signal ends the wait. `list_missing`: returns the names of
    those missing. `patience`: longest wait in wall time [s]. Raise `BadInput` if some are still
    missing then.
    """
    deadline = time.monotonic() + patience
    while node.running and (missing := list_missing()):
        if time.monotonic() > deadline:
            remedy = 'start them, or check discovery with "lta doctor"'
            if os.environ.get(RANGE_VARIABLE) == 'OFF':
                remedy = f'{RANGE_VARIABLE} is OFF, so no node finds another: unset it'
            raise BadInput(
                f'The node {node.get_name()} has waited {patience:g} s for these nodes: '
                f'{", ".join(missing)}; {remedy}.'
            )
        yield


def wait_until_settled(
    node: GraphNode, awaited: Collection[str], patience: float
) -> Iterator[None]:
    """
    Wait until the graph has not changed for `SETTLED`, and the known endpoints have matched.

    After `patience` the flight begins anyway, and warns in the task `start` which topics may not
    reach all readers.

    `node`: the waiting node; a stop signal ends the wait. `awaited`: roles that must report their
    readers. A user's own node does not, and is not waited for. `patience`: longest wait in wall
    time [s].
    """
    deadline = time.monotonic() + patience
    # Endpoints of a drone that still starts keep appearing; a stable number means all are there
    seen, since = count_endpoints(node), time.monotonic()
    with ReaderLinks(node, node.table) as links:
        while node.running and time.monotonic() - since < SETTLED_TIME:
            yield
            loose = links.find_unready_topics(node.count_readers(), awaited)
            now = count_endpoints(node)
            if time.monotonic() > deadline:
                words = (
                    f'begun before all subscribers of {", ".join(loose)} were found; the first '
                    'messages may be lost'
                )
                node.health.report('start', HealthLevel.WARN, words)
                return
            # Any change starts the quiet time again
            if loose or now != seen:
                seen, since = now, time.monotonic()


def count_endpoints(node: GraphNode) -> list[tuple[int, int]]:
    """Return the numbers of publishers and subscribers of each topic in the table."""
    return [(node.count_publishers(n), node.count_subscribers(n)) for n in node.table.topics]
