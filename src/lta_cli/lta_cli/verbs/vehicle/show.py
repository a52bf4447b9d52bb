"""lta vehicle show: what a vehicle is and can do, and where each number comes from."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.json_option import Json, print_json
from lta_cli.options.plain_console import plain_console
from lta_control.gains_file import load_gains
from lta_model.vehicle import load_vehicle
from lta_studies.tune.limit import helium_limit
from lta_studies.tune.run import gains_of
from lta_vehicle.faults import warnings
from lta_vehicle.figures.sheet import sheet_of
from lta_vehicle.named import Named
from lta_vehicle.views import terminal
from lta_vehicle.views.page import write_page
from lta_vehicle.views.scripts import plain
from rich.console import Console
import typer


def show(
    name: Named,
    out: Annotated[Path | None, typer.Option(help='HTML file of a page to write.')] = None,
    gains: Annotated[
        bool, typer.Option('--gains', help='Fly it heavier and heavier until its gains fail.')
    ] = False,
    sources: Annotated[
        bool, typer.Option('--sources', help='List every number of the file with its source.')
    ] = False,
    json: Json = False,
) -> None:
    """
    Show what a vehicle is and can do, in words and pictures, and where each number comes from.

    Mass by layer and part; where the weight hangs; hover duty; what the rotors can push along
    each axis; speeds; how it swings, leans and tumbles; when too much helium is lost to hover,
    and with --gains (some ten flights) to be flown by its gains. What nobody measured or
    published is marked as assumed. The page (--out) has all of it with three views, offline.

    Example: lta vehicle show gtmab --out gtmab.html
    """
    console = plain_console(stderr=json)
    found = load_vehicle(name)
    held = _held(name, console) if gains else None
    sheet = sheet_of(found, held)
    noted = warnings(sheet)
    if out is not None:
        write_page(sheet, noted, name, out)
    if json:
        print_json(plain(sheet, noted))
    else:
        terminal.show_sheet(sheet, noted, console, sources)
    if out is not None:
        console.print(f'Page {out}', highlight=False, soft_wrap=True)


def _held(name: str, console: Console) -> float:
    """Return the loss of lift up to which the gains hold [kg], telling how the search goes."""

    def tell(loss: float, kept: bool) -> None:
        word = 'hold' if kept else 'fail'
        console.print(f'{1e3 * loss:6.1f} g of lift lost: the gains {word}', highlight=False)

    limit = helium_limit(name, load_gains(gains_of(name, None)), tell=tell)
    return 0.0 if limit.grams is None else 1e-3 * limit.grams
