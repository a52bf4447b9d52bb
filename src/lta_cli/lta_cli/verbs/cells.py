"""lta cells: compare solar cells, and arrays of them within a weight budget."""

from typing import Annotated

from lta_cli.options.study_command import report_command
from lta_config.errors import BadInput
from lta_config.quantity import describe_misfit, Quantity
from lta_config.schema.cell_file import load_cell_table
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_report.report import Report
from lta_studies.energy.cells.report import build_report
from pydantic import ValidationError
import typer


@report_command('cells')
def cells(
    table: Annotated[
        str,
        typer.Argument(help='Table of solar cells: a name in config/cell_tables, or a file.'),
    ] = 'seed_paper',
    budget: Annotated[
        str, typer.Option(help='Maximum mass of a solar array, such as "50 g".')
    ] = '50 g',
    vehicle: Annotated[
        str, typer.Option(help='Vehicle whose solar charger and electrical loads are used.')
    ] = 'gtmab',
) -> Report:
    """
    Compare solar cells by charging time, and the arrays that fit into a weight budget.

    Ranks cells by the paper's figure (charging time of a capacitor divided by area) and by a
    fairer one (time multiplied by area). Reports the surplus of the paper's arrays in stand-by and
    while transmitting, under white LED light and sunlight of equal illuminance, and the largest
    array of each cell within the budget. Panels are files in config/cells, tables are in
    config/cell_tables.

    The results are a page and cells.json (SI units).

    Exit status 0: done. 2: bad input.

    Example: lta cells --budget "50 g"
    """
    # Parse before any work, so that a wrong budget is reported at once
    mass, energy = parse_mass(budget), load_vehicle_file(vehicle).energy
    # Without a charger, the surplus of an array is undefined
    if energy.charger is None:
        raise BadInput(
            f"Vehicle '{vehicle}' has no charger for solar panels; choose another --vehicle."
        )
    return build_report(load_cell_table(table), energy, mass)


def parse_mass(text: str) -> float:
    """Parse a mass in kg; raise `BadInput` for any other text."""
    try:
        quantity = Quantity.model_validate(text)
    except ValidationError as error:
        # Pydantic puts this prefix before messages of validators
        reason = error.errors()[0]['msg'].removeprefix('Value error, ')
        raise BadInput(f'The budget {reason}.') from None
    # 100 kg: far above any vehicle here, but it catches a wrong unit
    if complaint := describe_misfit(quantity, 'kg', above=0.0, high=100.0):
        raise BadInput(f'The budget {complaint}.')
    return quantity.si
