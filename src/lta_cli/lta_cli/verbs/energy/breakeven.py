"""lta energy breakeven: compute the illuminance that sustains each task of a drone."""

from typing import Annotated

from lta_cli.options.study_command import report_command
from lta_model.vehicle import load_vehicle
from lta_report.report import Report
from lta_studies.energy.break_even.report import build_report
from lta_studies.energy.break_even.study import compute_break_even_map
import typer

BUDGET = 48.8  # g: the seed paper's array of two ANYSOLAR panels
CELLS = ['powerfilm_large', 'anysolar', 'adafruit', 'dracula']  # cells that fit into this budget


@report_command('breakeven')
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
) -> Report:
    """
    Compute the break-even illuminance of a drone: idle, transmitting, hovering, flying.

    Covers 300 lx to 100 klx from a white LED, a flickering beacon and the sun; with the vehicle's
    own array and with arrays of other panels within a mass budget.

    Exit status 0: done. 2: bad input.

    Example: lta energy breakeven --cell kitronik --budget 60
    """
    # Remove duplicates and keep the order
    names = list(dict.fromkeys(cell or CELLS))
    # g to kg
    result = compute_break_even_map(load_vehicle(vehicle), names, 1e-3 * budget)
    return build_report(result)
