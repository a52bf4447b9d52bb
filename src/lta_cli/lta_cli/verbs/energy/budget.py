"""lta energy budget: measure the power of each task and compare it with the paper."""

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
from lta_report.study_progress import StudyProgress
from lta_studies.energy.budget.page import (
    build_cause_table,
    build_task_table,
    describe_differences,
    format_headline,
    write_page,
)
from lta_studies.energy.budget.run import count_flights, measure_budget, to_json
from lta_studies.energy.tables import print_table
import typer


def budget(
    vehicle: Annotated[str, typer.Option(help='Vehicle name or file.')] = 'gtmab',
    beside: Annotated[
        str, typer.Option(help='Multirotor to compare with, name or file.')
    ] = 'multirotor',
    seeds: Annotated[
        int, typer.Option(help='Number of flights of each vehicle.', min=1, max=100)
    ] = 3,
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Measure the power of each task: standing, take-off, hovering, flying, finding a lamp.

    Simulated flights give the power of rotors and electronics separately, compared with the seed
    paper and a hovering multirotor. Where the paper differs, the study computes what would explain
    it: more weight, a draught, less efficient rotors. Rotor power by duty and voltage is compared
    with Bitcraze's bench measurements.

    Exit status 0: done. 2: bad input.

    Example: lta energy budget --seeds 1
    """
    console = plain_console(stderr=json)
    check_picture_output(pictures)
    target = prepare_empty_folder(resolve_folder(out, 'budget'))
    with StudyProgress(console, count_flights(seeds), unit='flights') as progress:
        found = measure_budget(vehicle, beside, seeds, progress.count_item)
    content = write_json(to_json(found), target / 'budget.json')
    # The page shows the command that repeats the study
    again = format_lta_command(
        'energy', 'budget', '--vehicle', vehicle, '--beside', beside, '--seeds', str(seeds)
    )
    # Commands for the next steps, listed on the page
    commands = {
        'Repeat this study': again,
        'Hover on one battery cell': format_lta_command('energy', 'hover'),
    }
    page = write_page(found, commands, target / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        print_json_text(content, page)
    for each in (build_task_table(found), build_cause_table(found)):
        print_table(each, console)
    lines = [
        *describe_differences(found),
        format_headline(found),
        format_page_line(relative_path(page)),
    ]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
