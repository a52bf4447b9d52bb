"""lta hardware check: check connected radios, drones and light boards."""

import sys
from typing import Annotated

from lta_analysis.console import plain_console
from lta_bridge.devices import format_udev_rules, RULES_FILE
from lta_bridge.hardware.check import (
    format_diode_rows,
    format_stream_rows,
    HardwareCheckRequest,
    run_hardware_check,
    to_json,
)
from lta_cli.doctor import exit_status, print_checks
from lta_cli.options.common_options import Json, print_json, VehicleOption
from lta_report.progress_bar import ProgressBar
from lta_vlc.settings import DemodulationSettings
from rich.console import Console
from rich.progress import BarColumn, TextColumn
from rich.table import Table
import typer


def check(
    uri: Annotated[
        str, typer.Option(help='URI of the Crazyflie; by default the first that answers.')
    ] = '',
    port: Annotated[
        str,
        typer.Option(
            help='Port of the light board, or udp://HOST:PORT; by default the first found.'
        ),
    ] = '',
    vehicle: VehicleOption = 'gtmab',
    frequency: Annotated[
        float, typer.Option(help='Flicker frequency of the lamp in Hz.', min=1.0, max=1e5)
    ] = DemodulationSettings().frequency,
    seconds: Annotated[
        float, typer.Option(help='Listening time per device in s.', min=0.5, max=3600.0)
    ] = 5.0,
    udev: Annotated[
        bool,
        typer.Option(
            '--udev', help='Print udev rules that allow access to the devices, and exit.'
        ),
    ] = False,
    json: Json = False,
) -> None:
    """
    Find radios, drones and light boards, listen to them, and report problems.

    Checks permissions, firmware, rates, packet loss, latency, battery, supervisor, parameters and
    each photodiode. Never writes parameters, arms or turns motors.

    Exit status 0: all in order, or only warnings. 1: a check failed. 2: no hardware found.

    Example: lta hardware check

    Example: lta hardware check --uri udp://127.0.0.1:19850

    Example: lta hardware check --udev | sudo tee /etc/udev/rules.d/60-lta.rules
    """
    if udev:
        sys.stdout.write(format_udev_rules())
        # The rules go to stdout for tee, the instructions to stderr
        sys.stderr.write(
            f'Save these rules as {RULES_FILE}, run: sudo udevadm control --reload && sudo '
            'udevadm trigger, then reconnect the devices.\n'
        )
        return
    console = plain_console(stderr=json)
    request = HardwareCheckRequest(uri, port, vehicle, frequency, seconds)
    columns = (TextColumn('{task.description}'), BarColumn())
    with ProgressBar(console, *columns, begin='searching', total=1.0) as bar:
        outcome = run_hardware_check(
            request, lambda doing, part: bar.update_bar(description=doing, completed=part)
        )
    if json:
        print_json(to_json(outcome))
    print_checks(outcome.checks, console)
    if outcome.drone is not None:
        print_table('Log blocks', format_stream_rows(outcome.drone.streams), console)
    if outcome.board is not None and outcome.board.diodes:
        print_table('Diodes', format_diode_rows(outcome.board.diodes), console)
    raise typer.Exit(exit_status(outcome.checks))


def print_table(title: str, rows: list[tuple[str, ...]], console: Console) -> None:
    """Print a table whose first row is the header."""
    printed = Table(
        title=title, title_justify='left', box=None, pad_edge=False, padding=(0, 2, 0, 0)
    )
    for k, name in enumerate(rows[0]):
        printed.add_column(name, justify='left' if k == 0 else 'right')
    for row in rows[1:]:
        printed.add_row(*row)
    console.print(printed)
