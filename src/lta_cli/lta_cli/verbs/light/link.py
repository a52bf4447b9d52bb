"""lta light link: compute illuminance and signal-to-noise ratio of a lamp by distance."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from lta_bridge.bag.writer import prepare_empty_folder
from lta_cli.options.output_options import Json, parse_folder, print_json
from lta_cli.options.plain_console import plain_console
from lta_config.command_line import format_lta_command, relative_path
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from lta_studies.light.link.link_budget import compute_lamp_link, LampLink
from lta_studies.light.link.page import format_link_row, HEADS, write_page
from rich.console import Console
from rich.progress import track
from rich.table import Table
import typer

SCENES = ['lamp_room', 'sunny_field']
DISTANCES = [0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0]  # m


def link(
    scenario: Annotated[
        list[str] | None,
        typer.Option(
            help='Scenario with a lamp; repeat to compare several; default: lamp_room, '
            'sunny_field.'
        ),
    ] = None,
    vehicle: Annotated[
        str, typer.Option(help='Vehicle that carries the photodiodes, name or file.')
    ] = 'gtmab',
    distance: Annotated[
        list[float] | None,
        typer.Option(
            help='Distance from the lamp in metres; repeat to compare several; default: 0.5 to '
            '15.',
            min=0.05,
            max=1000.0,
        ),
    ] = None,
    altitude: Annotated[
        float, typer.Option(help='Height of the hull centre in metres.', min=0.05, max=1000.0)
    ] = 1.3,
    blocks: Annotated[
        int, typer.Option(help='Number of ADC blocks simulated at each distance.', min=1, max=1000)
    ] = 20,
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/<time>-link by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
    json: Json = False,
) -> None:
    """
    Compute the link budget: illuminance at the photodiodes and SNR, by distance from a lamp.

    The drone is on the axis of the scene's first lamp and faces it. Direct: on a plane that faces
    the lamp. Read: at the brightest diode, with its angular response, room reflections and the
    shadow of the hull. Echo: at the darkest diode. SNR: as the demodulator reports it.

    Exit status 0: done. 2: bad input.

    Example: lta light link --scenario lamp_room --distance 3 --distance 7
    """
    console = plain_console(stderr=json)
    scenes = list(dict.fromkeys(scenario or SCENES))
    distances = sorted(set(distance or DISTANCES))
    # Load all before the output folder is created
    read = [load_scenario(name) for name in scenes]
    target = prepare_empty_folder(resolve_folder(out, 'link'))
    found = [
        compute_lamp_link(
            load_vehicle(vehicle, each.air.density), each, distances, altitude, blocks
        )
        # The density of the scene's air belongs to the vehicle model
        for each in track(read, 'light link', console=console, transient=True)
    ]
    again = format_lta_command(
        'light', 'link', *(word for name in scenes for word in ('--scenario', name)),
        *(word for each in distances for word in ('--distance', f'{each:g}')), '--vehicle',
        vehicle, '--altitude', f'{altitude:g}', '--blocks', str(blocks),
    )  # fmt: skip
    content = {'vehicle': vehicle, 'altitude': altitude, 'links': [asdict(each) for each in found]}
    write_json(content, target / 'link.json')
    page = write_page(found, again, vehicle, target / 'report.html')
    if json:
        print_json(content, page)
    print_links(found, console)
    console.print(
        format_page_line(relative_path(page)), highlight=False, markup=False, soft_wrap=True
    )


def print_links(links: Sequence[LampLink], console: Console) -> None:
    """Print a table for each scenario, and the paper's figure."""
    for each in links:
        printed = Table(
            title=f'Scenario {each.scenario}, photodiode feedback resistor '
            f'{each.feedback / 1e3:g} kohm',
            title_justify='left', box=None, pad_edge=False, padding=(0, 2, 0, 0),
        )  # fmt: skip
        for head in HEADS:
            printed.add_column(head, justify='right')
        for at in each.at:
            printed.add_row(*format_link_row(at))
        console.print(printed)
    # The statement of the seed paper, for comparison
    console.print(
        'For comparison: the seed paper reports several tens of lux at 7 m from the lamp, and a '
        'high SNR.',
        soft_wrap=True,
    )
