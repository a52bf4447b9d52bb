"""lta vehicle show: show the properties and performance of a vehicle."""

from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_analysis.door import check_picture_output
from lta_cli.options.common_options import (
    folder_option,
    Json,
    Pictures,
    print_json,
    VehicleName,
)
from lta_config.errors import BadInput
from lta_control.gains_file import load_gains
from lta_model.vehicle import load_vehicle
from lta_report.report_page import PAGE, write_report
from lta_report.results_folder import format_page_line, stage_results
from lta_studies.tune.helium_limit import find_tolerable_helium_loss
from lta_studies.tune.run import select_start_gains
from lta_vehicle.figures.sheet import build_sheet
from lta_vehicle.validation import find_warnings
from lta_vehicle.views import sheet_summary
from lta_vehicle.views.report import build_report
from rich.console import Console
import typer


def show(
    name: VehicleName,
    out: Annotated[
        Path | None,
        folder_option('Folder of the page and of vehicle.json; nothing is written by default.'),
    ] = None,
    gains: Annotated[
        bool,
        typer.Option(
            '--gains',
            help='Simulate flights to find the loss of lift at which the controller gains fail.',
        ),
    ] = False,
    sources: Annotated[
        bool,
        typer.Option('--sources', help='List every number of the vehicle file with its source.'),
    ] = False,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Show the properties and performance of a vehicle, and the source of each number.

    Mass by layer and part; centre of gravity; hover duty; thrust along each axis; speeds; pitch
    stability and tumbling; the helium loss at which it can no longer hover and, with --gains
    (about ten flights), at which its gains fail. Numbers that were neither measured nor published
    are marked as assumed. The page (--out) adds three views and works offline.

    Example: lta vehicle show gtmab --out runs/gtmab
    """
    if pictures is not None and out is None:
        raise BadInput('--pictures needs the page; give its folder with --out.')
    check_picture_output(pictures)
    console = plain_console(stderr=json)
    vehicle = load_vehicle(name)
    # Only on request, since it takes about ten flights
    held = _find_helium_limit(name, console) if gains else None
    sheet = build_sheet(vehicle, held)
    # Without the note on assumed numbers, which the sheet shows anyway
    noted = find_warnings(sheet)
    report = build_report(sheet, noted, name, sources)
    if out is not None:
        with stage_results(out.absolute(), PAGE) as part:
            write_report(report, part, pictures=pictures)
    if json:
        print_json(report.data)
    else:
        sheet_summary.show_sheet(sheet, report, console)
    if out is not None:
        console.print(format_page_line(out.absolute() / PAGE), highlight=False, soft_wrap=True)


def _find_helium_limit(name: str, console: Console) -> float:
    """Return the loss of lift up to which the gains hold [kg]; print each step of the search."""

    def print_step(loss: float, holds: bool) -> None:
        word = 'work' if holds else 'fail'
        console.print(
            f'{1e3 * loss:6.1f} g of lift lost: the controller gains {word}', highlight=False
        )

    limit = find_tolerable_helium_loss(
        name, load_gains(select_start_gains(name, None)), tell=print_step
    )
    # g to kg; None means that the gains fail without any loss
    return 0.0 if limit.grams is None else 1e-3 * limit.grams
