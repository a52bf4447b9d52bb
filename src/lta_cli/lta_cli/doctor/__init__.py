# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Check that LTA can run on this machine: the core of `lta doctor`.

Each check is a function that returns a `HardwareCheck`. Checks run in the order of
`MACHINE_CHECKS`, the most fundamental first, and are read-only.
"""

from collections.abc import Callable, Iterable, Iterator

from lta_bridge.hardware.check_result import HardwareCheck, State
from lta_cli.doctor.dds import check_message_exchange, check_ports
from lta_cli.doctor.machine import (
    check_available_memory,
    check_disk_space,
    check_platform,
    check_processor_cores,
    check_python_version,
)
from lta_cli.doctor.software import (
    check_browser,
    check_cache_folder,
    check_dependency_imports,
    check_dependency_versions,
    check_workspace_packages,
)
from lta_cli.without_ros import is_wheel_without_graph, WITHOUT_GRAPH
from rich.console import Console
from rich.table import Table
from rich.text import Text

MACHINE_CHECKS: dict[str, Callable[[], HardwareCheck]] = {
    # Later checks depend on earlier ones, so the first failure is the cause to fix
    'python': check_python_version,
    'platform': check_platform,
    'wheels': check_dependency_imports,
    'versions': check_dependency_versions,
    'packages': check_workspace_packages,
    'cache': check_cache_folder,
    'dds': check_message_exchange,
    'ports': check_ports,
    'disk': check_disk_space,
    'cores': check_processor_cores,
    'memory': check_available_memory,
    'browser': check_browser,
}
OF_GRAPH = ('packages', 'dds', 'ports')
STATE_COLOURS: dict[State, str] = {'ok': 'green', 'warn': 'yellow', 'fail': 'bold red'}

__all__ = [
    'CHECKS',
    'HardwareCheck',
    'State',
    'exit_status',
    'iterate_check_results',
    'print_checks',
    'run_checks',
]


def iterate_check_results() -> Iterator[HardwareCheck]:
    """Run the checks that apply here and yield each result as soon as it is available."""
    without_graph = is_wheel_without_graph()
    if without_graph:
        yield HardwareCheck('graph', 'ok', f'not part of this installation: {WITHOUT_GRAPH}')
    for name, check in MACHINE_CHECKS.items():
        if without_graph and name in OF_GRAPH:
            continue
        try:
            yield check()
        except Exception as error:  # a defect in one check must not hide the others
            text = f'this check ended with an error: {type(error).__name__}: {error}'
            yield HardwareCheck(
                name, 'fail', text, 'This is a bug in LTA; please report this line.'
            )


def run_checks() -> list[HardwareCheck]:
    """Return the results of all checks."""
    return list(iterate_check_results())


def exit_status(results: Iterable[HardwareCheck]) -> int:
    """Return 1 if a check failed, else 0; warnings are not failures."""
    return int(any(check.state == 'fail' for check in results))


def print_checks(results: Iterable[HardwareCheck], console: Console) -> None:
    """Print one row for each result, with the remedy below a problem."""
    table = Table.grid(padding=(0, 2))
    for check in results:
        colour = STATE_COLOURS[check.state]
        table.add_row(Text(check.state, colour), Text(check.name), Text(check.found))
        if check.remedy:
            table.add_row('', '', Text(check.remedy, colour))
    console.print(table)
