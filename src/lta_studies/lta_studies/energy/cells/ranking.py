"""
Find the Pareto front of solar cells by mass per area and charging time.

The time to charge a given capacitor falls with the area of a cell. Time *per* area, the criterion
of the seed paper, therefore rewards a large cell twice. Time *times* area does not depend on the
size.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.schema.cell_file import CellFile, CellTable, CellTableRow, load_cell_file


@final
@dataclass(frozen=True, slots=True)
class CellReading:
    """One reading of one row."""

    row: CellTableRow  # row as printed
    cell: CellFile  # panel that the row is read as
    readings: int  # number of possible readings of the row

    @property
    def title(self) -> str:
        """Label in tables and plots."""
        size = f', {1e4 * self.cell.area:.1f} cm²' if self.readings > 1 else ''
        return f'{self.row.maker}{size}'

    @property
    def areal_mass(self) -> float:
        """Mass per area. [kg/m2]"""
        return self.cell.mass.si / self.cell.area

    @property
    def charging_time_per_area(self) -> float:
        """Charging time per area, the paper's criterion. [s/m2]"""
        return self.row.charge.si / self.cell.area

    @property
    def charging_time_times_area(self) -> float:
        """Charging time times area, the fair criterion. [s m2]"""
        return self.row.charge.si * self.cell.area

    @property
    def charging_time_times_mass(self) -> float:
        """Charging time times the printed mass. [s kg]"""
        return self.row.charge.si * self.row.mass.si


Criterion = Callable[[CellReading], float]


def list_readings(table: CellTable) -> list[CellReading]:
    """Return every reading of every row."""
    return [
        CellReading(row, load_cell_file(name), len(row.cells))
        for row in table.rows.values()
        for name in row.cells
    ]


def select_readings(entries: Sequence[CellReading], which: int) -> list[CellReading]:
    """Return one entry per row; `which` selects among several readings."""
    return [each for each in entries if each.cell.name == each.row.cells[which % each.readings]]


def find_pareto_front(entries: Sequence[CellReading], criterion: Criterion) -> list[CellReading]:
    """Return the Pareto front in mass per area and a criterion, lightest first."""
    best, front = float('inf'), []
    # From light to heavy: an entry is on the front if it improves on all lighter ones.
    for each in sorted(entries, key=lambda entry: (entry.areal_mass, criterion(entry))):
        if criterion(each) < best:
            best = criterion(each)
            front.append(each)
    return front
