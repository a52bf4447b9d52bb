"""lta fly: fly once with the ROS graph, record it and write its report."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from lta_analysis.console import plain_console
from lta_bridge.live.origin_gate import PORT
from lta_cli.options.common_options import (
    complete_names,
    Json,
    Out,
    print_json,
    VehicleOption,
)
from lta_cli.options.flight_output import flight_to_dict, format_outcome, print_files
from lta_config.errors import BadInput
from lta_control.strategies import STRATEGIES
from lta_data.bag.recorded_flight import open_flight
from lta_data.scene import describe_exceeded_region_of_bag
from lta_flight.flight import FlightRequest, fly_once
from lta_flight.flight_run import EXIT_STATUSES, FlightRun
from lta_flight.progress import FlightProgress
from lta_flight.report.page import write_page
from lta_flight.report.results import compute_results, FlightResults
from lta_flight.report.view import FlightView
import typer

KNOWN = ', '.join(STRATEGIES)


def fly(
    vehicle: VehicleOption = 'gtmab',
    scenario: Annotated[
        str, typer.Option(help='Scenario name or file.', autocompletion=complete_names('scenario'))
    ] = 'lamp_room',
    strategy: Annotated[
        str, typer.Option(help=f'Navigation strategy: {KNOWN}, or a file such as ./mine.py.')
    ] = 'homing',
    seed: Annotated[int, typer.Option(help='Random seed.', min=0, max=2**31 - 1)] = 1,
    time: Annotated[
        Literal['lockstep', 'realtime'] | None,
        typer.Option(
            help='Speed of the simulation. lockstep: as fast as the nodes respond. realtime: '
            'wall-clock speed.',
            show_default='lockstep; realtime with --live',
        ),
    ] = None,
    processes: Annotated[
        Literal['many', 'one'],
        typer.Option(
            help='Whether every node has a process of its own, or all share one, which needs less '
            'processor time.'
        ),
    ] = 'many',
    out: Out = None,
    live: Annotated[
        bool, typer.Option('--live', help='Stream the flight live to Foxglove.')
    ] = False,
    live_port: Annotated[
        int, typer.Option(help='Port for Foxglove, with --live.', min=1, max=65535)
    ] = PORT,
    page: Annotated[bool, typer.Option(help='Write an HTML report.')] = True,
    json: Json = False,
) -> None:
    """
    Fly with the full ROS graph, record to MCAP and write a report page.

    In lockstep the same seed gives the same flight, every value of it.

    With --live, Foxglove can watch without ROS; a slow viewer never blocks the flight.

    Exit status 0: the drone reached its goal, with homing for 3 s. 1: a node died or stalled. 2:
    bad input, nothing was started. 3: out of time. 4: the drone left the room. 130: Ctrl-C (143:
    SIGTERM, 129: SIGHUP).

    Example: lta fly --seed 3 --time realtime
    """
    console = plain_console(stderr=json)
    # A live view in lockstep would run too fast to watch
    pace = time or ('realtime' if live else 'lockstep')
    order = FlightRequest(
        vehicle, scenario, strategy, seed, pace, out, live_port if live else None, processes
    )
    with FlightProgress(console) as progress:
        flight = fly_once(order, progress)
    target = flight.folder / 'report.html' if page else None
    figures = write_report(flight, target)
    if figures is not None:
        warning = describe_exceeded_region_of_bag(open_flight(flight.bag))
        flight = replace(flight, warning=warning)
    if json:
        print_json(flight_to_dict(flight, figures, target))
    console.print(format_outcome(flight, figures), highlight=False, soft_wrap=True)
    if figures is not None:
        print_files(flight.bag, target, console)
    # The report is written first, whatever the outcome
    if status := EXIT_STATUSES[flight.outcome]:
        raise typer.Exit(status)


def write_report(flight: FlightRun, page: Path | None) -> FlightResults | None:
    """Write the page and return the results; None if a failed flight left no recording."""
    try:
        if page is not None:
            return write_page(flight.bag, page)
        return compute_results(FlightView(open_flight(flight.bag)))
    except BadInput:
        # A node that died at the start may have left an empty bag
        if flight.outcome == 'failed':
            return None
        raise
