"""
Look at the machine and say what keeps LTA from flying: the core of `lta doctor`.

Each check is a function that returns a `Check`; they run in the order of `CHECKS`, what is most
fundamental first, and none of them changes anything.
"""

from collections.abc import Callable, Iterable, Iterator

from lta_bridge.hardware.check_result import Check, State
from lta_cli.doctor.dds import conversation, ports
from lta_cli.doctor.machine import cores, disk, memory, platform, python
from lta_cli.doctor.software import browser, packages, versions, wheels
from rich.console import Console
from rich.table import Table
from rich.text import Text

CHECKS: dict[str, Callable[[], Check]] = {
    'python': python,
    'platform': platform,
    'wheels': wheels,
    'versions': versions,
    'packages': packages,
    'dds': conversation,
    'ports': ports,
    'disk': disk,
    'cores': cores,
    'memory': memory,
    'browser': browser,
}
COLOURS: dict[State, str] = {'ok': 'green', 'warn': 'yellow', 'fail': 'bold red'}

__all__ = ['CHECKS', 'Check', 'State', 'checks', 'run_checks', 'show', 'status']


def checks() -> Iterator[Check]:
    """Yield the result of each check as soon as it is there."""
    for name, check in CHECKS.items():
        try:
            yield check()
        except Exception as error:  # the doctor itself must not fall ill
            found = f'the check itself failed: {type(error).__name__}: {error}'
            yield Check(name, 'fail', found, 'Report this line as a defect of LTA.')


def run_checks() -> list[Check]:
    """Return the results of all checks."""
    return list(checks())


def status(results: Iterable[Check]) -> int:
    """Return the exit status: 0 if nothing failed (warnings are no failure), else 1."""
    return int(any(check.state == 'fail' for check in results))


def show(results: Iterable[Check], console: Console) -> None:
    """Print one row for each result, with the remedy below what is not in order."""
    table = Table.grid(padding=(0, 2))
    for check in results:
        colour = COLOURS[check.state]
        table.add_row(Text(check.state, colour), Text(check.name), Text(check.found))
        if check.remedy:
            table.add_row('', '', Text(check.remedy, colour))
    console.print(table)
