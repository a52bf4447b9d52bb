"""lta energy hover: two drones hover on identical cells."""

from typing import Annotated

from lta_bridge.bag.writer import empty_folder
from lta_cli.options.json_option import Json, print_kept_json
from lta_cli.options.out_option import Out
from lta_cli.options.pictures_option import can_be_taken, Pictures
from lta_cli.options.plain_console import plain_console
from lta_config.typed import near, typed
from lta_report.results_folder import keep_json, page_line, results_folder
from lta_report.screenshots import write_pictures
from lta_studies.energy import paper
from lta_studies.energy.hover.page import notes, plain, table, title, write_page
from lta_studies.energy.hover.run import compare
from lta_studies.energy.tables import show
from rich.progress import Progress
import typer


def hover(
    vehicle: Annotated[str, typer.Option(help='Whose cell both take.')] = 'gtmab',
    beside: Annotated[str, typer.Option(help='Who hovers beside it.')] = 'multirotor',
    seconds: Annotated[
        float, typer.Option(help='How long.', min=1.0, max=7200.0)
    ] = paper.HOVER_TIME,
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Hover for 450 s on identical cells: a drone that gas carries, and a multirotor.

    Both fly in the closed loop on the first one's cell, full at the start. Its voltage over time
    stands beside the same cell under the powers that the seed paper prints: 1333 mW, and thrice
    that for a standard drone. Whose supply fails falls out at that time.

    Exit status 0: done, whoever lasted. 2: bad input.

    Example: lta energy hover --seconds 60
    """
    console = plain_console(stderr=json)
    can_be_taken(pictures)
    target = empty_folder(results_folder(out, 'hover'))
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task('hovering', total=2.0 * seconds)
        found = compare(vehicle, beside, seconds, lambda s: progress.advance(task, s))
    content = keep_json(plain(found), target / 'hover.json')
    again = typed(
        'energy', 'hover', '--vehicle', vehicle, '--beside', beside, '--seconds', f'{seconds:g}'
    )
    commands = {'Find it again': again, 'What the rest takes': typed('energy', 'budget')}
    page = write_page(found, commands, target / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        print_kept_json(content, page)
    show(table(found), console)
    lines = [*notes(found), title(found), page_line(near(page))]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
