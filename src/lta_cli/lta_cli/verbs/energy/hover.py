"""lta energy hover: compare two hovering drones on identical cells."""

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
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from lta_report.screenshots import write_pictures
from lta_studies.energy import paper
from lta_studies.energy.hover.page import (
    build_discharge_table,
    describe_differences,
    format_headline,
    to_json,
    write_page,
)
from lta_studies.energy.hover.run import compare_hovering
from lta_studies.energy.tables import print_table
from rich.progress import Progress
import typer


def hover(
    vehicle: Annotated[
        str, typer.Option(help='Buoyant vehicle, name or file; both drones use its battery cell.')
    ] = 'gtmab',
    beside: Annotated[
        str, typer.Option(help='Multirotor to compare with, name or file.')
    ] = 'multirotor',
    seconds: Annotated[
        float, typer.Option(help='Duration in seconds.', min=1.0, max=7200.0)
    ] = paper.HOVER_TIME,
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Hover for 450 s on identical cells: a buoyant drone and a multirotor.

    Both fly in closed loop on the first one's cell, fully charged at the start. The cell voltage
    is compared with the same cell under the powers that the seed paper states: 1333 mW, and three
    times that for a standard drone. A drone drops out when its supply fails.

    Exit status 0: done, whichever lasted. 2: bad input.

    Example: lta energy hover --seconds 60
    """
    console = plain_console(stderr=json)
    check_picture_output(pictures)
    target = prepare_empty_folder(resolve_folder(out, 'hover'))
    # Two flights of the same length, one after the other
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task('hovering', total=2.0 * seconds)
        found = compare_hovering(vehicle, beside, seconds, lambda s: progress.advance(task, s))
    content = write_json(to_json(found), target / 'hover.json')
    again = format_lta_command(
        'energy', 'hover', '--vehicle', vehicle, '--beside', beside, '--seconds', f'{seconds:g}'
    )
    commands = {
        'Repeat this study': again,
        'Power of the other tasks': format_lta_command('energy', 'budget'),
    }
    page = write_page(found, commands, target / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        print_json_text(content, page)
    print_table(build_discharge_table(found), console)
    lines = [
        *describe_differences(found),
        format_headline(found),
        format_page_line(relative_path(page)),
    ]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
