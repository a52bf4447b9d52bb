"""
Look at the machine and say what keeps LTA from flying: the core of `lta doctor`.

Each check is a function that returns a `HardwareCheck`; they run in the order of `CHECKS`, what is
most fundamental first, and none of them changes anything.
"""

from collections.abc import Callable, Iterable, Iterator

from lta_bridge.hardware.check_result import HardwareCheck, State
from lta_cli.doctor.dds import check_conversation, check_ports
from lta_cli.doctor.machine import (
    check_cores,
    check_disk,
    check_memory,
    check_platform,
    check_python,
)
from lta_cli.doctor.software import check_browser, check_packages, check_versions, check_wheels
from rich.console import Console
from rich.table import Table
from rich.text import Text

CHECKS: dict[str, Callable[[], HardwareCheck]] = {
    'python': check_python,
    'platform': check_platform,
    'wheels': check_wheels,
    'versions': check_versions,
    'packages': check_packages,
    'dds': check_conversation,
    'ports': check_ports,
    'disk': check_disk,
    'cores': check_cores,
    'memory': check_memory,
    'browser': check_browser,
}
COLOURS: dict[State, str] = {'ok': 'green', 'warn': 'yellow', 'fail': 'bold red'}

__all__ = [
    'CHECKS',
    'HardwareCheck',
    'State',
    'exit_status',
    'iterate_checks',
    'print_checks',
    'run_checks',
]


def iterate_checks() -> Iterator[HardwareCheck]:
    """Yield the result of each check as soon as it is there."""
    for name, check in CHECKS.items():
        try:
            yield check()
        except Exception as error:  # the doctor itself must not fall ill
            found = f'the check itself failed: {type(error).__name__}: {error}'
            yield HardwareCheck(name, 'fail', found, 'Report this line as a defect of LTA.')


def run_checks() -> list[HardwareCheck]:
    """Return the results of all checks."""
    return list(iterate_checks())


def exit_status(results: Iterable[HardwareCheck]) -> int:
    """Return the exit status: 0 if nothing failed (warnings are no failure), else 1."""
    return int(any(check.state == 'fail' for check in results))


def print_checks(results: Iterable[HardwareCheck], console: Console) -> None:
    """Print one row for each result, with the remedy below what is not in order."""
    table = Table.grid(padding=(0, 2))
    for check in results:
        colour = COLOURS[check.state]
        table.add_row(Text(check.state, colour), Text(check.name), Text(check.found))
        if check.remedy:
            table.add_row('', '', Text(check.remedy, colour))
    console.print(table)
