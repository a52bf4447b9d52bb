"""lta light study: repeat the paper's study of the number of photodiodes."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from lta_bridge.bag.writer import prepare_empty_folder
from lta_cli.options.output_options import Json, parse_folder, print_json
from lta_cli.options.plain_console import plain_console
from lta_config.command_line import relative_path
from lta_report.progress_bar import ProgressBar
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from lta_studies.light.bearing.places import build_flight_spec, PLACES
from lta_studies.light.bearing.study import COUNTS, DIRECTIONS, judge_claims, READINGS, study_rings
from lta_studies.light.bearing.study_page import (
    build_claim_rows,
    build_ring_rows,
    DEFECT,
    write_page,
)
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
import typer


def light_study(
    vehicle: Annotated[
        str, typer.Option(help='Vehicle that carries the photodiodes, name or file.')
    ] = 'gtmab',
    readings: Annotated[
        int,
        typer.Option(help='Number of photodiode readings in each direction.', min=1, max=10_000),
    ] = READINGS,
    seed: Annotated[int, typer.Option(help='Random seed.', min=0)] = 1,
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/<time>-study by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
    json: Json = False,
) -> None:
    """
    Repeat the paper's study of the number of photodiodes, with its estimator and with ours.

    Simulates 4, 8 and 16 diodes with the lamp 3 m away in 16 directions, 50 readings each, indoors
    and outdoors. Reports median errors, checks the paper's statements, and explains those that
    cannot hold.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta light study --seed 7
    """
    console = plain_console(stderr=json)
    for place in PLACES.values():
        # Check that the vehicle fits the scenes before any work
        build_flight_spec(place, vehicle, 1)
    target = prepare_empty_folder(resolve_folder(out, 'study'))
    columns = (TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn())
    # Steps of the progress bar
    total = len(PLACES) * len(COUNTS) * DIRECTIONS
    with ProgressBar(console, *columns, begin='study', total=total) as bar:
        found = study_rings(vehicle, readings, seed, lambda: bar.update_bar(advance=1))
    content = {
        'vehicle': vehicle,
        'readings': readings,
        'seed': seed,
        'rings': [each.to_json() for each in found],
        # Tuples to lists, as JSON returns them
        'claims': [list(each) for each in judge_claims(found)],
    }
    write_json(content, target / 'study.json')
    page = write_page(found, vehicle, readings, seed, target / 'report.html')
    if json:
        print_json(content, page)
    print_table(
        'Bearing errors over 16 directions, with the lamp 3 m away',
        build_ring_rows(found),
        console,
    )
    print_table(
        "The paper's claims, checked",
        build_claim_rows(found),
        console,
    )
    console.print(DEFECT, highlight=False)
    console.print(
        format_page_line(relative_path(page)), highlight=False, markup=False, soft_wrap=True
    )


def print_table(title: str, rows: Sequence[tuple[str, ...]], console: Console) -> None:
    """Print a table whose first row is the header."""
    printed = Table(
        title=title, title_justify='left', box=None, pad_edge=False, padding=(0, 1, 0, 0)
    )
    for k, name in enumerate(rows[0]):
        printed.add_column(name, justify='left' if k == 0 else 'right')
    for row in rows[1:]:
        printed.add_row(*row)
    console.print(printed)
