"""lta fly: a whole flight, recorded and reported."""

import json as json_text
from pathlib import Path
import sys
from typing import Annotated, Literal

from lta_analysis.flight import fly_once, Order
from lta_analysis.progress import FlightProgress
from lta_analysis.report.page import write_page
from rich.console import Console
import typer


def fly(
    vehicle: Annotated[str, typer.Option(help='Vehicle name or file.')] = 'gtmab',
    scenario: Annotated[str, typer.Option(help='Scenario name or file.')] = 'lamp_room',
    strategy: Annotated[str, typer.Option(help='Navigation strategy.')] = 'bag',
    seed: Annotated[int, typer.Option(help='Seed of all chance.', min=0, max=2**31 - 1)] = 1,
    time: Annotated[
        Literal['lockstep', 'realtime'],
        typer.Option(help='As fast as the graph answers, or at the pace of the wall clock.'),
    ] = 'lockstep',
    out: Annotated[
        Path | None, typer.Option(help='Folder of the results; runs/<time>-<name> by default.')
    ] = None,
    page: Annotated[bool, typer.Option(help='Write the page of the flight.')] = True,
    json: Annotated[bool, typer.Option('--json', help='Print the results as JSON.')] = False,
) -> None:
    """
    Fly: the whole graph, one process a node, recorded to MCAP and reported as a page.

    In lockstep a seed gives the same flight every time, byte for byte. Exit status 0 if the drone
    reached its goal, 1 if it did not or a node died, 2 on bad input.

    Example: lta fly --seed 3 --time realtime
    """
    console = Console(stderr=json)
    order = Order(vehicle, scenario, strategy, seed, time, out)
    with FlightProgress(console) as progress:
        flight = fly_once(order, progress)
    results: dict[str, object] = {
        'outcome': flight.outcome,
        'pace': flight.pace,
        'bag': str(flight.bag),
        'units': {'pace': '1'},
    }
    if page:
        target = flight.folder / 'report.html'
        figures = write_page(flight.bag, target)
        results |= figures.to_dict() | {'page': str(target)}
        results['units'] = {'pace': '1', **figures.units()}
    if json:
        sys.stdout.write(json_text.dumps(results, indent=1) + '\n')
    console.print(f'The drone {flight.sentence}.', highlight=False)
    if page:
        console.print(
            f'Bag  {flight.bag}  (drop it into Foxglove, or: lta bag info {flight.bag})\n'
            f'Page {target}  (open it in a browser: xdg-open {target})',
            highlight=False,
            soft_wrap=True,
        )
    if flight.outcome != 'reached':
        raise typer.Exit(1)
