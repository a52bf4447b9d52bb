"""A voltage that no cell of this kind has."""

from lta_energy.faults.dropout import NOTHING
from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level

LOWEST, HIGHEST = (
    2.0,
    4.45,
)  # V; a LiPo cell is ruined below, and 0.25 V above full it is in danger


def _sees(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    voltage = seen.reading.voltage
    return NOTHING <= abs(voltage) < LOWEST or voltage > HIGHEST, memory


def _says(seen: Seen) -> str:
    return (
        f'{seen.reading.voltage:.2f} V is no voltage of a LiPo cell '
        f'({LOWEST:g} to {HIGHEST:g} V): check the power meter and its unit'
    )


DETECTOR = Detector('implausible', _sees, _says, Level.ERROR, spoils=True, rise=0.3, fall=2.0)
