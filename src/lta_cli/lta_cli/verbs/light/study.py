"""lta light study: the paper's study of the number of photodiodes, by both estimators."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from lta_bridge.bag.writer import empty_folder
from lta_cli.options.json_option import Json, print_json
from lta_cli.options.out_option import folder
from lta_cli.options.plain_console import plain_console
from lta_config.typed import near
from lta_report.bar import Bar
from lta_report.results_folder import keep_json, page_line, results_folder
from lta_studies.light.bearing.places import made_of, PLACES
from lta_studies.light.bearing.study import COUNTS, DIRECTIONS, READINGS, study, verdicts
from lta_studies.light.bearing.study_page import claims, DEFECT, rows, write_page
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
import typer


def light_study(
    vehicle: Annotated[str, typer.Option(help='Vehicle whose diodes, name or file.')] = 'gtmab',
    readings: Annotated[
        int, typer.Option(help='Readings in each direction.', min=1, max=10_000)
    ] = READINGS,
    seed: Annotated[int, typer.Option(help='Seed of all chance.', min=0)] = 1,
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/<time>-study by default.',
            parser=folder,
            metavar='FOLDER',
        ),
    ] = None,
    json: Json = False,
) -> None:
    """
    Repeat the paper's study of the number of photodiodes, with its estimator and with ours.

    4, 8 and 16 diodes, the lamp 3 m away in 16 directions, 50 readings each, indoors and outdoors;
    median errors, the paper's statements counted beside, and a plain word where one cannot hold.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta light study --seed 7
    """
    console = plain_console(stderr=json)
    for place in PLACES.values():
        made_of(place, vehicle, 1)
    target = empty_folder(results_folder(out, 'study'))
    columns = (TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn())
    total = len(PLACES) * len(COUNTS) * DIRECTIONS
    with Bar(console, *columns, begin='study', total=total) as bar:
        found = study(vehicle, readings, seed, lambda: bar.move(advance=1))
    content = {
        'vehicle': vehicle,
        'readings': readings,
        'seed': seed,
        'rings': [each.to_json() for each in found],
        'claims': [list(each) for each in verdicts(found)],
    }
    keep_json(content, target / 'study.json')
    page = write_page(found, vehicle, readings, seed, target / 'report.html')
    if json:
        print_json(content, page)
    show('Median errors over 16 directions, the lamp 3 m away', rows(found), console)
    show(
        'What the paper says, counted',
        claims(found),
        console,
    )
    console.print(DEFECT, highlight=False)
    console.print(page_line(near(page)), highlight=False, markup=False, soft_wrap=True)


def show(title: str, told: Sequence[tuple[str, ...]], console: Console) -> None:
    """Print a table whose first row is its head."""
    printed = Table(
        title=title, title_justify='left', box=None, pad_edge=False, padding=(0, 1, 0, 0)
    )
    for k, name in enumerate(told[0]):
        printed.add_column(name, justify='left' if k == 0 else 'right')
    for row in told[1:]:
        printed.add_row(*row)
    console.print(printed)
