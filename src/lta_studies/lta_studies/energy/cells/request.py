"""What `lta cells` takes."""

from typing import Annotated, final

from lta_config.errors import BadInput
from lta_config.schema.cell_file import load_cell_table
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_report.report import Report
from lta_report.request import argument, Mass, option, ReportRequest, StudyRun
from pydantic import Field


@final
class CellsRequest(ReportRequest, command='cells'):
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

    table: str = argument(
        'Table of solar cells: a name in config/cell_tables, or a file.', default='seed_paper'
    )
    # 100 kg: far above any vehicle here, but it catches a wrong unit
    budget: Annotated[Mass, Field(gt=0.0, le=100.0)] = option(
        'Maximum mass of a solar array, such as "50 g".', default='50 g'
    )
    vehicle: str = option(
        'Vehicle whose solar charger and electrical loads are used.', default='gtmab',
        complete='vehicle',
    )  # fmt: skip

    def run(self, run: StudyRun) -> Report:
        """Return the report of a table."""
        from lta_studies.energy.cells.report import build_report

        energy = load_vehicle_file(self.vehicle).energy
        # Without a charger, the surplus of an array is undefined
        if energy.charger is None:
            raise BadInput(
                f"Vehicle '{self.vehicle}' has no charger for solar panels; choose another "
                '--vehicle.'
            )
        return build_report(load_cell_table(self.table), energy, self.budget)
