"""lta energy mounting: compare positions of the solar panels."""

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
from lta_config.files import find_file, load_yaml
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from lta_report.screenshots import write_pictures
from lta_report.study_progress import StudyProgress
from lta_studies.energy.mounting import verdict
from lta_studies.energy.mounting.page import write_page
from lta_studies.energy.mounting.run import compare_mounts, MountingRequest
from lta_studies.energy.mounting.tables import build_comparison_tables, to_json
from lta_studies.energy.tables import print_table, transpose_table
import typer
import yaml

MOUNTS = ['side', 'bottom', 'top']


def mounting(
    mount: Annotated[
        list[str] | None,
        typer.Option(
            help='Solar panel mount, name or file; repeat to compare several. Default: side, '
            'bottom and top.'
        ),
    ] = None,
    vehicle: Annotated[
        str, typer.Option(help='Vehicle that carries the panels, name or file.')
    ] = 'gtmab',
    misplaced: Annotated[
        float,
        typer.Option(help='Forward displacement of the panels in the misplaced variant, in cm; '
                     'negative: backward.',
                     min=-50.0, max=50.0),
    ] = 3.0,
    seeds: Annotated[
        int, typer.Option(help='Number of flights with each mount.', min=1, max=100)
    ] = 3,
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:  # fmt: skip
    """
    Compare solar panels mounted at the side, at the bottom and on top.

    A mount is a file in config/mounts: parts that replace a layer, some of them panels. Mass,
    balance, inertia, drag and shading follow from it. Each variant is released tilted, checked
    against a closed-form solution, and flown straight at 0.1 m/s with panels in place and
    misplaced. If the hull cannot carry a mount, all variants are compared in a fuller hull. The
    page also shows the effect of a centre of gravity above the centre of buoyancy.

    Writes a page, mounting.json (SI units) and a vehicle file for each variant.

    Exit status 0: done. 2: bad input.

    Example: lta energy mounting --seeds 1
    """
    console = plain_console(stderr=json)
    check_picture_output(pictures)
    names = list(dict.fromkeys(mount or MOUNTS))
    order = MountingRequest(
        # cm to m; the raw file, because mounts replace one of its layers
        load_yaml(find_file('vehicle', vehicle)),
        names,
        misplaced / 100.0,
        seeds,
    )
    # Number of flights, for the progress bar
    todo = seeds * sum(map(len, order.build_vehicles().values()))
    target = prepare_empty_folder(resolve_folder(out, 'mounting'))
    with StudyProgress(console, todo, unit='flights') as progress:
        found = compare_mounts(order, progress.count_item)
    content = write_json(to_json(found), target / 'mounting.json')
    # Variants in the vehicle's own hull, or in the fuller one if it cannot carry a mount
    for each in (found.own or found.shared).values():
        text = yaml.safe_dump(dict(each.fitted.content), sort_keys=False)
        (target / f'{each.fitted.mount.name}.yaml').write_text(text, encoding='utf-8')
    again = format_lta_command(
        'energy', 'mounting', *(word for name in names for word in ('--mount', name)), '--vehicle',
        vehicle, '--misplaced', f'{misplaced:g}', '--seeds', str(seeds),
    )  # fmt: skip
    best = relative_path(target / f'{verdict.find_best_mount(found)}.yaml')
    commands = {
        'Repeat this study': again,
        'Compare with the vehicle': format_lta_command('vehicle', 'diff', vehicle, best),
        'Fly it': format_lta_command('simulate', '--vehicle', best),
    }
    page = write_page(found, commands, target / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        print_json_text(content, page)
    for table in build_comparison_tables(found):
        print_table(transpose_table(table), console)
    lines = [
        *verdict.format_findings(found),
        verdict.format_headline(found),
        format_page_line(relative_path(page)),
    ]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
