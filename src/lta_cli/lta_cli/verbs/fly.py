"""lta fly: a whole flight, recorded and reported."""

from pathlib import Path
from typing import Annotated, Literal

from lta_bridge.live.address import PORT
from lta_cli.options.json_option import Json, print_json
from lta_cli.options.out_option import Out
from lta_cli.options.plain_console import plain_console
from lta_config.errors import BadInput
from lta_config.typed import near, typed
from lta_control.strategies import STRATEGIES
from lta_data.bag.flight import open_flight
from lta_flight.flight import Flown, fly_once, Order
from lta_flight.progress import FlightProgress
from lta_flight.report.outcome import sentence
from lta_flight.report.page import write_page
from lta_flight.report.results import Results, results_of
from lta_flight.report.view import View
from lta_report.results_folder import page_line
from rich.console import Console
import typer

KNOWN = ', '.join(STRATEGIES)


def fly(
    vehicle: Annotated[str, typer.Option(help='Vehicle name or file.')] = 'gtmab',
    scenario: Annotated[str, typer.Option(help='Scenario name or file.')] = 'lamp_room',
    strategy: Annotated[str, typer.Option(help=f'Navigation strategy: {KNOWN}.')] = 'bag',
    seed: Annotated[int, typer.Option(help='Seed of all chance.', min=0, max=2**31 - 1)] = 1,
    time: Annotated[
        Literal['lockstep', 'realtime'] | None,
        typer.Option(
            help='As fast as the graph answers, or at the pace of the wall clock.',
            show_default='lockstep; realtime with --live',
        ),
    ] = None,
    out: Out = None,
    live: Annotated[
        bool, typer.Option('--live', help='Show the flight to Foxglove while it lasts.')
    ] = False,
    live_port: Annotated[
        int, typer.Option(help='Port of the live view.', min=1, max=65535)
    ] = PORT,
    page: Annotated[bool, typer.Option(help='Write the page of the flight.')] = True,
    json: Json = False,
) -> None:
    """
    Fly: the whole graph, one process a node, recorded to MCAP and reported as a page.

    In lockstep a seed gives the same flight every time, byte for byte.

    With --live Foxglove can look on, without ROS; nobody is waited for.

    Exit status 0: the drone reached its goal. 1: it did not, or a node died. 2: bad input,
    nothing was started. 130: Ctrl-C (143: SIGTERM, 129: SIGHUP).

    Example: lta fly --seed 3 --time realtime
    """
    console = plain_console(stderr=json)
    pace = time or ('realtime' if live else 'lockstep')
    order = Order(vehicle, scenario, strategy, seed, pace, out, live_port if live else None)
    with FlightProgress(console) as progress:
        flight = fly_once(order, progress)
    target = flight.folder / 'report.html' if page else None
    figures = reported(flight, target)
    if json:
        print_json(printed(flight, figures, target))
    console.print(told(flight, figures), highlight=False, soft_wrap=True)
    if figures is not None:
        show_files(flight.bag, target, console)
    if flight.outcome != 'reached':
        raise typer.Exit(1)


def reported(flight: Flown, page: Path | None) -> Results | None:
    """Return the results, and write the page; None for a broken flight without a recording."""
    try:
        if page is not None:
            return write_page(flight.bag, page)
        return results_of(View(open_flight(flight.bag)))
    except BadInput:
        if flight.outcome == 'failed':
            return None
        raise


def printed(flight: Flown, figures: Results | None, page: Path | None) -> dict[str, object]:
    """Return what --json prints."""
    pages = {} if page is None or figures is None else {'page': str(page)}
    return {
        'outcome': flight.outcome,
        'pace': flight.pace,
        'bag': str(flight.bag),
        **({} if figures is None else figures.to_dict()),
        **pages,
        'units': {'pace': '1', **({} if figures is None else figures.units())},
    }


def told(flight: Flown, figures: Results | None) -> str:
    """Return the outcome in one sentence: the page's own, and what else the simulator knows."""
    on_course = flight.outcome == 'reached' and figures is not None and figures.success is None
    if figures is None or flight.outcome == 'failed' or on_course:
        return f'The drone {flight.sentence}.'
    if flight.outcome == 'reached':
        return f'{sentence(figures)}.'
    return f'{sentence(figures)}; it {flight.sentence}.'


def show_files(bag: Path, page: Path | None, console: Console) -> None:
    """Print where the results are and how to look at them."""
    lines = [f'Bag  {bag}  (drop it into Foxglove, or: {typed("bag", "info", near(bag))})']
    if page is not None:
        lines.append(page_line(page))
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
