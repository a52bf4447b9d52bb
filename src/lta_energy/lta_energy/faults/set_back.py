"""Readings by a clock that was set back; `lta_energy.monitoring.new_clock` tells when they are."""

from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level


def _sees(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    return seen.back > 0.0, memory


def _says(seen: Seen) -> str:
    return f'the clock was set back by {seen.back:.1f} s: what flowed just then is not counted'


DETECTOR = Detector('set back', _sees, _says, Level.WARN, spoils=False, rise=0.0, fall=5.0)
