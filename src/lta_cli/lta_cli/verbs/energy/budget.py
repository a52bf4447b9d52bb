"""lta energy budget: what each task of a drone takes, beside the paper."""

from typing import Annotated

from lta_bridge.bag.writer import empty_folder
from lta_cli.options.json_option import Json, print_kept_json
from lta_cli.options.out_option import Out
from lta_cli.options.pictures_option import can_be_taken, Pictures
from lta_cli.options.plain_console import plain_console
from lta_config.typed import near, typed
from lta_report.results_folder import keep_json, page_line, results_folder
from lta_report.screenshots import write_pictures
from lta_studies.energy.budget.page import notes, table, title, why, write_page
from lta_studies.energy.budget.run import budget as find_budget
from lta_studies.energy.budget.run import count, plain
from lta_studies.energy.tables import show
from lta_studies.energy.watched import watched
import typer


def budget(
    vehicle: Annotated[str, typer.Option(help='Whose budget.')] = 'gtmab',
    beside: Annotated[
        str, typer.Option(help='Multirotor that hovers on power alone.')
    ] = 'multirotor',
    seeds: Annotated[int, typer.Option(help='Flights of each.', min=1, max=100)] = 3,
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Tell what each task takes: standing, taking off, hovering, flying, finding a lamp.

    Measured in simulated flights, the rotors apart from the electronics, beside the figures of the
    seed paper and a multirotor that hovers. Where they differ, what would make ours the paper's:
    more weight, a draught, worse rotors. Rotors by duty and voltage stand beside Bitcraze's bench.

    Exit status 0: done. 2: bad input.

    Example: lta energy budget --seeds 1
    """
    console = plain_console(stderr=json)
    can_be_taken(pictures)
    target = empty_folder(results_folder(out, 'budget'))
    found = watched(lambda tick: find_budget(vehicle, beside, seeds, tick), count(seeds), console)
    content = keep_json(plain(found), target / 'budget.json')
    again = typed(
        'energy', 'budget', '--vehicle', vehicle, '--beside', beside, '--seeds', str(seeds)
    )
    commands = {'Find it again': again, 'What it means on a cell': typed('energy', 'hover')}
    page = write_page(found, commands, target / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        print_kept_json(content, page)
    for each in (table(found), why(found)):
        show(each, console)
    lines = [*notes(found), title(found), page_line(near(page))]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
