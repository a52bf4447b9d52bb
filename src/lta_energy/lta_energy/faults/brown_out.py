"""A cell that gives way: below its cut-off the electronics may reset at any moment."""

from lta_energy.faults.dropout import NOTHING
from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level


def _sees(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    return NOTHING <= seen.reading.voltage <= seen.cell.discharge_cutoff, memory


def _says(seen: Seen) -> str:
    return (
        f'brown-out: the cell gives {seen.reading.voltage:.2f} V under '
        f'{-seen.reading.current:.2f} A, and its cut-off is {seen.cell.discharge_cutoff:.2f} V'
    )


DETECTOR = Detector('brown-out', _sees, _says, Level.ERROR, spoils=False, rise=0.2, fall=5.0)
