"""lta wind: the wind that each platform can fly in."""

from collections.abc import Sequence
import math
from pathlib import Path
from typing import Annotated

from lta_bridge.bag.writer import empty_folder
from lta_cli.options.json_option import Json, print_json
from lta_cli.options.out_option import folder
from lta_cli.options.plain_console import plain_console
from lta_config.files import known
from lta_config.typed import near
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_report.bar import Bar
from lta_report.results_folder import keep_json, page_line, results_folder
from lta_studies.wind.limits import Asked, Limits, measured, ticks, to_json
from lta_studies.wind.page import write_page
from lta_studies.wind.trial import Flyable
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
import typer

ROUGHNESS = [0.03, 0.1, 0.3]  # m: grass, crops, bushes and low houses (unverified, from memory)


def wind(
    vehicles: Annotated[
        list[str] | None, typer.Argument(help='Vehicle names or files; all shipped by default.')
    ] = None,
    roughness: Annotated[
        list[float] | None,
        typer.Option(
            help='Roughness length of the ground in metres; repeatable.', min=1e-5, max=5.0
        ),
    ] = None,
    height: Annotated[
        float, typer.Option(help='Height of the hull centre in metres.', min=0.1, max=100.0)
    ] = 0.5,
    reference: Annotated[
        float, typer.Option(help='Height of the reference wind in metres.', min=0.5, max=300.0)
    ] = 10.0,
    scenario: Annotated[
        str, typer.Option(help='Where to fly; its wind is replaced, its turbulence stays.')
    ] = 'windy_field',
    seeds: Annotated[
        int, typer.Option(help='Flights at each wind; all must make way.', min=1, max=1000)
    ] = 3,
    quick: Annotated[
        bool, typer.Option('--quick', help='One seed, two airspeeds, coarse steps.')
    ] = False,
    fly: Annotated[bool, typer.Option(help='Fly; without it, limits from numbers alone.')] = True,
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/<time>-wind by default.',
            parser=folder,
            metavar='FOLDER',
        ),
    ] = None,
    json: Json = False,
) -> None:
    """
    Tell the wind that each platform can fly in: uniform, and as reference wind over rough ground.

    Static: the airspeed that the rotors hold at constant height and heading, at which the hull
    does not tumble, and at which it does not rise, nose up, whatever its rotors do. Flown: the
    largest wind, from the lamp to the start, in which the drone still makes way to the lamp with
    every seed, told to fly at the best of several airspeeds; only platforms that have a control
    law fly.

    A wind over rough ground is what a weather service would measure at the reference height; the
    hull meets the part that the log law leaves at its own. Near the roughness itself that law is
    a surrogate: compare several.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta wind gtmab skye --roughness 0.03 --roughness 0.3
    """
    console = plain_console(stderr=json)
    asked = Asked(
        tuple(dict.fromkeys(vehicles or known('vehicles'))),
        tuple(sorted(set(roughness or ROUGHNESS))),
        height, reference, scenario, 1 if quick else seeds, quick, fly,
    )  # fmt: skip
    for name in asked.vehicles:
        load_vehicle(name)
    load_scenario(asked.scenario)
    target = empty_folder(results_folder(out, 'wind'))
    found = find_limits(asked, console)
    content = to_json(found, asked)
    rows = table(found, asked)
    page = keep(target, content, found, asked)
    if json:
        print_json(content, page)
    show(rows, found, asked, console)
    console.print(page_line(near(page)), highlight=False, markup=False, soft_wrap=True)


def find_limits(asked: Asked, console: Console) -> list[Limits]:
    """Return the limits of all platforms, with a progress bar."""
    columns = (TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn())
    total = ticks(asked) + len(asked.vehicles)
    found = []
    with Bar(console, *columns, begin='wind', total=total) as bar:
        for name in asked.vehicles:
            bar.move(description=name)
            found.append(measured(asked, name, lambda: bar.move(advance=1)))
            bar.move(advance=1)
    return found


def keep(target: Path, content: dict[str, object], found: Sequence[Limits], asked: Asked) -> Path:
    """Write results and page; return the page."""
    keep_json(content, target / 'wind.json')
    return write_page(found, asked, target / 'report.html')


def table(found: Sequence[Limits], asked: Asked) -> list[list[str]]:
    """Return the table as text, its first row the head; winds in m/s."""
    head = ['', 'thrust', 'tumbles', 'rises', 'even', 'flown']
    for z in asked.roughness:
        head += [f'z0 {z:g}', 'flown']
    rows = [head]
    for each in found:
        held = (each.thrust, each.tumble, each.rise, each.static)
        row = [each.name, *map(speed, held), flight(each.flown)]
        for over in each.over:
            row += [speed(over.static), flight(over.flown)]
        rows.append(row)
    return rows


def speed(value: float) -> str:
    """Return a speed; a dash where there is no limit."""
    return f'{value:.2f}' if math.isfinite(value) else '-'


def flight(flown: Flyable | None) -> str:
    """Return a flown limit; a dash where nothing was flown."""
    return '-' if flown is None else f'{flown.wind:.2f}'


def show(rows: list[list[str]], found: Sequence[Limits], asked: Asked, console: Console) -> None:
    """Print the table and what is missing in it."""
    printed = Table(
        title='Flyable wind in m/s: by the numbers, and flown',
        title_justify='left', box=None, pad_edge=False, padding=(0, 1, 0, 0),
    )  # fmt: skip
    for column in rows[0]:
        # Headings of two words may break; names and figures are read whole.
        printed.add_column(
            column,
            justify='right' if column else 'left',
            no_wrap=' ' not in column,
            min_width=len('12.34'),
        )
    for row in rows[1:]:
        printed.add_row(*row)
    console.print(printed)
    console.print(
        f'even: uniform wind. z0: wind at {asked.reference:g} m over a roughness of so many '
        f'metres, the hull at {asked.height:g} m.',
        highlight=False,
    )
    for each in found:
        if each.flown is not None:
            console.print(
                f'{each.name}: in uniform wind it flew best when told {each.flown.airspeed:g} '
                'm/s of airspeed.',
                highlight=False,
            )
        if each.note:
            console.print(f'{each.name}: {each.note}', highlight=False, soft_wrap=True)
