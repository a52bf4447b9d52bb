"""
Which cells are on the front: light and quick.

The time to charge a given capacitor falls with a cell's area, so time *by* area, the seed paper's
figure, rewards a large cell twice; time *times* area is the same for any size of the same cells.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.schema.cell_file import CellFile, load_cell_file
from lta_config.schema.cell_table import CellTable, CellTableRow


@final
@dataclass(frozen=True, slots=True)
class CellEntry:
    """
    One reading of one row.

    Attributes
    ----------
    row : Row
        As printed.
    cell : CellFile
        The panel that it is read as.
    readings : int
        How many readings the row has.

    """

    row: CellTableRow
    cell: CellFile
    readings: int

    @property
    def title(self) -> str:
        """What it is called in tables and pictures."""
        size = f', {1e4 * self.cell.area:.1f} cm²' if self.readings > 1 else ''
        return f'{self.row.maker}{size}'

    @property
    def areal_mass(self) -> float:
        """Mass by area. [kg/m2]."""
        return self.cell.mass.si / self.cell.area

    @property
    def charging_time_per_area(self) -> float:
        """Charging time by area, the paper's figure. [s/m2]."""
        return self.row.charge.si / self.cell.area

    @property
    def charging_time_times_area(self) -> float:
        """Charging time times area, the fair figure. [s m2]."""
        return self.row.charge.si * self.cell.area

    @property
    def charging_time_times_mass(self) -> float:
        """Charging time times the printed mass. [s kg]."""
        return self.row.charge.si * self.row.mass.si


Figure = Callable[[CellEntry], float]


def list_entries(table: CellTable) -> list[CellEntry]:
    """Return every reading of every row."""
    return [
        CellEntry(row, load_cell_file(name), len(row.cells))
        for row in table.rows.values()
        for name in row.cells
    ]


def select_readings(entries: Sequence[CellEntry], which: int) -> list[CellEntry]:
    """Return one entry a row: where a row has several readings, the one of this place."""
    return [each for each in entries if each.cell.name == each.row.cells[which % each.readings]]


def find_pareto_front(entries: Sequence[CellEntry], figure: Figure) -> list[CellEntry]:
    """Return the entries that no other beats in both mass by area and a figure; light first."""
    best, kept = float('inf'), []
    for each in sorted(entries, key=lambda entry: (entry.areal_mass, figure(entry))):
        if figure(each) < best:
            best = figure(each)
            kept.append(each)
    return kept
