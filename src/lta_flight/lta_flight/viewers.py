"""The processes of a graph that only look: whoever they are, a flight goes on without them."""

from collections.abc import Callable

from lta_bridge.live.address import app_url, LOCAL, PORT, refuse_taken
from lta_config.errors import BadInput
from lta_config.files import share
from lta_config.typed import near
from lta_flight.preflight import FILE_OPTION, parameters
from lta_graph.launch_file import LaunchPlan
from lta_graph.launch_node import Process

LIVE = ('lta_bridge', 'live')
LAYOUT = 'foxglove/lta.json'  # below the folder of LTA's own data


def _looks(process: Process) -> bool:
    return (process.package, process.executable) == LIVE


def _places(plan: LaunchPlan) -> list[tuple[Process, object, object]]:
    """Return the live views with host and port, but those that have theirs in a file."""
    found = []
    for process in filter(_looks, plan.processes):
        given = parameters(process.arguments)
        if 'port' in given or FILE_OPTION not in process.arguments:
            found.append((process, given.get('host', LOCAL), given.get('port', PORT)))
    return found


def viewers(plan: LaunchPlan) -> frozenset[str]:
    """Return what a plan calls the processes that only look."""
    return frozenset(plan.label(process) for process in plan.processes if _looks(process))


def refuse_taken_ports(plan: LaunchPlan) -> None:
    """
    Refuse a live view where nothing could listen.

    Raises
    ------
    BadInput
        If its port is in use, another view's or no port, or its address is none of this
        machine's.

    """
    seen: set[object] = set()
    for _, host, port in _places(plan):
        if port in seen:
            raise BadInput(f'Two live views were given port {port}; give each its own.')
        seen.add(port)
        if not (type(port) is int and 1 <= port <= 65535):
            raise BadInput(
                f'The port of the live view is {port}, but must be a whole number from 1 to 65535.'
            )
        refuse_taken(str(host), port)


def invite(plan: LaunchPlan, say: Callable[[str], None]) -> None:
    """Tell where people can look on; nothing where a plan has no live view."""
    views = _places(plan)
    for process, _, port in views:
        url = app_url(int(str(port)))
        whose = f'{process.namespace.strip("/")}; ' if len(views) > 1 else ''
        say(f'Live   {url}  ({whose}or, in the Foxglove app, Open connection)')
    if views:
        say(f'Layout {near(share() / LAYOUT)}  (import it there once)')
