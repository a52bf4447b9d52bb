"""lta wind: compute each platform's wind limit."""

from collections.abc import Sequence
import math
from pathlib import Path
from typing import Annotated

from lta_bridge.bag.writer import prepare_empty_folder
from lta_cli.options.output_options import Json, Out, print_json
from lta_cli.options.plain_console import plain_console
from lta_config.command_line import relative_path
from lta_config.files import list_shipped_names
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_report.progress_bar import ProgressBar
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from lta_studies.wind.flyable_wind import FlyableWind
from lta_studies.wind.limits import (
    count_ticks,
    measure_limits,
    PlatformWindLimits,
    to_json,
    WindStudyRequest,
)
from lta_studies.wind.page import write_page
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
import typer

ROUGHNESS = [0.03, 0.1, 0.3]  # m: grass, crops, bushes and low houses (unverified, from memory)


def wind(
    vehicles: Annotated[
        list[str] | None,
        typer.Argument(help='Vehicle names or files; all shipped vehicles by default.'),
    ] = None,
    roughness: Annotated[
        list[float] | None,
        typer.Option(
            help='Roughness length of the ground in metres; repeat to compare several.',
            min=1e-5,
            max=5.0,
        ),
    ] = None,
    height: Annotated[
        float,
        typer.Option(help='Height of the hull centre above ground in metres.', min=0.1, max=100.0),
    ] = 0.5,
    reference: Annotated[
        float,
        typer.Option(
            help='Height above rough ground, in metres, for which the wind limits are given.',
            min=0.5,
            max=300.0,
        ),
    ] = 10.0,
    scenario: Annotated[
        str,
        typer.Option(
            help='Scenario to fly in. The study sets the mean wind; the turbulence is that of the '
            'scenario.'
        ),
    ] = 'windy_field',
    seeds: Annotated[
        int,
        typer.Option(
            help='Number of flights at each wind speed; the drone can fly in this wind if all of '
            'them make headway.',
            min=1,
            max=1000,
        ),
    ] = 3,
    quick: Annotated[
        bool,
        typer.Option(
            '--quick', help='Run a shorter study: one seed, three airspeeds, coarse wind steps.'
        ),
    ] = False,
    fly: Annotated[
        bool, typer.Option(help='Simulate flights; --no-fly computes only the static limits.')
    ] = True,
    out: Out = None,
    json: Json = False,
) -> None:
    """
    Report each platform's wind limit: uniform wind, and reference wind over rough ground.

    Static limits: the airspeed that the rotors can hold at constant height and heading, and the
    airspeeds above which the hull tumbles or rises nose-up regardless of its rotors. Flown limit:
    the strongest headwind in which the drone still approaches the lamp with every seed, at the
    best of several commanded airspeeds. Only platforms with a control law are flown.

    Wind over rough ground is given at the reference height, as a weather service measures it; the
    log law yields the wind at the height of the hull. The log law is not accurate close to the
    roughness length, so compare several.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta wind gtmab skye --roughness 0.03 --roughness 0.3
    """
    console = plain_console(stderr=json)
    asked = WindStudyRequest(
        # Remove duplicates and keep the order
        tuple(dict.fromkeys(vehicles or list_shipped_names('vehicles'))),
        tuple(sorted(set(roughness or ROUGHNESS))),
        height, reference, scenario, 1 if quick else seeds, quick, fly,
    )  # fmt: skip
    for name in asked.vehicles:
        # Check all files before the first flight
        load_vehicle(name)
    load_scenario(asked.scenario)
    # All input has been checked; flights follow
    target = prepare_empty_folder(resolve_folder(out, 'wind'))
    found = find_limits(asked, console)
    content = to_json(found, asked)
    rows = build_wind_table(found, asked)
    page = write_results(target, content, found, asked)
    if json:
        print_json(content, page)
    print_table(rows, found, asked, console)
    console.print(
        format_page_line(relative_path(page)), highlight=False, markup=False, soft_wrap=True
    )


def find_limits(request: WindStudyRequest, console: Console) -> list[PlatformWindLimits]:
    """Return the limits of all platforms, with a progress bar."""
    columns = (TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn())
    # The ticks of the search, and one for each finished platform
    total = count_ticks(request) + len(request.vehicles)
    found = []
    with ProgressBar(console, *columns, begin='wind', total=total) as bar:
        for name in request.vehicles:
            bar.update_bar(description=name)
            found.append(measure_limits(request, name, lambda: bar.update_bar(advance=1)))
            bar.update_bar(advance=1)
    return found


def write_results(
    target: Path,
    content: dict[str, object],
    limits: Sequence[PlatformWindLimits],
    request: WindStudyRequest,
) -> Path:
    """Write wind.json and the page; return the path of the page."""
    write_json(content, target / 'wind.json')
    return write_page(limits, request, target / 'report.html')


def build_wind_table(
    limits: Sequence[PlatformWindLimits], request: WindStudyRequest
) -> list[list[str]]:
    """Return the table of winds in m/s; the first row is the header."""
    head = ['', 'thrust', 'tumbles', 'rises', 'even', 'flown']
    for z in request.roughness:
        head += [f'z0 {z:g}', 'flown']
    rows = [head]
    for each in limits:
        # The static limit is the smallest of the first three
        held = (each.thrust, each.tumble, each.rise, each.static)
        row = [each.name, *map(format_speed, held), format_flight_limit(each.flown)]
        for over in each.over:
            row += [format_speed(over.static), format_flight_limit(over.flown)]
        rows.append(row)
    return rows


def format_speed(value: float) -> str:
    """Format a speed; a dash means no limit."""
    return f'{value:.2f}' if math.isfinite(value) else '-'


def format_flight_limit(limit: FlyableWind | None) -> str:
    """Format a flown limit; a dash means not flown."""
    return '-' if limit is None else f'{limit.wind:.2f}'


def print_table(
    rows: list[list[str]],
    limits: Sequence[PlatformWindLimits],
    request: WindStudyRequest,
    console: Console,
) -> None:
    """Print the table and its notes."""
    printed = Table(
        title='Wind limits in m/s: computed (static) and simulated (flown)',
        title_justify='left', box=None, pad_edge=False, padding=(0, 1, 0, 0),
    )  # fmt: skip
    for column in rows[0]:
        # Only headings of two words may wrap; names and numbers must stay on one line.
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
        f'even: uniform wind. z0 X: wind at {request.reference:g} m height over ground with a '
        f'roughness length of X metres, while the hull flies at {request.height:g} m height.',
        highlight=False,
        soft_wrap=True,
    )
    for each in limits:
        if each.flown is not None:
            console.print(
                f'{each.name}: best commanded airspeed in uniform wind: '
                f'{each.flown.airspeed:g} m/s.',
                highlight=False,
            )
        if each.note:
            console.print(f'{each.name}: {each.note}', highlight=False, soft_wrap=True)
