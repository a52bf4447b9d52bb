"""lta fly: fly once with the ROS graph, record it and write its report."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from lta_bridge.live.address import PORT
from lta_cli.options.common_options import Json, Out, plain_console, print_json
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_control.strategies import STRATEGIES
from lta_data.bag.recorded_flight import open_flight
from lta_data.validity import describe_exceeded_region_of_bag
from lta_flight.flight import FlightRequest, FlightRun, fly_once
from lta_flight.progress import FlightProgress
from lta_flight.report.outcome import describe_outcome
from lta_flight.report.page import write_page
from lta_flight.report.results import compute_results, FlightResults
from lta_flight.report.view import FlightView
from lta_report.results_folder import format_page_line
from rich.console import Console
import typer

KNOWN = ', '.join(STRATEGIES)


def fly(
    vehicle: Annotated[str, typer.Option(help='Vehicle name or file.')] = 'gtmab',
    scenario: Annotated[str, typer.Option(help='Scenario name or file.')] = 'lamp_room',
    strategy: Annotated[
        str, typer.Option(help=f'Navigation strategy: {KNOWN}, or a file such as ./mine.py.')
    ] = 'bag',
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
    page: Annotated[bool, typer.Option(help='Write an HTML report of the flight.')] = True,
    json: Json = False,
) -> None:
    """
    Fly with the full ROS graph, record to MCAP and write a report page.

    In lockstep the same seed gives the same flight, byte for byte.

    With --live, Foxglove can watch without ROS; a slow viewer never blocks the flight.

    Exit status 0: the drone reached its goal. 1: it did not, or a node died. 2: bad input,
    nothing was started. 130: Ctrl-C (143: SIGTERM, 129: SIGHUP).

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
        flight = replace(flight, warning=' '.join(filter(None, (warning, flight.warning))))
    if json:
        print_json(flight_to_dict(flight, figures, target))
    console.print(format_outcome(flight, figures), highlight=False, soft_wrap=True)
    if figures is not None:
        print_files(flight.bag, target, console)
    # The report is written first, whatever the outcome
    if flight.outcome != 'reached':
        raise typer.Exit(1)


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


def flight_to_dict(
    flight: FlightRun, figures: FlightResults | None, page: Path | None
) -> dict[str, object]:
    """Return the content of --json."""
    # Without results there is no page
    warned = {'warning': flight.warning} if flight.warning else {}
    pages = {} if page is None or figures is None else {'page': str(page)}
    return {
        'outcome': flight.outcome,
        'pace': flight.pace,
        'bag': str(flight.bag),
        **({} if figures is None else figures.to_dict()),
        **pages,
        **warned,
        'units': {'pace': '1', **({} if figures is None else figures.list_units())},
    }


def format_outcome(flight: FlightRun, figures: FlightResults | None) -> str:
    """Return the outcome in one sentence, and the warning of the flight, if any."""
    warning = f' {flight.warning}' if flight.warning else ''
    return f'{_format_verdict(flight, figures)}{warning}'


def _format_verdict(flight: FlightRun, figures: FlightResults | None) -> str:
    """Return the outcome in one sentence, from the page and the simulator's verdict."""
    # The bag has no goal to judge by, so the simulator's verdict counts
    on_course = flight.outcome == 'reached' and figures is not None and figures.success is None
    if figures is None or flight.outcome in {'failed', 'flown'} or on_course:
        return f'The drone {flight.sentence}.'
    if flight.outcome == 'reached':
        return f'{describe_outcome(figures)}.'
    return f'{describe_outcome(figures)}; it {flight.sentence}.'


def print_files(bag: Path, page: Path | None, console: Console) -> None:
    """Print the paths of the results and how to open them."""
    lines = [
        f'Bag  {bag}  (open it in Foxglove, or run: '
        f'{format_lta_command("bag", "info", relative_path(bag))})'
    ]
    if page is not None:
        lines.append(format_page_line(page))
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
