"""
A current of the wrong sign, by either of two laws.

The cell cannot take up more than the panel gives. And the voltage of a cell rises with the current
that charges it, by its resistance: where the two change against each other, the sign is wrong,
also in bright light. The slope is fitted to the changes of the last while.
"""

import math

from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_graph.health import Level

DOUBTFUL_POWER = 0.05  # W; ten times what the meters' offsets can amount to
MEMORY = 10.0  # s
EXCITED = 0.02  # A2; a step of 0.14 A, whose slope a voltage noise of 3 mV blurs by 0.02 ohm
AGAINST = -0.5  # of the resistance
NOISE = 0.02  # V


def _sees(memory: Memory, seen: Seen) -> tuple[bool, Memory]:
    reading = seen.reading
    if not reading.usable:
        return False, memory
    squares, products = _changes(memory, seen)
    slope = products / squares if squares > EXCITED else 0.0
    against = slope < AGAINST * seen.cell.resistance
    too_much = math.isfinite(reading.harvest) and reading.power > reading.income + DOUBTFUL_POWER
    return against or too_much, (squares, products)


def _changes(memory: Memory, seen: Seen) -> tuple[float, float]:
    """Return the faded sums of current change squared, and times voltage change. [A2, V A]"""
    squares, products = memory
    before, now = seen.before, seen.reading
    if before is None or not before.usable or not 0.0 < seen.dt < 1.0:
        return squares, products
    kept = math.exp(-seen.dt / MEMORY)
    current = now.current - before.current
    voltage = now.voltage - before.voltage
    if abs(voltage) > 2.0 * seen.cell.resistance * abs(current) + NOISE:  # something else's doing
        return kept * squares, kept * products
    return kept * squares + current * current, kept * products + voltage * current


def _says(seen: Seen) -> str:
    reading = seen.reading
    if reading.power > reading.income + DOUBTFUL_POWER:
        return (
            f'the cell takes up {reading.power:.2f} W but the panel gives '
            f'{reading.income:.2f} W: check the sign of the current'
        )
    return 'the voltage falls when the cell is charged: check the sign of the current'


DETECTOR = Detector(
    'reversed current', _sees, _says, Level.ERROR, spoils=True, rise=0.3, fall=5.0,
    start=(0.0, 0.0),
)  # fmt: skip
