"""lta energy breakeven: compute the illuminance that sustains each task of a drone."""

from typing import Annotated

from lta_bridge.bag.writer import prepare_empty_folder
from lta_cli.options.output_options import (
    check_picture_output,
    Json,
    Out,
    Pictures,
    print_json_text,
)
from lta_cli.options.plain_console import plain_console
from lta_config.command_line import format_lta_command, relative_path
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from lta_report.screenshots import write_pictures
from lta_studies.energy.break_even.page import format_headline, write_page
from lta_studies.energy.break_even.study import build_illuminance_table, compute_break_even_map
from lta_studies.energy.tables import print_table
import typer

BUDGET = 48.8  # g: the seed paper's array of two ANYSOLAR panels
CELLS = ['powerfilm_large', 'anysolar', 'adafruit', 'dracula']  # cells that fit into this budget


def breakeven(
    vehicle: Annotated[
        str, typer.Option(help='Vehicle whose electrical loads, solar array and charger are used.')
    ] = 'gtmab',
    cell: Annotated[
        list[str] | None,
        typer.Option(
            help='Solar panel for an alternative array, name or file; repeat to compare several.'
        ),
    ] = None,
    budget: Annotated[
        float,
        typer.Option(
            help='Maximum mass of each alternative solar array in g.', min=1.0, max=10_000.0
        ),
    ] = BUDGET,
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Compute the break-even illuminance of a drone: idle, transmitting, hovering, flying.

    Covers 300 lx to 100 klx from a white LED, a flickering beacon and the sun; with the vehicle's
    own array and with arrays of other panels within a mass budget.

    Exit status 0: done. 2: bad input.

    Example: lta energy breakeven --cell kitronik --budget 60
    """
    console = plain_console(stderr=json)
    check_picture_output(pictures)
    # Remove duplicates and keep the order
    names = list(dict.fromkeys(cell or CELLS))
    # g to kg
    found = compute_break_even_map(load_vehicle(vehicle), names, 1e-3 * budget)
    target = prepare_empty_folder(resolve_folder(out, 'breakeven'))
    content = write_json(found.to_json(), target / 'breakeven.json')
    again = format_lta_command(
        'energy', 'breakeven', '--vehicle', vehicle, '--budget', f'{budget:g}',
        *(word for name in names for word in ('--cell', name)),
    )  # fmt: skip
    page = write_page(found, {'Repeat this study': again}, target / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        print_json_text(content, page)
    print_table(build_illuminance_table(found), console)
    lines = [format_headline(found), format_page_line(relative_path(page))]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
