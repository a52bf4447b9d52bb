"""Readings whose stamps do not move on: an old message is sent again and again."""

from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level

REPEATS = 3.0  # one message that comes twice means nothing


def _sees(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    if seen.before is None or seen.dt > 0.0:
        return False, (0.0,)
    count = memory[0] + 1.0
    return count >= REPEATS, (count,)


def _says(seen: Seen) -> str:
    return 'the stamps of the battery stand still: what publishes it repeats an old message'


DETECTOR = Detector(
    'clock', _sees, _says, Level.ERROR, spoils=False, rise=0.0, fall=2.0, start=(0.0,)
)
