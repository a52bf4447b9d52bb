"""A voltage or current of the cell that is not a number, or beyond what a meter reads."""

import math

from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level


def _sees(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    return not seen.reading.usable, memory


def _says(seen: Seen) -> str:
    reading = seen.reading
    if math.isfinite(reading.voltage) and math.isfinite(reading.current):
        told = f'{reading.voltage:.3g} V and {reading.current:.3g} A'
        return f'the cell cannot have {told}: check the power meter'
    return 'voltage or current of the cell is not a number: check the power meter'


DETECTOR = Detector('not a number', _sees, _says, Level.ERROR, spoils=True, rise=0.0, fall=2.0)
