"""A time without readings: what flowed meanwhile is not known."""

from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level

LONGEST = 1.0  # s; ten turns of the meters, as long as the navigator waits by default


def _sees(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    return seen.dt > LONGEST, memory


def _says(seen: Seen) -> str:
    return f'more than {LONGEST:g} s passed without a reading: the charge is less certain'


DETECTOR = Detector('gap', _sees, _says, Level.WARN, spoils=False, rise=0.0, fall=5.0)
