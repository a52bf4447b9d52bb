"""
Readings that stay the same to the last bit: a meter or its driver that hangs.

A meter with half a count of noise repeats a reading about every second time, so that one which
repeats for 5 s at 10 Hz has a chance of 1e-15. A panel in the dark really reads zero.
"""

from lta_energy.faults.dropout import NOTHING
from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level

LONGEST = 5.0  # s
DARK = 0.01  # A


def _longer(time: float, now: float, before: float, dt: float) -> float:
    """Return how long a number has stayed the same. [s]"""
    return time + dt if now == before else 0.0


def _cell(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    if seen.before is None or seen.dt <= 0.0:
        return False, memory
    voltage, current = memory
    now, before = seen.reading, seen.before
    if abs(now.voltage) < NOTHING:  # nothing is measured: that has a name of its own
        return False, (0.0, 0.0)
    voltage = _longer(voltage, now.voltage, before.voltage, seen.dt)
    current = _longer(current, now.current, before.current, seen.dt)
    return max(voltage, current) >= LONGEST, (voltage, current)


def _panel(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    if seen.before is None or seen.dt <= 0.0:
        return False, memory
    now, before = seen.reading.panel_current, seen.before.panel_current
    time = _longer(memory[0], now, before, seen.dt) if abs(now) > DARK else 0.0
    return time >= LONGEST, (time,)


def _says(seen: Seen) -> str:
    return f'voltage or current of the cell has not changed for {LONGEST:g} s: the meter hangs'


def _says_of_panel(seen: Seen) -> str:
    return f'the current of the panel has not changed for {LONGEST:g} s: its meter hangs'


DETECTOR = Detector(
    'frozen', _cell, _says, Level.ERROR, spoils=True, rise=0.0, fall=2.0, start=(0.0, 0.0)
)
PANEL = Detector(
    'panel frozen', _panel, _says_of_panel, Level.WARN, spoils=False, rise=0.0, fall=2.0,
    start=(0.0,),
)  # fmt: skip
