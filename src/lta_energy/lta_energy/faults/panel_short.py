"""A panel that stands in the light and has no voltage, or one that nobody measures."""

import math

from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level

LIGHT = 500.0  # lx; an office
LEAST_VOLTAGE = 0.3  # V; less than half of what one silicon cell gives in that light


def _short(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    reading = seen.reading
    return reading.illuminance > LIGHT and reading.panel_voltage < LEAST_VOLTAGE, memory


def _says_short(seen: Seen) -> str:
    reading = seen.reading
    return (
        f'the panel has {reading.panel_voltage:.2f} V in {reading.illuminance:.0f} lx: '
        'it is shorted, or its charger is'
    )


def _missing(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    return not math.isfinite(seen.reading.harvest), memory


def _says_missing(seen: Seen) -> str:
    return 'the power of the panel is not measured and counts as 0 W'


DETECTOR = Detector(
    'panel short', _short, _says_short, Level.WARN, spoils=False, rise=1.0, fall=2.0
)
MISSING = Detector(
    'panel not measured', _missing, _says_missing, Level.WARN, spoils=False, rise=0.0, fall=1.0
)
