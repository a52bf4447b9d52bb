# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The viewer processes of a graph, without which a flight continues."""

from collections.abc import Callable

from lta_bridge.live.origin_gate import build_app_url, check_port_available, LIVE_PORT, LOCAL
from lta_config.command_line import relative_path
from lta_config.errors import BadInput
from lta_config.files import share_folder
from lta_graph.launch_plan import LaunchPlan, LaunchProcess

LIVE = ('lta_bridge', 'live')
DESCRIPTION_PROGRAM = ('lta_bridge', 'description')
LAYOUT_FILE = 'foxglove/lta.json'  # in the folder of LTA's own data


def _is_live_view(process: LaunchProcess) -> bool:
    return (process.package, process.executable) == LIVE


def _list_live_views(plan: LaunchPlan) -> list[tuple[LaunchProcess, object, object]]:
    """Return the live views with host and port, except those configured by a file."""
    views: list[tuple[LaunchProcess, object, object]] = []
    for process in filter(_is_live_view, plan.processes):
        parameters = process.parameters
        # A parameter file may set another port, which is not known here
        if 'port' in parameters or not process.parameter_file:
            views.append(
                (process, parameters.get('host', LOCAL), parameters.get('port', LIVE_PORT))
            )
    return views


def find_viewers(plan: LaunchPlan) -> frozenset[str]:
    """Return the labels of the processes that only serve viewers."""
    return frozenset(
        plan.label(process)
        for process in plan.processes
        if (process.package, process.executable) in (LIVE, DESCRIPTION_PROGRAM)
    )


def require_free_live_ports(plan: LaunchPlan) -> None:
    """
    Reject a live view that cannot listen.

    Raise `BadInput` if its port is invalid, in use or that of another view, or the address is not
    local.
    """
    seen: set[object] = set()
    for _, host, port in _list_live_views(plan):
        if port in seen:
            raise BadInput(f'Two live views were given port {port}; give each a port of its own.')
        seen.add(port)
        if not (type(port) is int and 1 <= port <= 65535):
            raise BadInput(
                f'The port of the live view is {port}, but must be a whole number from 1 to 65535.'
            )
        check_port_available(str(host), port)


def report_live_views(plan: LaunchPlan, say: Callable[[str], None]) -> None:
    """Print the addresses of live views, if the plan has any."""
    views = _list_live_views(plan)
    for process, _, port in views:
        # The port was checked by `require_free_live_ports`
        url = build_app_url(int(str(port)))
        whose = f'{process.namespace.strip("/")}; ' if len(views) > 1 else ''
        say(
            f'Live view: {url}  ({whose}open it in a browser, or with Open connection in Foxglove)'
        )
    if views:
        say(
            f'Layout:    {relative_path(share_folder() / LAYOUT_FILE)}  (import it once '
            f'into Foxglove)'
        )
