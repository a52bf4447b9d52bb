"""
Another cell than a moment ago: a voltage that neither charge nor load explains.

A meter that hangs makes the other one look surprising; a reading that repeats a number of the one
before is no witness.
"""

from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level

SURPRISE = 5.0  # standard deviations


def _sees(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    now, before = seen.reading, seen.before
    repeats = before is not None and now.current == before.current
    return seen.surprise > SURPRISE and not repeats, memory


def _says(seen: Seen) -> str:
    return (
        'the voltage jumped by more than charge and load explain: another cell? '
        'Its charge is estimated anew'
    )


DETECTOR = Detector('swapped', _sees, _says, Level.ERROR, spoils=True, rise=0.3, fall=10.0)
