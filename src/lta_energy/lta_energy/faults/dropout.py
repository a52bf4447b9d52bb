"""A meter that gives nothing: the drone runs, and its cell reads zero volts."""

from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level

NOTHING = 0.1  # V; no computer runs on that


def _sees(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    return abs(seen.reading.voltage) < NOTHING, memory


def _says(seen: Seen) -> str:
    return (
        f'the cell reads {seen.reading.voltage:.2f} V: a brown-out that cut the supply, or a wire '
        'of the power meter'
    )


DETECTOR = Detector('dropout', _sees, _says, Level.ERROR, spoils=True, rise=0.0, fall=2.0)
